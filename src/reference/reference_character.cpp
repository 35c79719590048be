// The pipeline in double precision for a character with a controller: control, sample, blend, scan, bind.
#include "base/default_floats.h"
#include "base/failure.h"
#include "blend/blend_reference.h"
#include "blend/inertia_reference.h"
#include "blend/pose_override.h"
#include "blend/active_clips_reference.h"
#include "control/controller_reference.h"
#include "controller/joint_mask.h"
#include "control/layer_commands.h"
#include "reference/reference.h"
#include "procedural/procedural_reference.h"
#include "morph/morph_reference.h"
#include "sample/sample_reference.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace throng {

struct ReferenceCharacter::State {
    State(const Character& of, const Controller& by, const ProceduralRules* moved_by)
        : character(of), controller(by, of), kinds(layer_kinds(by)), is_inertial(has_inertia(by)) {
        if (moved_by) rules.emplace(*moved_by, of);
        for (const Clip& clip : of.clips) clip_durations_s.push_back(clip.duration_s);
        for (const JointMask& mask : by.masks) masks.push_back(mask_weights(mask, of.rig));
        last.active_clips.push_back({.clip = static_cast<uint32_t>(of.clips.size())});
    }

    std::vector<Trs<double>> poses_of(const ControllerActiveClip& active_clip) const {
        return sample_reference(character, active_clip.clip, active_clip.time_s);
    }
    // The pose that an additive active clip is relative to. Of other clips it is not used.
    std::vector<Trs<double>> first_poses_of(const ControllerActiveClip& active_clip) const {
        if (active_clip.mode != io::kModeAdditive) return std::vector<Trs<double>>(character.rig.joint_count());
        const double first_s = active_clip.clip < character.clips.size()
                                   ? double{character.times_s[character.clips[active_clip.clip].first_time]}
                                   : 0;
        return sample_reference(character, active_clip.clip, first_s);
    }

    bool begins_layer(size_t i) const { return i == 0 || last.active_clips[i - 1].layer != last.active_clips[i].layer; }

    std::vector<Trs<double>> mix() const;
    std::vector<Trs<double>> pose_over(std::vector<Trs<double>> animated) const;
    std::vector<double> mix_morphs() const;
    void show(std::vector<Trs<double>> target, double step_s);
    void move_joints(double step_s);

    const Character& character;
    ControllerReference controller;
    std::vector<float> clip_durations_s;
    std::vector<LayerKind> kinds;
    std::vector<std::vector<float>> masks;  // [mask][joint]
    ControllerUpdate last;
    std::vector<CharacterEvent> events;
    bool is_inertial = false;
    // Poses of the last two updates, of controllers with inertial transitions; empty: none yet
    std::vector<Trs<double>> shown, shown_before;
    double step_s = 0;                      // between these two
    std::vector<ReferenceInertia> offsets;  // [joint]
    double elapsed_s = 0, duration_s = 0;
    std::vector<Trs<double>> pose_overrides;  // [joint], as last set; before that empty
    PoseFade fade;                            // of these
    std::optional<ProceduralReference> rules;
    WindClock wind;
    std::vector<Trs<double>> moved;  // [joint], by the rules in the last update
    AffineT<double> placement;       // world_from_model
    bool placement_moves = true;
    uint32_t instance = 0;
};

// The blend of all active clips, as local transforms.
std::vector<Trs<double>> ReferenceCharacter::State::mix() const {
    std::vector<std::vector<Trs<double>>> poses, first_poses;
    for (const ControllerActiveClip& active_clip : last.active_clips) {
        poses.push_back(poses_of(active_clip));
        first_poses.push_back(first_poses_of(active_clip));
    }
    std::vector<ReferenceJoint> joints;
    for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
        std::vector<ReferenceLayer> layers;
        for (size_t i = 0; i < last.active_clips.size(); ++i) {
            const ControllerActiveClip& active_clip = last.active_clips[i];
            if (begins_layer(i))
                layers.push_back({.is_additive = active_clip.mode == io::kModeAdditive,
                                  .weight = active_clip.layer_weight *
                                            (active_clip.mask == kNone ? 1.0 : double{masks[active_clip.mask][joint]}),
                                  .active_clips = {},
                                  .in_model_space = active_clip.model_rotations});
            layers.back().active_clips.push_back({poses[i][joint], first_poses[i][joint], active_clip.weight});
        }
        const uint32_t parent = character.rig.parents[joint];
        joints.push_back(joint_reference(layers, parent == kNone ? nullptr : &joints[parent]));
    }
    std::vector<Trs<double>> local;
    for (const ReferenceJoint& joint : joints) local.push_back(joint.pose);
    return local;
}

