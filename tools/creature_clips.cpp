// Motion for the body plan: waves that travel along the chains, with a bend per joint that shrinks with the length of
// the chain, so that a limb of 100 joints bends as far in all as one of 5.
#include "creature_body.h"

#include <iterator>

namespace throng::creature {
namespace {

enum class Gait { kIdle, kWalk, kFly };

struct ClipPlan {
    const char* name;
    Gait gait;
    uint32_t ticks;  // of 1/30 s
};
constexpr ClipPlan kPlans[] = {{"idle", Gait::kIdle, 72}, {"walk", Gait::kWalk, 36}, {"fly", Gait::kFly, 36}};

// Turns of a joint against its rest, radians: pitch lowers the limb's end (towards -up), yaw swings it to its left of
// up and forward, roll turns it about itself. Every wave passes whole in a clip, so that the loop closes.
struct Bend {
    double pitch = 0, yaw = 0, roll = 0;
};

// One joint of a chain at one key of a clip.
struct Moment {
    const Chain& chain;
    uint32_t k;
    Gait gait;
    double loop;  // the part of the clip that has passed, in turns

    double along() const { return (k + 0.5) / chain.joint_count; }
    double share() const { return 1.0 / chain.joint_count; }  // of a bend of the whole chain
    // Of a bend spread smoothly over from … to of the chain; all joints together have 1.
    double share_between(double from, double to) const {
        return smooth_step(from, to, (k + 1) * share()) - smooth_step(from, to, k * share());
    }
};

Bend bend_of_tail(const Moment& m) {
    const double loop = m.loop, along = m.along();
    const double share = 1.0 / (m.chain.joint_count + 2);  // few joints may not break the body where they bend
    const bool flies = m.gait == Gait::kFly;
    const double swing = flies ? 0.9 : m.gait == Gait::kWalk ? 2.0 : 1.6;
    const double lift = flies ? 1.1 : 0.45;
    return {share * (lift * sine(loop - along - m.chain.phase_turns) + (flies ? -0.35 : 0)),
            share * swing * (0.3 + along) * sine(loop - along), 0};
}

Bend bend_of_trunk(const Moment& m) {
    const double loop = m.loop, along = m.along(), share = m.share();
    const double neck = m.share_between(0.2, 0.7), head = m.share_between(0.7, 1);
    switch (m.gait) {
        case Gait::kIdle:
            return {(share * 0.04 + neck * 0.10) * sine(loop) - head * 0.08 * sine(loop - 0.1),
                    0.18 * neck * sine(loop - 0.25) + 0.14 * head * sine(loop - 0.35), 0};
        case Gait::kWalk:
            return {share * 0.14 * sine(2 * loop - along * 0.6), share * -0.3 * sine(loop - along * 0.7), 0};
        case Gait::kFly:
            return {neck * (0.55 + 0.12 * sine(loop - 0.3)) - head * (0.45 + 0.1 * sine(loop - 0.3)),
                    0.05 * share * sine(loop), 0};
    }
    return {};
}

// A hip bend lets the leg swing back, a knee bend the shin, a foot bend the foot.
Bend bend_of_leg(const Moment& m) {
    const double loop = m.loop;
    const bool is_hind = m.chain.number == 1;
    double hip = 0, knee = 0, foot = 0;
    switch (m.gait) {
        case Gait::kIdle:
            hip = 0.025 * sine(loop);
            knee = -2 * hip;
            foot = hip;
            break;
        case Gait::kWalk: {  // trot: diagonal legs together; front legs fold forward, hind legs backward
            const double step = loop + ((m.chain.side > 0) == is_hind ? 0.5 : 0);
            const double lifted = std::max(0.0, cosine(step));
            hip = -0.42 * sine(step);
            knee = (is_hind ? 0.75 : -0.85) * lifted;
            foot = -0.6 * (hip + knee) + 0.35 * lifted;
            break;
        }
        case Gait::kFly:  // folded below the chest, trailing behind
            hip = (is_hind ? 0.85 : 0.75) + 0.06 * sine(loop - 0.2);
            knee = (is_hind ? 0.25 : -1.25) + 0.04 * sine(loop - 0.3);
            foot = (is_hind ? 0.75 : 1.2) + 0.08 * sine(loop - 0.4);
            break;
    }
    if (m.chain.joint_count < 3) return {m.k == 0 ? hip : 0.03 * sine(loop), 0, 0};  // a stilt
    return {hip * m.share_between(0, 0.24) + knee * m.share_between(0.2, 0.48) + foot * m.share_between(0.5, 0.9), 0,
            0};
}

Bend bend_of_arm(const Moment& m) {
    const double loop = m.loop, share = m.share(), side = m.chain.side;
    const double beat = loop - 0.1 * m.along();
    switch (m.gait) {
        case Gait::kIdle: return {share * (0.10 * sine(beat) - 0.1), side * share * 0.06 * sine(loop - 0.2), 0};
        case Gait::kWalk: return {share * (0.10 * sine(2 * beat) - 0.25), side * share * (0.05 * sine(loop) - 0.45), 0};
        case Gait::kFly: return {share * (0.75 * sine(beat) - 0.1), side * share * 0.18 * sine(loop - 0.25), 0};
    }
    return {};
}

// Fingers follow the arm's beat later; on the ground they close the fan halfway, the first ones furthest.
Bend bend_of_finger(const Moment& m) {
    const double loop = m.loop, share = m.share(), side = m.chain.side;
    const double beat = loop - 0.16 - 0.08 * m.along();
    switch (m.gait) {
        case Gait::kIdle: return {share * 0.10 * sine(beat), side * share * 0.05 * sine(loop - 0.2), 0};
        case Gait::kWalk:
            return {share * (0.12 * sine(2 * beat) + 0.1), side * share * -0.14 * (4 - double(m.chain.number)), 0};
        case Gait::kFly: return {share * 0.4 * sine(beat), side * share * 0.06 * sine(loop - 0.3), 0};
    }
    return {};
}

Bend bend_of_tendril(const Moment& m) {
    const double size = m.gait == Gait::kIdle ? 0.55 : 0.8;
    const double turns = m.loop - m.along() * 0.8 - m.chain.phase_turns;
    return {m.share() * (size * sine(turns) - (m.gait == Gait::kFly ? 0.2 : 0)),
            m.chain.side * m.share() * 0.6 * size * sine(turns - 0.3), 0};
}

Bend bend_of(const Moment& m) {
    switch (m.chain.part) {
        case Part::kTail: return bend_of_tail(m);
        case Part::kTrunk: return bend_of_trunk(m);
        case Part::kJaw:
            return {0.1 + 0.08 * sine((m.gait == Gait::kFly ? 1 : 2) * m.loop - m.chain.phase_turns), 0, 0};
        case Part::kLeg: return bend_of_leg(m);
        case Part::kToe: return {m.share() * 0.12 * sine(m.loop - 0.1 * m.chain.number), 0, 0};
        case Part::kArm: return bend_of_arm(m);
        case Part::kFinger: return bend_of_finger(m);
        case Part::kTendril: return bend_of_tendril(m);
    }
    return {};
}

Rotation rotation_of(const Bend& bend) {
    return rotation_about({0, 1, 0}, bend.yaw) * rotation_about({1, 0, 0}, bend.pitch) *
           rotation_about({0, 0, 1}, bend.roll);
}

// The whole body's motion: the root joint is moved in model space, about itself.
struct RootMotion {
    Vec offset;
    Bend bend;
};
RootMotion root_motion(Gait gait, double loop) {
    switch (gait) {
        case Gait::kIdle: return {{0, 0.012 * sine(loop), 0}, {0.012 * sine(loop + 0.25), 0, 0.01 * sine(loop)}};
        case Gait::kWalk:
            return {{0.015 * sine(loop), 0.03 * sine(2 * loop), 0},
                    {0.025 * sine(2 * loop + 0.2), 0.05 * sine(loop), 0.03 * sine(loop + 0.25)}};
        case Gait::kFly: return {{0, 0.55 - 0.11 * sine(loop - 0.05), 0}, {-0.06 + 0.05 * sine(loop), 0, 0}};
    }
    return {};
}

class Animator {
public:
    Animator(const Body& body, const std::vector<AssetNode>& nodes) : body_(body), nodes_(nodes) {
        constexpr uint64_t kMostKeys = (64u << 20) / (5 * sizeof(float));  // 64 MiB of times and rotations
        uint64_t ticks = 0;
        for (const ClipPlan& plan : kPlans) ticks += plan.ticks;
        // Divisors of every clip's ticks, so that each loop ends on a key.
        for (const uint32_t stride : {1u, 2u, 3u, 4u, 6u, 9u, 12u}) {
            ticks_per_key_ = stride;
            if ((ticks / stride + std::size(kPlans)) * body.joint_count() <= kMostKeys) break;
        }
    }

