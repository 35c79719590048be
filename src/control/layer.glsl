// A layer of an instance in an update: what of docs/controller.md decides its state. C++ too, as
// control/blend_space.glsl. The includer declares what that does, the buffers `layers` and `parameters`, `push`,
// `layout_of_group`, `instance`, `first_parameter`, load_layer_state(index), and what the layer is shown by:
// begin_layer(), add_active_clip(), add_move() and emit_events(); these go by control/plays.glsl, so that comes before.

bool has_taken = false;  // a transition, in any layer
// Duration of the inertial transition or play that this update begins with, in the highest layer that has one; 0: none
float begun_duration_s = 0;

void note_transition(LayerState state) {
    if (state.taken == kNone) return;
    const ControlTransition transition = load_transition(state.taken);
    if ((transition.flags & kTransitionInertial) != 0 && transition.fade_rate > 0)
        begun_duration_s = 1 / transition.fade_rate;
}

void note_inertial_play(LayerState state) {
    if (state.inertial_rate > 0) begun_duration_s = 1 / state.inertial_rate;
}

// A layer's weight; a direct one's goes towards its goal.
float advance_weight(INOUT(LayerState) state, ControlLayer layer) {
    const float way = product(max(push.time_step_s, 0), state.weight_rate);
    state.weight = state.weight < state.weight_goal ? min(sum(state.weight, way), state.weight_goal)
                                                    : max(difference(state.weight, way), state.weight_goal);
    return clamp(
        layer.weight_parameter == kNone ? state.weight : product(state.weight, parameter_at(layer.weight_parameter)), 0,
        1);
}

bool is_in_step(ClipMix leading, ClipMix other) { return leading.sync != kNone && other.sync == leading.sync; }

// The layer's plays; those from play_count on have no meaning: they are neither shown nor stored
ClipMix mixes[kStackSize];
PhaseStep steps[kStackSize];

// The clips of a layer, one after the other: an invocation goes on to its next one at once, where a software device
// would step through all plays and points.
void add_clips(LayerState state, ControlLayer layer, vec3 weights, float layer_weight, bool moves) {
    uint heard = 0;  // a bit for each clip of each play
    for (uint k = 0; k < kStackSize; ++k)
        for (uint point = 0; point < 3; ++point)
            if (k < state.play_count && product(weights[k], mixes[k].weights[point]) > 0) heard |= 1 << (3 * k + point);
    if (layer_weight <= 0 || heard == 0) return;
    begin_layer(state, layer, layer_weight);
    do {
        if (heard == 0) break;  // see mix_line() in blend_space.glsl
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
    state.taken = kNone;  // so far
    if (layer.state_count > 0) {
        follow_transitions(state, layer);
        note_transition(state);
    }
    note_inertial_play(state);
    has_taken = has_taken || state.taken != kNone;
    advance_fades(state, push.time_step_s);
    const vec3 weights = weights_of_plays(state);
    const float layer_weight = advance_weight(state, layer);

    float common_rate = 0;  // of the leading play's sync group
    uint count = 0;
    do {
        if (count >= state.play_count) break;  // see mix_line() in blend_space.glsl
        mixes[count] = mix_of_play(layer, state.plays[count]);
        common_rate = sum(common_rate,
                          product(weights[count], mixes[is_in_step(mixes[0], mixes[count]) ? count : 0].rate));
    } while (++count < state.play_count);
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
    add_clips(state, layer, weights, layer_weight, index == 0);
    if (layer_weight > 0 && state.play_count > 0) emit_events(heaviest(mixes[0]), steps[0], index);
    store_layer_state(at, state);
}

// Those that transitions taken in this update asked for.
void reset_triggers() {
    uint index = 0;
    do {
        const uint taken = has_taken ? layers[instance * layout_of_group.layer_count + index].taken : kNone;
        if (taken == kNone) continue;
        const ControlTransition transition = load_transition(taken);
        for (uint k = 0; k < transition.condition_count; ++k) {  // seldom
            const ControlCondition condition = load_condition(transition.first_condition + k);
            if (condition.test == kTestTriggered) parameters[first_parameter + condition.parameter] = 0;
        }
    } while (has_taken && ++index < layout_of_group.layer_count);
}