// The animated pose with the pose override, if there is one, blended over it.
std::vector<Trs<double>> ReferenceCharacter::State::pose_over(std::vector<Trs<double>> animated) const {
    const double weight = fade.weight();
    if (weight >= 1) return pose_overrides;
    if (weight > 0)
        for (size_t joint = 0; joint < animated.size(); ++joint)
            animated[joint] = blend_reference(pose_overrides[joint], animated[joint], weight);
    return animated;
}

// Step 12 of docs/controller.md.
std::vector<double> ReferenceCharacter::State::mix_morphs() const {
    std::vector<MorphLayer> layers;
    for (size_t i = 0; i < last.active_clips.size(); ++i) {
        const ControllerActiveClip& active_clip = last.active_clips[i];
        if (begins_layer(i))
            layers.push_back({.is_additive = active_clip.mode == io::kModeAdditive,
                              .weight = active_clip.layer_weight,
                              .active_clips = {}});
        layers.back().active_clips.push_back({active_clip.clip, active_clip.time_s, active_clip.weight});
    }
    return morphs_reference(character, layers);
}

void ReferenceCharacter::State::move_joints(double step_now_s) {
    wind.advance(step_now_s);
    moved = pose_over(shown.empty() ? mix() : shown);
    rules->update(
        moved, {.world_from_model = placement, .wind = wind.moment(), .instance = instance, .time_step_s = step_now_s});
}

// Step 10 of docs/controller.md.
void ReferenceCharacter::State::show(std::vector<Trs<double>> target, double new_step_s) {
    const bool begins = last.inertial_s > 0 && !shown.empty();
    if (begins) {
        const bool knows_speed = !shown_before.empty() && step_s > 0;
        offsets.clear();
        for (size_t joint = 0; joint < target.size(); ++joint)
            offsets.push_back(inertia_begin_reference(
                {shown[joint], knows_speed ? shown_before[joint] : shown[joint], target[joint], target[joint]},
                knows_speed ? step_s : 1));
        duration_s = last.inertial_s;
    }
    elapsed_s = begins ? new_step_s : elapsed_s + new_step_s;
    if (elapsed_s < duration_s)
        for (size_t joint = 0; joint < target.size(); ++joint)
            target[joint] = inertia_apply_reference(offsets[joint], elapsed_s, duration_s, target[joint]);
    shown_before = std::exchange(shown, std::move(target));
    step_s = new_step_s;
}

ReferenceCharacter::ReferenceCharacter(std::unique_ptr<State> state) : state_(std::move(state)) {}
ReferenceCharacter::ReferenceCharacter(ReferenceCharacter&&) noexcept = default;
ReferenceCharacter& ReferenceCharacter::operator=(ReferenceCharacter&&) noexcept = default;
ReferenceCharacter::~ReferenceCharacter() = default;

Result<ReferenceCharacter> ReferenceCharacter::create(const Character& character, const Controller& controller,
                                                      const ProceduralRules* rules) {
    return as_result([&] {
        check_has_joints(character);
        return ReferenceCharacter(std::make_unique<State>(character, controller, rules));
    });
}

Result<void> ReferenceCharacter::play(LayerIndex layer, const LayerPlayback& playback) {
    return as_result([&] {
        state_->controller.apply(play_command(state_->kinds, state_->clip_durations_s, layer, playback, "play"));
    });
}

Result<void> ReferenceCharacter::set_state(LayerIndex layer, const PlayedMotion& motion, float fade_s) {
    return as_result([&] { state_->controller.apply(state_command(state_->kinds, layer, motion, fade_s, "state")); });
}

