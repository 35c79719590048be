#version 460
// controller: one update of each instance's layers: transitions, fades, times, events, root motion; writes the clips
// that its pose is made of. One invocation per instance. Defined in docs/controller.md; nothing that decides a state is
// divided or fused, so that all devices agree. Loops test when a round is over: a software device goes round one that
// tests before it once more than any invocation needs.
#include "gpu/buffers_io.h"
#include "gpu/stored.glsl"
#include "gpu/table.glsl"
#include "control/controller_io.h"

layout(local_size_x = kControllerWorkgroupSize) in;
TABLE_OF_WORDS(kControllerBuffer, Tables, tables);
TABLE_OF_WORDS(kTimelineBuffer, Timelines, timelines);
TABLE_OF_WORDS(kTimesBuffer, Times, times);
TABLE_OF_ROWS(kRootRowsBuffer, RootRows, root_rows);
layout(set = 0, binding = kLayersBuffer, std430) buffer Layers { LayerState layers[]; };  // [instance][layer]
layout(set = 0, binding = kParametersBuffer, std430) buffer Parameters {
    float parameters[];
};  // [instance][parameter]
// [instance][active_clip_limit], four pairs of words each
layout(set = 0, binding = kActiveClipsBuffer, std430) writeonly buffer ActiveClips { StoredPair active_clips[]; };
layout(set = 0, binding = kEventsBuffer, std430) buffer Events {
    EventHead event_head;
    EventRecord events[];
};
layout(set = 0, binding = kRootsBuffer, std430) buffer Roots { RootState roots[]; };
// world_from_model, three rows each
layout(set = 0, binding = kPlacementsBuffer, std430) writeonly buffer Placements { vec4 placements[]; };
// The same as layers and parameters: to read them, which a software device does
TABLE_OF_WORDS(kLayersBeforeBuffer, LayersBefore, layers_before);
TABLE_OF_WORDS(kParametersBeforeBuffer, ParametersBefore, parameters_before);  // faster as tables
layout(set = 0, binding = kInertiasBuffer, std430) buffer Inertias { InstanceInertia inertias[]; };
layout(set = 0, binding = kActiveClipTimesBuffer, std430) writeonly buffer ActiveClipTimes {
    float active_clip_times[];
};  // [instance][active_clip_limit]
layout(push_constant) uniform Push { ControllerPush push; };

uint instance, first_parameter;
bool has_taken = false;  // a transition, in any layer

// What is not finite counts as 0.
float parameter_at(uint index) {
    const float value = uintBitsToFloat(WORD_AT(parameters_before, first_parameter + index));
    return (floatBitsToUint(value) & 0x7F800000u) == 0x7F800000u ? 0 : value;
}

LayerPlay load_play(uint w) {
    return LayerPlay(WORD_AT(layers_before, w), WORD_AT(layers_before, w + 1), WORD_AT(layers_before, w + 2),
                     uintBitsToFloat(WORD_AT(layers_before, w + 3)), uintBitsToFloat(WORD_AT(layers_before, w + 4)),
                     uintBitsToFloat(WORD_AT(layers_before, w + 5)), WORD_AT(layers_before, w + 6));
}

LayerState load_layer_state(uint index) {
    const uint w = index * kLayerStateWords, rest = w + kStackSize * kLayerPlayWords;
    LayerState state;
    for (uint k = 0; k < kStackSize; ++k) state.plays[k] = load_play(w + k * kLayerPlayWords);
    state.play_count = WORD_AT(layers_before, rest);
    state.weight = uintBitsToFloat(WORD_AT(layers_before, rest + 1));
    state.weight_goal = uintBitsToFloat(WORD_AT(layers_before, rest + 2));
    state.weight_rate = uintBitsToFloat(WORD_AT(layers_before, rest + 3));
    state.mode = WORD_AT(layers_before, rest + 4);
    state.mask = WORD_AT(layers_before, rest + 5);
    state.taken = kAbsent;  // in this update, so far
    state.inertial_rate = uintBitsToFloat(WORD_AT(layers_before, rest + 7));
    return state;
}

#include "control/control.glsl"
#include "control/plays.glsl"
#include "control/inertia_clock.glsl"
#include "control/root_motion.glsl"
#include "control/active_clips.glsl"
#include "control/events.glsl"

// A layer's weight; a direct one's goes towards its goal.
float advance_weight(inout LayerState state, ControlLayer layer) {
    const float way = product(max(push.time_step_s, 0), state.weight_rate);
    state.weight = state.weight < state.weight_goal ? min(sum(state.weight, way), state.weight_goal)
                                                    : max(difference(state.weight, way), state.weight_goal);
    return clamp(
        layer.weight_parameter == kAbsent ? state.weight : product(state.weight, parameter_at(layer.weight_parameter)),
        0, 1);
}

