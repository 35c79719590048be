// layered: the active clips of each instance -> parent_from_joint. Samples and blends in one pass, for characters that
// play clips in layers. One workgroup per instance, joints in strides. Reads 32 bytes per active clip; per joint and
// active clip, 16 bytes of table and up to 6 keys of 16 bytes (fewer if packed; twice that for additive clips). Writes
// 48 bytes per joint, or 32 as similarities.
#include "blend/layered_io.h"

PUSH(LayeredPush);
#include "blend/layered.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    if (kVaries && is_free(instance)) return;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += kLayeredWorkgroupSize)
        pose_joint(instance, joint);
}