Result<void> ReferenceCharacter::set_layer(LayerIndex layer, const LayerBlend& blend) {
    return as_result([&] {
        state_->controller.apply(
            layer_command(state_->kinds, static_cast<uint32_t>(state_->masks.size()), layer, blend, "layer"));
    });
}

Result<void> ReferenceCharacter::set_parameter(ParameterIndex parameter, float value) {
    return as_result([&] {
        check_parameter(static_cast<uint32_t>(state_->controller.parameters.size()), parameter, value, "parameter");
        state_->controller.parameters[parameter] = value;
    });
}

Result<void> ReferenceCharacter::set_pose(std::span<const Trs<float>> parent_from_joint, float fade_s) {
    return as_result([&] {
        check_fade(fade_s, "pose");
        state_->pose_overrides = checked_pose(parent_from_joint, state_->character.rig.joint_count(),
                                              state_->character.rig.uniform_scale, "pose");
        state_->fade.set(fade_s);
    });
}

Result<void> ReferenceCharacter::clear_pose(float fade_s) {
    return as_result([&] {
        check_fade(fade_s, "pose");
        state_->fade.clear(fade_s);
    });
}

Result<void> ReferenceCharacter::set_target(TargetIndex target, const TargetPlace& place) {
    return as_result([&] {
        check_target(target, state_->rules ? static_cast<uint32_t>(state_->rules->targets.size()) : 0, place, "target");
        state_->rules->targets[target] = {place.world_place.as<double>(), place.weight};
    });
}

Result<void> ReferenceCharacter::set_wind(const Wind& wind) {
    return as_result([&] { state_->wind.set(wind); });
}

void ReferenceCharacter::set_placement(const Affine& world_from_model, bool moves, uint32_t instance) {
    state_->placement = world_from_model.as<double>();
    state_->placement_moves = moves;
    state_->instance = instance;
}

AffineT<double> ReferenceCharacter::placement() const { return state_->placement; }

Result<void> ReferenceCharacter::update(float time_step_s) {
    return as_result([&] {
        const DefaultFloats floats;  // the same floating-point environment as in crowds, so that states agree
        if (!std::isfinite(time_step_s)) throw Failure(ErrorCode::kInvalidArgument, "time step", "must be finite");
        state_->last = state_->controller.update(time_step_s);
        if (state_->is_inertial) state_->show(state_->mix(), std::max(time_step_s, 0.0f));
        state_->fade.advance(time_step_s);
        if (state_->placement_moves) state_->placement = state_->placement * move();
        if (state_->rules) state_->move_joints(time_step_s);
        state_->events.clear();
        for (const ControllerEventAt& event : state_->last.events)
            state_->events.push_back({{0}, event.event, event.layer, static_cast<float>(event.time_s)});
    });
}

ReferencePose ReferenceCharacter::pose() const {
    const State& state = *state_;
    ReferencePose pose = pose_from_local(
        state.character,
        state.moved.empty() ? state.pose_over(state.shown.empty() ? state.mix() : state.shown) : state.moved);
    pose.morph_weights = state_->mix_morphs();
    return pose;
}

std::span<const CharacterEvent> ReferenceCharacter::events() const { return state_->events; }

AffineT<double> ReferenceCharacter::move() const {
    const GroundMove& move = state_->last.move;
    AffineT<double> affine;
    affine.row = {{{move.cos, 0, move.sin, move.x}, {0, 1, 0, 0}, {-move.sin, 0, move.cos, move.z}}};
    return affine;
}

std::span<const float> ReferenceCharacter::parameters() const { return state_->controller.parameters; }

std::vector<std::vector<PlayedMotion>> ReferenceCharacter::layers() const {
    std::vector<std::vector<PlayedMotion>> layers(state_->controller.layers.size());
    for (size_t layer = 0; layer < layers.size(); ++layer)
        append_played(layers[layer], state_->controller.layers[layer], state_->kinds[layer],
                      static_cast<uint32_t>(state_->clip_durations_s.size()));
    return layers;
}

}  // namespace throng
