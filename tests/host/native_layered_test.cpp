// Layered poses as devices without Vulkan compute them, against the references.
#include "blend/active_clips_reference.h"
#include "blend/inertia_io.h"
#include "blend/layered.kernel.h"
#include "blend/layered_in_order.kernel.h"
#include "blend/layered_io.h"
#include "control/controller_io.h"
#include "sample/sample_reference.h"
#include "tests/host/native_runner.h"
#include "tests/sample_cases.h"

namespace throng {
namespace {

using namespace test;

constexpr uint32_t kLayeredJoints = 70, kLayeredInstances = 40, kLayeredLimit = 5;

// For each instance: an override layer, one with two clips and a mask, and an additive one.
struct Layers {
    Character character;
    std::vector<float> masks;  // for the second layer
    std::vector<io::ActiveClip> active_clips;
    std::vector<std::vector<ReferenceLayer>> wanted;  // [instance * kLayeredJoints + joint]

    Layers(Character of, bool in_model_space) : character(std::move(of)) {
        Random random(12);
        for (uint32_t joint = 0; joint < kLayeredJoints; ++joint)
            masks.push_back(joint % 3 == 0 ? 0 : static_cast<float>(random.unit()));
        wanted.resize(kLayeredInstances * kLayeredJoints);
        for (uint32_t instance = 0; instance < kLayeredInstances; ++instance) {
            const auto share = static_cast<float>(random.unit());
            const uint32_t model = in_model_space ? io::kActiveClipModelRotations : 0;
            add(random, instance, {1, 1, io::kActiveClipBeginsLayer | io::kActiveClipEndsLayer}, true);
            add(random, instance, {share, 0.7f, io::kActiveClipBeginsLayer | io::kActiveClipMasked | model}, true);
            add(random, instance, {1 - share, 0.7f, io::kActiveClipEndsLayer | io::kActiveClipMasked | model}, false);
            add(random, instance,
                {1, 0.4f,
                 io::kActiveClipBeginsLayer | io::kActiveClipEndsLayer | io::kActiveClipAdditive | io::kActiveClipEnds},
                true);
            active_clips.emplace_back();  // beyond the end of the list
        }
    }

    struct Told {
        float weight, layer_weight;
        uint32_t flags;
    };
    void add(Random& random, uint32_t instance, const Told& told, bool begins) {
        const uint32_t clip = random.below(static_cast<uint32_t>(character.clips.size()));
        const double time_s = random.between(0, double{character.clips[clip].duration_s});
        const io::ClipCursor cursor = cursor_at(character, clip, time_s);
        active_clips.push_back({cursor.first_track, cursor.earlier, cursor.later, cursor.fraction, told.weight,
                                told.layer_weight, character.clips[clip].first_row, told.flags});
        const auto pose = sample_reference(character, clip, time_s), first = sample_reference(character, clip, 0);
        for (uint32_t joint = 0; joint < kLayeredJoints; ++joint) {
            std::vector<ReferenceLayer>& layers = wanted[instance * kLayeredJoints + joint];
            if (begins) {
                const bool is_masked = (told.flags & io::kActiveClipMasked) != 0;
                layers.push_back({.is_additive = (told.flags & io::kActiveClipAdditive) != 0,
                                  .weight = double{told.layer_weight} * (is_masked ? double{masks[joint]} : 1),
                                  .active_clips = {},
                                  .in_model_space = (told.flags & io::kActiveClipModelRotations) != 0});
            }
            layers.back().active_clips.push_back({pose[joint], first[joint], double{told.weight}});
        }
    }

