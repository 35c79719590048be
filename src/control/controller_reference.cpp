#include "control/controller_reference.h"

#include "control/control_reference.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace throng {
namespace {

uint64_t played(uint32_t loops, uint32_t phase) { return uint64_t{loops} << 32 | phase; }

bool holds(const io::ControlCondition& condition, std::span<const float> parameters) {
    const float value = parameter_at(parameters, condition.parameter);
    switch (condition.test) {
        case io::kTestAbove: return value > condition.value;
        case io::kTestBelow: return value < condition.value;
        case io::kTestFalse: return value == 0;
        default: return value != 0;
    }
}

}  // namespace

ControllerReference::ControllerReference(const Controller& controller, const Character& character)
    : character_(character) {
    const ControllerTables tables = make_controller_tables(controller, character);
    arrays_ = make_controller_arrays(controller, character);
    parameters = tables.initial_parameters;
    layers = tables.initial_layers;
}

void ControllerReference::apply(const io::ControlCommand& command) {
    if (command.kind == io::kCommandParameter) {
        parameters[command.target] = command.value;
        return;
    }
    io::LayerState& state = layers[command.target];
    if (command.kind == io::kCommandLayer) {
        state.mode = command.phase;
        state.mask = command.motion;
        state.weight_goal = command.value;
        state.weight_rate = std::abs(command.value - state.weight) * command.fade_rate;
        if (command.fade_rate == 0) state.weight = command.value;
        return;
    }
    const bool is_inertial = command.kind == io::kCommandPlayInertial, at_once = command.fade_rate == 0 || is_inertial;
    if (is_inertial) state.inertial_rate = command.fade_rate;
    push_play(state, {.motion = command.motion,
                      .phase = command.phase,
                      .loops = 0,
                      .fade = at_once ? 1.0f : 0.0f,
                      .fade_rate = command.fade_rate,
                      .speed = command.value,
                      .loop = command.loop});
}

ControllerUpdate ControllerReference::update(float time_step_s) {
    ControllerUpdate update{.move = {.cos = 0}};  // a sum so far
    for (uint32_t index = 0; index < layers.size(); ++index) update_layer(index, time_step_s, update);
    reset_triggers();
    if (update.active_clips.empty()) add_rest_pose(update.active_clips);
    update.move = turned_to_length_one(update.move);
    return update;
}

// Step 2.
void ControllerReference::follow_transitions(const io::ControlLayer& layer, io::LayerState& state) const {
    state.taken = state.play_count > 0 ? transition_of(layer, state) : io::kAbsent;
    if (state.play_count == 0) {
        push_state(layer, state, 0, {.fade = 1});
    } else if (state.taken != io::kAbsent) {
        const io::ControlTransition& transition = arrays_.transitions[state.taken];
        const bool at_once = transition.fade_rate == 0 || (transition.flags & io::kTransitionInertial) != 0;
        push_state(layer, state, transition.to, {.fade = at_once ? 1.0f : 0.0f, .fade_rate = transition.fade_rate});
    }
}

uint32_t ControllerReference::transition_of(const io::ControlLayer& layer, const io::LayerState& state) const {
    const io::ControlState& leading = arrays_.states[layer.first_state + state.plays[0].motion];
    for (uint32_t i = leading.first_transition; i < leading.first_transition + leading.transition_count; ++i)
        if (can_be_taken(arrays_.transitions[i], state)) return i;
    return io::kAbsent;
}

bool ControllerReference::can_be_taken(const io::ControlTransition& transition, const io::LayerState& state) const {
    const io::LayerPlay& leading = state.plays[0];
    const bool fading = state.play_count > 1 && leading.fade < 1;
    if (fading && (transition.flags & io::kTransitionInterrupts) == 0) return false;
    if (played(leading.loops, leading.phase) < played(transition.exit_loops, transition.exit_phase)) return false;
    const auto conditions =
        std::span(arrays_.conditions).subspan(transition.first_condition, transition.condition_count);
    return std::ranges::all_of(conditions,
                               [&](const io::ControlCondition& condition) { return holds(condition, parameters); });
}

