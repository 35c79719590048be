// When inertial transitions begin and end. Included after control/layer.glsl. The includer declares `inertias`.

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
