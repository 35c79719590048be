// One update of a layer of an instance: the part of docs/controller.md that decides its state. C++ too, like
// control/blend_space.glsl. The includer declares what that file needs, the buffers `layers` and `parameters`, `push`,
// `layout_of_group`, `instance`, `first_parameter`, load_layer_state(index), and the functions that show the layer:
// begin_layer(), add_active_clip(), add_move(), scale_move() and emit_events(). Those functions use control/plays.glsl,
// so it is included first.

bool has_taken = false;  // whether any layer has taken a transition in this update
// Duration of the inertial transition or play that begins in this update, of the highest layer that has one; 0: none
float begun_duration_s = 0;

void note_transition(LayerState state, float layer_weight) {
    if (state.taken == kNone || layer_weight <= 0) return;
    const ControlTransition transition = load_transition(state.taken);
    if ((transition.flags & kTransitionInertial) != 0 && transition.fade_rate > 0)
        begun_duration_s = 1 / transition.fade_rate;
}

void note_inertial_play(LayerState state, float layer_weight) {
    if (state.inertial_rate > 0 && layer_weight > 0) begun_duration_s = 1 / state.inertial_rate;
}

// Moves the weight of a direct layer towards its goal. Returns the layer's weight.
float advance_weight(INOUT(LayerState) state, ControlLayer layer) {
    const float way = product(max(push.time_step_s, 0), state.weight_rate);
    state.weight = state.weight < state.weight_goal ? min(sum(state.weight, way), state.weight_goal)
                                                    : max(difference(state.weight, way), state.weight_goal);
    return clamp(
        layer.weight_parameter == kNone ? state.weight : product(state.weight, parameter_at(layer.weight_parameter)), 0,
        1);
}

// Stores only what an update can change: storing a word costs a software device more than computing it. show_plays()
// stores the plays' phases and loops.
void store_layer_state(uint index, LayerState state) {
    for (uint k = 0; k < kStackSize; ++k) {
        if (k >= state.play_count) continue;
        layers[index].plays[k].motion = state.plays[k].motion;
        layers[index].plays[k].fade = state.plays[k].fade;
        layers[index].plays[k].fade_rate = state.plays[k].fade_rate;
    }
    layers[index].play_count = state.play_count;
    layers[index].weight = state.weight;
    layers[index].taken = state.taken;
    if (state.inertial_rate != 0) layers[index].inertial_rate = 0;
}

// The part of a layer that is shown, if some of its states play nothing: the sum of the weights of all other plays. At
// least 1e-30, so that weights can be divided by it.
float shown_part(LayerState state, ControlLayer layer, vec3 weights) {
    float shown = 0;
    uint k = 0;
    do {
        if (k >= state.play_count) break;
        if (!plays_nothing(load_state(layer.first_state + state.plays[k].motion))) shown = sum(shown, weights[k]);
    } while (++k < state.play_count);
    return max(shown, 1e-30f);
}

// Adds the clips of a play that have weight.
void add_clips(ClipMix clip_mix, PhaseStep phase_step, float play_weight, bool moves) {
    uint point = 0;
    do {
        const float weight = product(play_weight, clip_mix.weights[point]);
        if (weight > 0) {
            add_active_clip(clip_mix.clips[point], phase_step.after, weight);
            if (moves) add_move(clip_mix.clips[point], phase_step, weight);
        }
    } while (++point < 3);
}

// What plays in the same sync group take over from the leading play.
struct Leading {
    uint sync, phase, loops;
    float rate;
    PhaseStep phase_step;
};

