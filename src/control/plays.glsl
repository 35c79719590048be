// The stack of a layer's plays: steps 2, 3, 5 and 6 of docs/controller.md. C++ too, as control/blend_space.glsl.
#include "control/blend_space.glsl"
#include "control/stack.glsl"

bool holds(ControlCondition condition) {
    const float value = parameter_at(condition.parameter);
    if (condition.test == kTestAbove) return value > condition.value;
    if (condition.test == kTestBelow) return value < condition.value;
    return condition.test == kTestFalse ? value == 0 : value != 0;
}

// `phase`: how much of its current cycle the leading play has played.
bool can_be_taken(ControlTransition transition, uint loops, uint phase, bool fading) {
    bool can = (!fading || (transition.flags & kTransitionInterrupts) != 0) &&
               (loops > transition.exit_loops || (loops == transition.exit_loops && phase >= transition.exit_phase));
    uint k = 0;
    do can = can && (k >= transition.condition_count || holds(load_condition(transition.first_condition + k)));
    while (++k < transition.condition_count && can);
    return can;
}

// The first transition that can be taken, or kNone.
uint choose_transition(LayerState state, ControlLayer layer) {
    const ControlState leading = load_state(layer.first_state + state.plays[0].motion);
    const bool fading = state.play_count > 1 && state.plays[0].fade < 1;
    const uint end = leading.first_transition + leading.transition_count;
    const uint loops = state.plays[0].loops, phase = state.plays[0].phase;
    const uint played = leading.speed < 0 ? kLastPhase - phase : phase;
    uint chosen = kNone, i = leading.first_transition;
    do
        if (i < end && can_be_taken(load_transition(i), loops, played, fading)) chosen = i;
    while (++i < end && chosen == kNone);
    return chosen;
}

LayerPlay play_of_state(ControlLayer layer, uint motion, float fade_rate, bool at_once) {
    const uint phase = load_state(layer.first_state + motion).speed < 0 ? kLastPhase : 0;
    const LayerPlay play = {motion, phase, 0, float(at_once), fade_rate, 0, 0};
    return play;
}

void follow_transitions(INOUT(LayerState) state, ControlLayer layer) {
    if (state.play_count == 0) {
        push_play(state, play_of_state(layer, 0, 0, true));
        return;
    }
    state.taken = choose_transition(state, layer);
    if (state.taken == kNone) return;
    const ControlTransition transition = load_transition(state.taken);
    LayerPlay play = play_of_state(layer, transition.to, transition.fade_rate,
                                   transition.fade_rate == 0 || (transition.flags & kTransitionInertial) != 0);
    const uint sync = load_state(layer.first_state + transition.to).sync;
    uint k = state.play_count;
    do
        if (sync != kNone && load_state(layer.first_state + state.plays[k - 1].motion).sync == sync)
            play.phase = state.plays[k - 1].phase;
    while (sync != kNone && --k > 0);
    push_play(state, play);
}

// Advances fades and drops plays that are fully covered.
void advance_fades(INOUT(LayerState) state, float time_step_s) {
    uint count = state.play_count;
    for (uint k = kStackSize; k-- > 0;) {
        if (k + 1 >= state.play_count) continue;  // the oldest does not fade
        const float fade = min(sum(state.plays[k].fade, product(max(time_step_s, 0), state.plays[k].fade_rate)), 1);
        state.plays[k].fade = fade;
        if (fade >= 1) count = k + 1;
    }
    state.play_count = count;
}

// How much of each play is seen.
vec3 weights_of_plays(LayerState state) {
    vec3 weights = vec3(0);
    float remaining = 1;
    for (uint k = 0; k < kStackSize; ++k) {
        if (k >= state.play_count) break;
        const float fade = state.plays[k].fade;
        const float eased = k + 1 == state.play_count ? 1 : product(product(fade, fade), difference(3, 2 * fade));
        weights[k] = product(remaining, eased);
        remaining = product(remaining, difference(1, eased));
    }
    return weights;
}

const float kMaxCycles = float(kMaxLoops);  // of an update

// What one update did to a play's time.
struct PhaseStep {
    uint before, after;
    int crossed;       // ends of the clip, positive forwards; 0 if it does not loop
    bool reached_end;  // only if it does not loop
    float cycles;      // by which the phase advances; x in docs/controller.md
};

PhaseStep step_phase(INOUT(LayerPlay) play, float rate, bool loop, bool backwards, float time_step_s) {
    PhaseStep phase_step;
    phase_step.before = play.phase;
    phase_step.reached_end = false;
    const float asked = product(time_step_s, rate);
    const float x = isnan(asked) ? 0 : clamp(asked, -kMaxCycles, kMaxCycles);
    phase_step.cycles = x;
    float whole = floor(x), part = difference(x, whole);
    if (part >= 1) {
        part = 0;
        whole = whole + 1;
    }
    const uint after = play.phase + uint(part * 4294967296.0);
    const int crossed = int(whole) + (after < play.phase ? 1 : 0);
    if (loop) {
        play.phase = after;
        play.loops = uint(clamp(int(play.loops) + (backwards ? -crossed : crossed), 0, int(kMaxLoops)));
        phase_step.crossed = crossed;
    } else {
        if (crossed != 0)
            play.phase = crossed > 0 ? kLastPhase : 0;
        else
            play.phase = after;
        phase_step.crossed = 0;
        phase_step.reached_end = play.phase == kLastPhase && phase_step.before != kLastPhase;
    }
    phase_step.after = play.phase;
    return phase_step;
}
