// layered: the active clips of each instance to parent_from_joint: sample and blend in one, for characters that play in
// layers. One workgroup per instance, joints in strides. Reads 32 bytes an active clip, and for each joint and active
// clip 16 bytes of table and up to 6 keys of 16 bytes, packed ones fewer, additive active clips twice that; writes 48
// bytes a joint, or 32 as similarities.
#include "blend/layered_io.h"

PUSH(LayeredPush);
#include "blend/layered.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += kLayeredWorkgroupSize)
        pose_joint(instance, joint);
}