// Step 3: a state keeps step with those of its sync group.
void ControllerReference::push_state(const io::ControlLayer& layer, io::LayerState& state, uint32_t motion,
                                     io::LayerPlay play) const {
    const auto sync_of = [&](uint32_t other) { return arrays_.states[layer.first_state + other].sync; };
    play.motion = motion;
    for (uint32_t k = state.play_count; k-- > 0;)
        if (sync_of(motion) != io::kAbsent && sync_of(state.plays[k].motion) == sync_of(motion))
            play.phase = state.plays[k].phase;
    push_play(state, play);
}

MixedClips ControllerReference::mix_of(const io::ControlLayer& layer, const io::LayerPlay& play) const {
    return layer.state_count > 0 ? mix_of_state(arrays_, arrays_.states[layer.first_state + play.motion], parameters)
                                 : mix_of_direct_play(arrays_, play);
}

// Step 5, of the layer itself.
float ControllerReference::advance_weight(const io::ControlLayer& layer, io::LayerState& state,
                                          float time_step_s) const {
    const float distance = std::max(time_step_s, 0.0f) * state.weight_rate;
    if (state.weight < state.weight_goal)
        state.weight = std::min(state.weight + distance, state.weight_goal);
    else
        state.weight = std::max(state.weight - distance, state.weight_goal);
    const float factor = layer.weight_parameter == io::kAbsent ? 1 : parameter_at(parameters, layer.weight_parameter);
    return std::clamp(state.weight * factor, 0.0f, 1.0f);
}

void ControllerReference::update_layer(uint32_t index, float time_step_s, ControllerUpdate& update) {
    const io::ControlLayer& layer = arrays_.layers[index];
    io::LayerState& state = layers[index];
    if (layer.state_count > 0) follow_transitions(layer, state);
    if (layer.state_count > 0 && state.taken != io::kAbsent) {
        const io::ControlTransition& taken = arrays_.transitions[state.taken];
        if ((taken.flags & io::kTransitionInertial) != 0 && taken.fade_rate > 0)
            update.inertial_s = 1 / taken.fade_rate;
    }
    if (const float rate = std::exchange(state.inertial_rate, 0.0f); rate > 0) update.inertial_s = 1 / rate;
    advance_fades(state, time_step_s);
    const auto weights = weights_of_plays(state);
    const float layer_weight = advance_weight(layer, state, time_step_s);

    std::vector<MixedClips> mixes;
    for (uint32_t k = 0; k < state.play_count; ++k) mixes.push_back(mix_of(layer, state.plays[k]));
    const auto in_step = [&](uint32_t k) { return mixes[0].sync != io::kAbsent && mixes[k].sync == mixes[0].sync; };
    float common_rate = 0;  // of the leading play's sync group
    for (uint32_t k = 0; k < state.play_count; ++k)
        common_rate = common_rate + weights[k] * mixes[in_step(k) ? k : 0].rate;

    PhaseStep leading;
    for (uint32_t k = 0; k < state.play_count; ++k) {
        PhaseStep step = leading;
        if (k > 0 && in_step(k)) {
            state.plays[k].phase = state.plays[0].phase;
            state.plays[k].loops = state.plays[0].loops;
        } else {
            step = step_phase(state.plays[k], mixes[k].loop, in_step(k) ? common_rate : mixes[k].rate, time_step_s);
        }
        if (k == 0) leading = step;
        if (layer_weight <= 0) continue;
        add_active_clips(index, layer_weight, state.plays[k], mixes[k], weights[k], update);
        if (index == 0)
            for (const MixedClip& mixed : mixes[k].clips)
                add_weighted(update.move, move_between(root_rows(mixed.clip), step.before, step.after, step.crossed),
                             double{weights[k]} * mixed.weight);
    }
    if (state.play_count == 0 || layer_weight <= 0) return;
    const io::ControlClip& heard = arrays_.clips[mixes[0].heaviest().clip];
    for (const PassedEvent& passed :
         passed_events(std::span(arrays_.events).subspan(heard.first_event, heard.event_count), leading, time_step_s))
        update.events.push_back({passed.event, index, passed.time_s});
}

