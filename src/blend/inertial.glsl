// Adds the decaying offset of an inertial transition to poses: steps 2 and 10 of docs/controller.md. The includer
// declares the buffers `inertias` (InstanceInertia) and `inertia_states` (InertiaState[instance][joint]).
#include "blend/inertia.glsl"
#include "control/controller_io.h"

// Must be called once per joint and update, since it records the pose that is shown.
JointPose inertial_pose(uint instance, uint index, JointPose target) {
    const InstanceInertia inertia = inertias[instance];
    InertiaState state = inertia_states[index];
    if (inertia.begins != 0) {
        // Without a known step the offset's speed is unknown; a step of 1e30 s makes it 0
        const float step_s = inertia.shown_count > 2 && inertia.shown_step_s > 0 ? inertia.shown_step_s : 1e30;
        state.offset = inertia_begin(state.shown, inertia.shown_count > 2 ? state.shown_before : state.shown, target,
                                     target, step_s);
    }
    JointPose pose = target;
    if (inertia.elapsed_s < inertia.duration_s)
        pose = inertia_apply(state.offset, inertia.elapsed_s, inertia.duration_s, target);
    state.shown_before = state.shown;
    state.shown = pose;
    inertia_states[index] = state;
    return pose;
}
