// When inertial transitions begin and end: the includer declares `inertias` and `instance`.
#include "control/controller_io.h"

// Of an inertial transition or play that this update begins with, of the highest layer that has one; 0: none
float begun_duration_s;

void begin_inertia() { begun_duration_s = 0; }

void note_transition(LayerState state) {
    if (state.taken == kAbsent) return;
    const ControlTransition transition = load_transition(state.taken);
    if ((transition.flags & kTransitionInertial) != 0 && transition.fade_rate > 0)
        begun_duration_s = 1 / transition.fade_rate;
}

void note_inertial_play(LayerState state) {
    if (state.inertial_rate > 0) begun_duration_s = 1 / state.inertial_rate;
}

void end_inertia() {
    if ((push.flags & kPushIsInertial) == 0) return;
    InstanceInertia inertia = inertias[instance];
    const float step_s = max(push.time_step_s, 0);
    inertia.begins = begun_duration_s > 0 && inertia.shown_count > 0 ? 1 : 0;
    inertia.shown_step_s = inertia.time_step_s;
    inertia.elapsed_s = inertia.begins != 0 ? step_s : min(inertia.elapsed_s + step_s, 1e6);
    if (inertia.begins != 0) inertia.duration_s = begun_duration_s;
    inertia.shown_count = min(inertia.shown_count + 1, 3);
    inertia.time_step_s = step_s;
    inertias[instance] = inertia;
}