// Step 9.
void ControllerReference::add_active_clips(uint32_t index, float layer_weight, const io::LayerPlay& play,
                                           const MixedClips& mix, float play_weight, ControllerUpdate& update) const {
    const io::LayerState& state = layers[index];
    const bool covers_all = layer_weight >= 1 && state.mode == io::kModeOverride && state.mask == io::kAbsent;
    for (const MixedClip& mixed : mix.clips) {
        const float weight = play_weight * mixed.weight;
        if (weight <= 0) continue;
        if (update.active_clips.empty() && !covers_all) add_rest_pose(update.active_clips);
        const double duration_s = mixed.clip < character_.clips.size() ? character_.clips[mixed.clip].duration_s : 0;
        update.active_clips.push_back(
            {.clip = mixed.clip,
             .phase = play.phase,
             .time_s = play.phase * 0x1p-32 * duration_s,
             .weight = weight,
             .layer = index,
             .layer_weight = layer_weight,
             .mode = state.mode,
             .mask = state.mask,
             .model_rotations = state.mode == io::kModeOverride && arrays_.layers[index].model_rotations != 0});
    }
}

void ControllerReference::add_rest_pose(std::vector<ControllerActiveClip>& active_clips) const {
    active_clips.push_back({.clip = static_cast<uint32_t>(character_.clips.size())});
}

// Of the transitions taken in this update.
void ControllerReference::reset_triggers() {
    for (const io::LayerState& state : layers) {
        if (state.taken == io::kAbsent) continue;
        const io::ControlTransition& taken = arrays_.transitions[state.taken];
        for (const io::ControlCondition& condition :
             std::span(arrays_.conditions).subspan(taken.first_condition, taken.condition_count))
            if (condition.test == io::kTestTriggered) parameters[condition.parameter] = 0;
    }
}

RootRows ControllerReference::root_rows(uint32_t clip) const {
    return RootRows(character_.root_rows).subspan(arrays_.clips[clip].first_root, arrays_.clips[clip].root_count);
}

std::vector<io::ActiveClip> to_io(std::span<const ControllerActiveClip> active_clips, const Character& character) {
    std::vector<io::ActiveClip> out;
    for (size_t i = 0; i < active_clips.size(); ++i) {
        const ControllerActiveClip& active_clip = active_clips[i];
        const Clip rest_pose{.row_count = 1};
        const Clip& clip = active_clip.clip < character.clips.size() ? character.clips[active_clip.clip] : rest_pose;
        // The time as the kernel has it, in float, so that both find the same rows.
        const float time_s = (static_cast<float>(active_clip.phase) * 0x1p-32f) * clip.duration_s;
        const RowCursor rows = find_rows_reference(
            std::span(character.times_s)
                .subspan(clip.first_time, std::min<size_t>(clip.row_count, character.times_s.size() - clip.first_time)),
            time_s);
        const auto row = [&](uint32_t index) { return clip.first_row + index * clip.row_stride; };
        uint32_t flags = active_clip.mode == io::kModeAdditive ? io::kActiveClipAdditive : 0;
        if (active_clip.model_rotations) flags |= io::kActiveClipModelRotations;
        if (active_clip.mask != io::kAbsent)
            flags |= io::kActiveClipMasked | active_clip.mask << io::kActiveClipMaskShift;
        if (i == 0 || active_clips[i - 1].layer != active_clip.layer) flags |= io::kActiveClipBeginsLayer;
        if (i + 1 == active_clips.size() || active_clips[i + 1].layer != active_clip.layer)
            flags |= io::kActiveClipEndsLayer;
        if (i + 1 == active_clips.size()) flags |= io::kActiveClipEnds;
        out.push_back({.first_track = active_clip.clip * character.rig.joint_count(),
                       .earlier = row(rows.earlier),
                       .later = row(rows.later),
                       .fraction = static_cast<float>(rows.fraction),
                       .weight = active_clip.weight,
                       .layer_weight = active_clip.layer_weight,
                       .reference_row = clip.first_row,
                       .flags = flags});
    }
    return out;
}

}  // namespace throng