    AssetClip animate(const ClipPlan& plan) const {
        AssetClip clip;
        clip.name = plan.name;
        clip.duration_s = float(plan.ticks / 30.0);
        std::vector<float> times_s;
        for (uint32_t tick = 0; tick <= plan.ticks; tick += ticks_per_key_) times_s.push_back(float(tick / 30.0));
        const std::vector<double> loops = loops_of(plan);
        animate_root(clip, plan.gait, times_s, loops);
        for (const Chain& chain : body_.chains)
            for (uint32_t k = 0; k < chain.joint_count; ++k) {
                const uint32_t joint = chain.first_joint + k;
                const Rotation& rest = nodes_[joint].parent_from_node.rotation;
                AssetTrack track{joint, TrackTarget::kRotation, Interpolation::kLinear, times_s, {}};
                for (const double loop : loops) append(track, rest * rotation_of(bend_of({chain, k, plan.gait, loop})));
                clip.tracks.push_back(std::move(track));
            }
        return clip;
    }

private:
    // The part of the loop done at each key; 0 again at the last.
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
    void animate_root(AssetClip& clip, Gait gait, const std::vector<float>& times_s,
                      const std::vector<double>& loops) const {
        AssetTrack translation{0, TrackTarget::kTranslation, Interpolation::kLinear, times_s, {}};
        AssetTrack rotation{0, TrackTarget::kRotation, Interpolation::kLinear, times_s, {}};
        for (const double loop : loops) {
            const RootMotion motion = root_motion(gait, loop);
            const Vec3<float> p = (body_.position[0] + motion.offset).as<float>();
            translation.values.insert(translation.values.end(), {p.x, p.y, p.z});
            append(rotation, rotation_of(motion.bend) * body_.rotation[0]);
        }
        clip.tracks.push_back(std::move(translation));
        clip.tracks.push_back(std::move(rotation));
    }

    const Body& body_;
    const std::vector<AssetNode>& nodes_;
    uint32_t ticks_per_key_ = 1;
};

}  // namespace

std::vector<AssetClip> make_clips(const Body& body, const std::vector<AssetNode>& nodes) {
    const Animator animator(body, nodes);
    std::vector<AssetClip> clips;
    for (const ClipPlan& plan : kPlans) clips.push_back(animator.animate(plan));
    return clips;
}

}  // namespace throng::creature