bool is_in_step(ClipMix leading, ClipMix other) { return leading.sync != kAbsent && other.sync == leading.sync; }

// The clips of a layer, one after the other: an invocation goes on to its next one at once, where a software device
// would step through all plays and points.
void add_clips(LayerState state, ControlLayer layer, ClipMix mixes[kStackSize], PhaseStep steps[kStackSize],
               vec3 weights, float layer_weight, bool moves) {
    uint heard = 0;  // a bit for each clip of each play
    for (uint k = 0; k < kStackSize; ++k)
        for (uint point = 0; point < 3; ++point)
            if (k < state.play_count && product(weights[k], mixes[k].weights[point]) > 0) heard |= 1 << (3 * k + point);
    if (layer_weight <= 0 || heard == 0) return;
    begin_layer(state, layer, layer_weight);
    do {
        const uint bit = findLSB(heard), k = bit / 3, point = bit % 3;
        const float weight = product(weights[k], mixes[k].weights[point]);
        heard &= heard - 1;
        add_active_clip(mixes[k].clips[point], steps[k].after, weight, heard == 0);
        if (moves) add_move(load_clip(mixes[k].clips[point]), steps[k], weight);
    } while (heard != 0);
}

// Only what an update may change: each word stored costs a software device more than what computes it.
void store_layer_state(uint index, LayerState state) {
    for (uint k = 0; k < kStackSize; ++k) {
        if (k >= state.play_count) continue;
        layers[index].plays[k].motion = state.plays[k].motion;
        layers[index].plays[k].phase = state.plays[k].phase;
        layers[index].plays[k].loops = state.plays[k].loops;
        layers[index].plays[k].fade = state.plays[k].fade;
        layers[index].plays[k].fade_rate = state.plays[k].fade_rate;
    }
    layers[index].play_count = state.play_count;
    layers[index].weight = state.weight;
    layers[index].taken = state.taken;
    if (state.inertial_rate != 0) layers[index].inertial_rate = 0;
}

void update_layer(uint index) {
    const ControlLayer layer = load_layer(index);
    const uint at = instance * layout_of_group.layer_count + index;
    LayerState state = load_layer_state(at);
    if (layer.state_count > 0) {
        follow_transitions(state, layer);
        note_transition(state);
    }
    note_inertial_play(state);
    has_taken = has_taken || state.taken != kAbsent;
    advance_fades(state, push.time_step_s);
    const vec3 weights = weights_of_plays(state);
    const float layer_weight = advance_weight(state, layer);

    ClipMix mixes[kStackSize];
    float common_rate = 0;  // of the leading play's sync group
    uint count = 0;
    do {  // of a layer that plays nothing, nothing of this is kept
        mixes[count] = mix_of_play(layer, state.plays[count]);
        common_rate = sum(common_rate,
                          product(weights[count], mixes[is_in_step(mixes[0], mixes[count]) ? count : 0].rate));
    } while (++count < state.play_count);
    PhaseStep steps[kStackSize];  // from play_count on of no meaning, as mixes are: neither heard nor stored
    for (uint k = 0; k < kStackSize; ++k) {
        const bool in_step = is_in_step(mixes[0], mixes[k]);
        if (k > 0 && in_step) {
            state.plays[k].phase = state.plays[0].phase;
            state.plays[k].loops = state.plays[0].loops;
            steps[k] = steps[0];
        } else {
            steps[k] = step_phase(state.plays[k], in_step ? common_rate : mixes[k].rate, mixes[k].loop != 0,
                                  push.time_step_s);
        }
    }
    add_clips(state, layer, mixes, steps, weights, layer_weight, index == 0);
    if (layer_weight > 0 && state.play_count > 0) emit_events(heaviest(mixes[0]), steps[0], index);
    store_layer_state(at, state);
}

// Those that transitions taken in this update asked for.
void reset_triggers() {
    uint index = 0;
    do {
        const uint taken = has_taken ? layers[instance * layout_of_group.layer_count + index].taken : kAbsent;
        if (taken == kAbsent) continue;
        const ControlTransition transition = load_transition(taken);
        for (uint k = 0; k < transition.condition_count; ++k) {  // seldom
            const ControlCondition condition = load_condition(transition.first_condition + k);
            if (condition.test == kTestTriggered) parameters[first_parameter + condition.parameter] = 0;
        }
    } while (has_taken && ++index < layout_of_group.layer_count);
}

void main() {
    instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count) return;
    layout_of_group = load_layout();
    first_parameter = instance * layout_of_group.parameter_count;
    begin_active_clips();
    begin_move();
    begin_inertia();
    uint index = 0;
    do update_layer(index);
    while (++index < layout_of_group.layer_count);
    reset_triggers();
    end_active_clips();
    end_move();
    end_inertia();
}
