// The native engine's pose overrides and inertial transitions, against the references.
#include "bind/skin_format.h"
#include "blend/blend_reference.h"
#include "blend/inertia_reference.h"
#include "reference/reference.h"
#include "sample/sample_reference.h"
#include "tests/host/native_cases.h"

namespace throng {
namespace {

using namespace test;

std::vector<Trs<double>> sampled(const Character& character, const ClipPlayback& of) {
    if (of.clip == kNone) return sample_reference(character, static_cast<uint32_t>(character.clips.size()), 0);
    const double time_s = local_time_reference(of.time_s, character.clips[of.clip].duration_s, of.loop);
    return sample_reference(character, of.clip, time_s);
}

double largest(const Character& character, const GuardedBytes& skin, std::span<const ReferencePose> wanted) {
    const std::vector<Affine> got = unpack_skin(SkinFormat::kAffine, skin.content());
    const size_t stride = character.palette.size();
    double worst = 0;
    for (size_t i = 0; i < wanted.size(); ++i)
        worst = std::max(worst, displacement(character, std::span(got).subspan(i * stride, stride), wanted[i]));
    return worst;
}

TEST(NativeAdjust, PoseOverridesFollowTheReference) {
    constexpr uint32_t kInstances = 19;
    double worst_of_all = 0;
    for (const NamedCharacter& named : native_characters()) {
        const Character& character = named.character;
        const NativeRig rig(character, {.all_move = true});
        Random random(9);
        std::vector<Trs<float>> pose;
        for (const Trs<float>& rest : character.rig.rest) {
            Trs<double> moved = rest.as<double>();
            moved.rotation = normalized(axis_angle(random.direction(), random.between(0, 0.7)) * moved.rotation);
            moved.translation = moved.translation + random.vector(0.1) * length(moved.translation);
            pose.push_back(moved.as<float>());
        }
        const native::AlignedBytes bytes = native::aligned_bytes(rig.pose_floats() * sizeof(float));
        const std::span ordered(reinterpret_cast<float*>(bytes.get()), rig.pose_floats());
        rig.put_pose(pose, ordered);
        std::vector<io::InstanceCursor> cursors;
        std::vector<io::InstancePose> overrides;
        std::vector<ReferencePose> wanted;
        for (uint32_t i = 0; i < kInstances; ++i) {
            const Playback playback = random_playback(character, random);
            const float weight = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 1.0f : static_cast<float>(random.unit());
            std::vector<Trs<double>> local = sampled(character, playback.weight > 0 ? playback.first : playback.second);
            const std::vector<Trs<double>> second = sampled(character, playback.second);
            bool has_two_ways = false;
            for (size_t joint = 0; joint < local.size(); ++joint) {
                if (playback.weight > 0 && playback.weight < 1)
                    local[joint] = blend_reference(local[joint], second[joint], playback.weight);
                const Trs<double> set = pose[joint].as<double>();
                has_two_ways |= weight > 0 && weight < 1 && std::abs(dot(set.rotation, local[joint].rotation)) < 0.01;
                local[joint] = weight >= 1  ? set
                               : weight > 0 ? blend_reference(set, local[joint], weight)
                                            : local[joint];
            }
            overrides.push_back({0, has_two_ways ? 0 : weight});
            cursors.push_back(cursor_of(character, playback));
            wanted.push_back(has_two_ways ? *reference_pose(character, playback) : pose_from_local(character, local));
        }
        for (const NativeIsa isa : native_isas()) {
            GuardedBytes skin(kInstances * character.palette.size() * 48);
            const NativeUpdate buffers{.cursors = cursors.data(),
                                       .pose_overrides = overrides.data(),
                                       .set_poses = ordered.data(),
                                       .skin = skin.data()};
            update(rig, buffers, 0, kInstances, isa);
            const double worst = largest(character, skin, wanted);
            EXPECT_LT(worst, 1e-5) << named.name << " " << name_of(isa);
            worst_of_all = std::max(worst_of_all, worst);
        }
    }
    std::printf("largest displacement %.1e\n", worst_of_all);
}

// Switches from one clip to another at once. The difference between them dies away.
class InertialScene {
public:
    static constexpr uint32_t kInstances = 9, kUpdates = 9, kChange = 4;
    static constexpr float kStep_s = 1.0f / 30, kDuration_s = 0.3f;

