// One joint per invocation: begins a transition and applies it.
#include "blend/inertia.glsl"

WORKGROUP(64);
// [joint]: shown pose, shown before, target, target before
READONLY_BUFFER(0, JointPose, poses);
WRITEONLY_BUFFER(1, JointPose, results);
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