// Advances plays in time and shows them, the leading one first. It handles one play at a time, because a GPU lacks the
// registers for the clips of all plays at once. Plays in the leading one's sync group advance at a common rate; if
// there can be any, a first pass over all plays only sums up that rate. If some states play nothing, `weights` are then
// divided by the part of the layer that is shown.
//
// All variables are initialized, and no `continue` is used: otherwise AMD's compiler would hold values in registers
// throughout the enclosing loop (docs/performance.md).
void show_plays(uint at, uint index, LayerState state, ControlLayer layer, vec3 weights, float layer_weight) {
    Leading leading = {kNone, 0, 0, 0, {0, 0, 0, false, 0}};
    float common_rate = 0;
    bool finds_rate = state.play_count > 1, has_begun = false;
    uint k = 0;
    do {
        if (k >= state.play_count) break;  // see mix_line() in blend_space.glsl
        LayerPlay play = state.plays[k];
        const ClipMix clip_mix = mix_of_play(layer, play);
        if (k == 0) {
            leading.sync = clip_mix.sync;
            leading.rate = clip_mix.rate;
            finds_rate = finds_rate && leading.sync != kNone;
        }
        const bool in_step = leading.sync != kNone && clip_mix.sync == leading.sync;
        if (finds_rate) {
            common_rate = sum(common_rate, product(weights[k], in_step ? clip_mix.rate : leading.rate));
            finds_rate = k + 1 < state.play_count;
            k = finds_rate ? k + 1 : 0;
        } else {
            if (k == 0 && layer.has_empty_states != 0) {
                const float shown = shown_part(state, layer, weights);
                layer_weight = product(layer_weight, shown);
                weights = weights / vec3(shown);
            }
            PhaseStep phase_step = leading.phase_step;
            if (k > 0 && in_step) {
                play.phase = leading.phase;
                play.loops = leading.loops;
            } else {
                phase_step = step_phase(play, in_step && state.play_count > 1 ? common_rate : clip_mix.rate,
                                        clip_mix.loop != 0, clip_mix.backwards, push.time_step_s);
            }
            if (k == 0) {
                leading.phase = play.phase;
                leading.loops = play.loops;
                leading.phase_step = phase_step;
            }
            layers[at].plays[k].phase = play.phase;
            layers[at].plays[k].loops = play.loops;
            if (layer_weight > 0 && weights[k] > 0) {
                const bool has_clips = clip_mix.weights.x > 0 || clip_mix.weights.y > 0 || clip_mix.weights.z > 0;
                if (!has_begun && has_clips) begin_layer(state, layer, layer_weight);
                has_begun = has_begun || has_clips;
                add_clips(clip_mix, phase_step, weights[k], index == 0);
            }
            if (layer_weight > 0 && k == 0) emit_events(heaviest(clip_mix), phase_step, index);
            ++k;
        }
    } while (k < state.play_count);
    // The weights summed to 1 before they were divided by the part that is shown, so 1 / sum is that part
    if (index == 0 && layer.has_empty_states != 0) scale_move(1 / (weights.x + weights.y + weights.z));
}

void update_layer(uint index) {
    const ControlLayer layer = load_layer(index);
    const uint at = instance * layout_of_group.layer_count + index;
    LayerState state = load_layer_state(at);
    state.taken = kNone;  // so far
    if (layer.state_count > 0) follow_transitions(state, layer);
    has_taken = has_taken || state.taken != kNone;
    const float layer_weight = advance_weight(state, layer);
    note_transition(state, layer_weight);
    note_inertial_play(state, layer_weight);
    advance_fades(state, push.time_step_s);
    store_layer_state(at, state);
    show_plays(at, index, state, layer, weights_of_plays(state), layer_weight);
}

// Resets the triggers that transitions taken in this update tested.
void reset_triggers() {
    uint index = 0;
    do {
        const uint taken = has_taken ? layers[instance * layout_of_group.layer_count + index].taken : kNone;
        if (taken == kNone) continue;
        const ControlTransition transition = load_transition(taken);
        for (uint k = 0; k < transition.condition_count; ++k) {  // only where a transition is taken
            const ControlCondition condition = load_condition(transition.first_condition + k);
            if (condition.test == kTestTriggered) parameters[first_parameter + condition.parameter] = 0;
        }
    } while (has_taken && ++index < layout_of_group.layer_count);
}