    InertialScene(const Character& character, uint64_t seed) : character_(character) {
        Random random(seed);
        for (uint32_t i = 0; i < kInstances; ++i) {
            const auto clip = [&] { return random.below(static_cast<uint32_t>(character.clips.size())); };
            clips_.push_back({clip(), clip()});
            begins_s_.push_back(random.between(0, 1));
        }
    }

    ClipPlayback playback(uint32_t instance, uint32_t update) const {
        return {.clip = clips_[instance][update >= kChange], .time_s = begins_s_[instance] + update * double{kStep_s}};
    }
    io::ActiveClip active_clip(uint32_t instance, uint32_t update) const {
        const io::ClipCursor cursor = cursor_of(character_, {.first = playback(instance, update)}).first;
        return {cursor.first_track,
                cursor.earlier,
                cursor.later,
                cursor.fraction,
                1,
                1,
                0,
                io::kActiveClipBeginsLayer | io::kActiveClipEndsLayer | io::kActiveClipEnds};
    }
    static io::InstanceInertia inertia(uint32_t update) {
        const float elapsed_s = static_cast<float>(update + 1 - kChange) * kStep_s;
        return {.elapsed_s = update < kChange ? kDuration_s : elapsed_s,
                .duration_s = kDuration_s,
                .shown_step_s = kStep_s,
                .shown_count = std::min(update + 1, 3u),
                .begins = update == kChange,
                .time_step_s = kStep_s};
    }

    // [update][instance]
    std::vector<std::vector<ReferencePose>> wanted() const {
        std::vector<std::vector<ReferencePose>> all(kUpdates);
        for (uint32_t i = 0; i < kInstances; ++i) {
            std::vector<Trs<double>> shown, before;
            std::vector<ReferenceInertia> offsets;
            for (uint32_t u = 0; u < kUpdates; ++u) {
                std::vector<Trs<double>> local = sampled(character_, playback(i, u));
                if (u == kChange)
                    for (size_t j = 0; j < local.size(); ++j)
                        offsets.push_back(inertia_begin_reference({shown[j], before[j], local[j], local[j]}, kStep_s));
                const io::InstanceInertia now = inertia(u);
                for (size_t j = 0; j < offsets.size(); ++j)
                    local[j] = inertia_apply_reference(offsets[j], now.elapsed_s, now.duration_s, local[j]);
                before = std::exchange(shown, local);
                all[u].push_back(pose_from_local(character_, local));
            }
        }
        return all;
    }

private:
    const Character& character_;
    std::vector<std::array<uint32_t, 2>> clips_;
    std::vector<double> begins_s_;
};

TEST(NativeAdjust, InertialTransitionsFollowTheReference) {
    double worst_of_all = 0;
    for (const NamedCharacter& named : native_characters()) {
        const Character& character = named.character;
        if (character.clips.empty() || named.name.find("creature") == std::string::npos) continue;
        const NativeRig rig(character);
        const InertialScene scene(character, 11);
        const std::vector<std::vector<ReferencePose>> wanted = scene.wanted();
        for (const NativeIsa isa : native_isas()) {
            const size_t state_bytes = InertialScene::kInstances * rig.inertia_floats() * sizeof(float);
            const native::AlignedBytes states = native::aligned_bytes(state_bytes);
            std::fill_n(states.get(), state_bytes, std::byte{});
            for (uint32_t u = 0; u < InertialScene::kUpdates; ++u) {
                std::vector<io::ActiveClip> clips;
                for (uint32_t i = 0; i < InertialScene::kInstances; ++i) clips.push_back(scene.active_clip(i, u));
                const std::vector<io::InstanceInertia> inertias(InertialScene::kInstances, InertialScene::inertia(u));
                GuardedBytes skin(InertialScene::kInstances * character.palette.size() * 48);
                const NativeUpdate buffers{.active_clips = clips.data(),
                                           .active_clip_limit = 1,
                                           .inertias = inertias.data(),
                                           .inertia_states = reinterpret_cast<float*>(states.get()),
                                           .skin = skin.data()};
                update(rig, buffers, 0, InertialScene::kInstances, isa);
                const double worst = largest(character, skin, wanted[u]);
                EXPECT_LT(worst, 2e-5) << named.name << " " << name_of(isa) << " update " << u;
                worst_of_all = std::max(worst_of_all, worst);
            }
        }
    }
    std::printf("largest displacement %.1e\n", worst_of_all);
    EXPECT_GT(worst_of_all, 0);
}

}  // namespace
}  // namespace throng
