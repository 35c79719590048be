// Samples the planned motion into keys.
#include "tools/creatures/clips.h"

#include <numeric>

namespace throng::creature {
namespace {

Rotation rotation_of(const Bend& bend) {
    return rotation_about({0, 1, 0}, bend.yaw) * rotation_about({1, 0, 0}, bend.pitch) *
           rotation_about({0, 0, 1}, bend.roll);
}

class Animator {
public:
    Animator(const Body& body, const std::vector<AssetNode>& nodes, const Motion& motion)
        : body_(body), nodes_(nodes), motion_(motion) {
        constexpr uint64_t kMaxKeys = (64u << 20) / (5 * sizeof(float));  // 64 MiB of times and rotations
        uint32_t ticks = 0, common = 0;
        for (const ClipPlan& plan : motion.clips) ticks += plan.ticks, common = std::gcd(common, plan.ticks);
        for (uint32_t stride = 1; stride <= common; ++stride) {
            if (common % stride != 0) continue;  // each loop ends on a key
            ticks_per_key_ = stride;
            if ((ticks / stride + motion.clips.size()) * uint64_t{body.joint_count()} <= kMaxKeys) break;
        }
    }

    AssetClip animate(uint32_t number) const {
        const ClipPlan& plan = motion_.clips[number];
        AssetClip clip;
        clip.name = plan.name;
        clip.duration_s = float(plan.ticks / 30.0);
        std::vector<float> times_s;
        for (uint32_t tick = 0; tick <= plan.ticks; tick += ticks_per_key_) times_s.push_back(float(tick / 30.0));
        const std::vector<double> loops = loops_of(plan);
        animate_root(clip, number, times_s, loops);
        for (const Chain& chain : body_.chains) {
            const BendOf bend = motion_.bends.at(chain.part);
            for (uint32_t k = 0; k < chain.joint_count; ++k) {
                const uint32_t joint = chain.first_joint + k;
                const Rotation& rest = nodes_[joint].parent_from_node.rotation;
                AssetTrack track{joint, TrackTarget::kRotation, Interpolation::kLinear, times_s, {}};
                for (const double loop : loops) append(track, rest * rotation_of(bend({chain, k, number, loop})));
                clip.tracks.push_back(std::move(track));
            }
        }
        return clip;
    }

private:
    // The part of the loop that has passed at each key; 0 again at the last.
    std::vector<double> loops_of(const ClipPlan& plan) const {
        std::vector<double> out;
        for (uint32_t tick = 0; tick <= plan.ticks; tick += ticks_per_key_)
            out.push_back(double(tick % plan.ticks) / plan.ticks);
        return out;
    }
    static void append(AssetTrack& track, const Rotation& rotation) {
        const Quaternion<float> q = normalized(rotation).as<float>();
        track.values.insert(track.values.end(), {q.x, q.y, q.z, q.w});
    }
    void animate_root(AssetClip& clip, uint32_t number, const std::vector<float>& times_s,
                      const std::vector<double>& loops) const {
        AssetTrack translation{0, TrackTarget::kTranslation, Interpolation::kLinear, times_s, {}};
        AssetTrack rotation{0, TrackTarget::kRotation, Interpolation::kLinear, times_s, {}};
        for (const double loop : loops) {
            const RootMotion moved = motion_.root(number, loop);
            const Vec3<float> p = (body_.position[0] + moved.offset).as<float>();
            translation.values.insert(translation.values.end(), {p.x, p.y, p.z});
            append(rotation, rotation_of(moved.bend) * body_.rotation[0]);
        }
        clip.tracks.push_back(std::move(translation));
        clip.tracks.push_back(std::move(rotation));
    }

    const Body& body_;
    const std::vector<AssetNode>& nodes_;
    const Motion& motion_;
    uint32_t ticks_per_key_ = 1;
};

}  // namespace

std::vector<AssetClip> make_clips(const Body& body, const std::vector<AssetNode>& nodes, const Motion& motion) {
    const Animator animator(body, nodes, motion);
    std::vector<AssetClip> clips;
    for (uint32_t i = 0; i < motion.clips.size(); ++i) clips.push_back(animator.animate(i));
    return clips;
}

}  // namespace throng::creature
