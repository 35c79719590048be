// An inertial transition samples only its target. The offset from the target to the pose shown before keeps its speed
// at first, then decays to 0. Source: D. Bollo, Inertialization: High-Performance Animation Transitions in Gears of
// War, GDC 2018. Difference from it: scales decay as translations do. Defined by inertia_reference.h.
#include "blend/inertia_io.h"
#include "gpu/angles.glsl"
#include "gpu/similarity.glsl"
#include "sample/sample_io.h"

// A quintic that starts at offset x (>= 0) with speed v (<= 0), and reaches 0 with speed and acceleration 0 after
// `duration_s`, or earlier if it would otherwise overshoot.
float decayed(float x, float v, float elapsed_s, float duration_s) {
    const float end_s = v < 0 ? min(duration_s, -5 * x / v) : duration_s;
    if (elapsed_s >= end_s) return 0;
    // u, a: speed and acceleration in units of end_s
    const float s = elapsed_s / end_s, u = v * end_s, a = max(-8 * u - 20 * x, 0);
    return ((((-0.5 * (a + 6 * u + 12 * x) * s + 0.5 * (3 * a + 16 * u + 30 * x)) * s -
              0.5 * (3 * a + 12 * u + 20 * x)) *
                 s +
             0.5 * a) *
                s +
            u) *
               s +
           x;
}

vec4 inertia_of_vector(vec3 offset, vec3 offset_before, float time_step_s) {
    const float size = sqrt(dot(offset, offset));
    const vec3 direction = size > 0 ? offset / size : vec3(0);
    return vec4(offset, min((size - dot(offset_before, direction)) / time_step_s, 0));
}

// The angle, -pi..pi, of the rotation's twist about `axis`.
float angle_about(vec4 q, vec3 axis) {
    const vec2 twist = (q.w < 0 ? -1 : 1) * vec2(dot(q.xyz, axis), q.w);
    const float size = sqrt(dot(twist, twist));
    return size > 0 ? 4 * atan_unit(twist.x / (size + twist.y)) : 0;
}

vec4 inertia_of_rotation(vec4 offset, vec4 offset_before, float time_step_s) {
    const vec3 sine = offset.w < 0 ? -offset.xyz : offset.xyz;
    const float size = sqrt(dot(sine, sine));
    const vec3 axis = size > 0 ? sine / size : vec3(0);
    const float angle_rad = angle_about(offset, axis), step_rad = angle_rad - angle_about(offset_before, axis);
    const float shorter_rad = step_rad - 4 * kHalfPi * round(step_rad / (4 * kHalfPi));
    return vec4(axis * angle_rad, min(shorter_rad / time_step_s, 0));
}

vec4 rotation_offset(vec4 to, vec4 from) { return quaternion_multiply(to, vec4(-from.xyz, from.w)); }

// Begins a transition from the last two poses shown and the target's poses at the same two times, `time_step_s` apart.
// If `target_before` equals `target`, as in inertial_pose(), the offset's speed is that of the poses shown.
InertiaJoint inertia_begin(JointPose shown, JointPose shown_before, JointPose target, JointPose target_before,
                           float time_step_s) {
    return InertiaJoint(
        inertia_of_rotation(rotation_offset(shown.rotation, target.rotation),
                            rotation_offset(shown_before.rotation, target_before.rotation), time_step_s),
        inertia_of_vector(shown.translation.xyz - target.translation.xyz,
                          shown_before.translation.xyz - target_before.translation.xyz, time_step_s),
        inertia_of_vector(shown.scale.xyz - target.scale.xyz, shown_before.scale.xyz - target_before.scale.xyz,
                          time_step_s));
}

// The fraction of the initial offset that is left.
float inertia_left(vec4 inertia, float elapsed_s, float duration_s) {
    const float size = sqrt(dot(inertia.xyz, inertia.xyz));
    return size > 0 ? decayed(size, inertia.w, elapsed_s, duration_s) / size : 0;
}

// The pose to show `elapsed_s` after the last pose given to inertia_begin(). `target`: the current target pose.
JointPose inertia_apply(InertiaJoint inertia, float elapsed_s, float duration_s, JointPose target) {
    const vec3 half_turn = 0.5 * inertia_left(inertia.rotation, elapsed_s, duration_s) * inertia.rotation.xyz;
    const float angle_rad = min(sqrt(dot(half_turn, half_turn)), kHalfPi);
    const vec3 axis = angle_rad > 0 ? half_turn / angle_rad : vec3(0);
    JointPose pose = target;
    pose.rotation = quaternion_multiply(vec4(axis * sin_quarter(angle_rad), sin_quarter(kHalfPi - angle_rad)),
                                        target.rotation);
    pose.translation.xyz += inertia_left(inertia.translation, elapsed_s, duration_s) * inertia.translation.xyz;
    pose.scale.xyz += inertia_left(inertia.scale, elapsed_s, duration_s) * inertia.scale.xyz;
    return pose;
}