    void bind(NativeRun& run, std::vector<Affine>& local) {
        run.bind(io::kActiveClipsBuffer, active_clips).bind(io::kMasksBuffer, masks);
        run.bind(io::kTracksBuffer, character.tracks).bind(io::kKeysBuffer, character.keys);
        run.bind(io::kWordsBuffer, character.words).bind(io::kLocalBuffer, local);
    }
};

Character some_character(bool packed) {
    const Asset asset = make_asset({.joint_count = kLayeredJoints, .seed = 21});
    return compiled(asset, {.error = packed ? 1e-4 : 0});
}

double error_of(const Affine& got, const Trs<double>& wanted) {
    return matrix_error(got, to_affine(wanted), std::max(1.0, length(wanted.translation)));
}

TEST(NativeLayered, LayersFollowTheReference) {
    for (const bool packed : {false, true}) {
        Layers layers(some_character(packed), false);
        auto local = unwritten<Affine>(kLayeredInstances * kLayeredJoints);
        NativeRun run(kernels::layered.native, {packed, false, false, false});
        layers.bind(run, local);
        run.workgroups(io::LayeredPush{kLayeredJoints, kLayeredLimit}, kLayeredInstances);
        for (size_t i = 0; i < local.size(); ++i)
            ASSERT_LE(error_of(local[i], active_clips_reference(layers.wanted[i])), 2e-5)
                << "joint " << i % kLayeredJoints;
    }
}

TEST(NativeLayered, RotationsInModelSpaceFollowTheReference) {
    Layers layers(some_character(false), true);
    std::vector<uint32_t>& parents = layers.character.rig.parents;
    auto local = unwritten<Affine>(kLayeredInstances * kLayeredJoints);
    auto rotations = unwritten<io::ModelRotations>(kLayeredInstances * kLayeredJoints);
    NativeRun run(kernels::layered_in_order.native, {false, false, false, false});
    layers.bind(run, local);
    run.bind(io::kParentsBuffer, parents).bind(io::kRotationsBuffer, rotations);
    for (const uint32_t first : {0u, 20u})  // in two dispatches
        run.invocations(io::LayeredInOrderPush{kLayeredInstances, kLayeredJoints, kLayeredLimit, first,
                                               first == 0 ? 20 : kLayeredJoints},
                        kLayeredInstances);
    for (uint32_t instance = 0; instance < kLayeredInstances; ++instance) {
        std::vector<ReferenceJoint> joints;
        for (uint32_t joint = 0; joint < kLayeredJoints; ++joint) {
            const ReferenceJoint* const parent = parents[joint] == kNone ? nullptr : &joints[parents[joint]];
            joints.push_back(joint_reference(layers.wanted[instance * kLayeredJoints + joint], parent));
            ASSERT_LE(error_of(local[instance * kLayeredJoints + joint], joints[joint].pose), 1e-4)
                << "joint " << joint;
        }
    }
}

// A transition starts at the pose that was shown, if that did not move. When it ends, only the pose is left.
TEST(NativeLayered, InertialTransitionsBeginWhereThePoseWas) {
    Layers layers(some_character(false), false);
    std::vector<io::InstanceInertia> inertias(kLayeredInstances);
    for (io::InstanceInertia& inertia : inertias) inertia = {0, 0.5f, 0.1f, 3, 1, 0};
    std::vector<io::InertiaState> states(kLayeredInstances * kLayeredJoints);
    Random random(13);
    std::vector<Trs<double>> shown;
    for (io::InertiaState& state : states) {
        shown.push_back(random.trs(1, 0.2));
        const Trs<float> f = shown.back().as<float>();
        state.shown = {{f.rotation.x, f.rotation.y, f.rotation.z, f.rotation.w},
                       {f.translation.x, f.translation.y, f.translation.z, 0},
                       {f.scale.x, f.scale.y, f.scale.z, 0}};
        state.shown_before = state.shown;
    }
    auto local = unwritten<Affine>(kLayeredInstances * kLayeredJoints);
    NativeRun run(kernels::layered.native, {false, false, true, false});
    layers.bind(run, local);
    run.bind(io::kInertiasBuffer, inertias).bind(io::kInertiaStatesBuffer, states);
    run.workgroups(io::LayeredPush{kLayeredJoints, kLayeredLimit}, kLayeredInstances);
    for (size_t i = 0; i < local.size(); ++i)
        ASSERT_LE(error_of(local[i], shown[i]), 2e-5) << "joint " << i % kLayeredJoints;
    for (io::InstanceInertia& inertia : inertias) inertia = {0.5f, 0.5f, 0.1f, 3, 0, 0.5f};
    run.workgroups(io::LayeredPush{kLayeredJoints, kLayeredLimit}, kLayeredInstances);
    for (size_t i = 0; i < local.size(); ++i)
        ASSERT_LE(error_of(local[i], active_clips_reference(layers.wanted[i])), 2e-5) << "joint " << i % kLayeredJoints;
}

}  // namespace
}  // namespace throng
