#version 460
// One joint an invocation: begins a transition and applies it.
#include "blend/inertia.glsl"

layout(local_size_x = 64) in;
// [joint]: shown, shown before, target, target before
layout(set = 0, binding = 0, std430) readonly buffer Poses { JointPose poses[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Results { JointPose results[]; };
layout(push_constant) uniform Push {
    uint joint_count;
    float time_step_s, elapsed_s, duration_s;
};

void main() {
    const uint joint = gl_GlobalInvocationID.x;
    if (joint >= joint_count) return;
    const InertiaJoint inertia = inertia_begin(poses[4 * joint], poses[4 * joint + 1], poses[4 * joint + 2],
                                               poses[4 * joint + 3], time_step_s);
    results[joint] = inertia_apply(inertia, elapsed_s, duration_s, poses[4 * joint + 2]);
}
