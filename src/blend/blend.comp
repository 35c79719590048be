// blend: two poses per joint, weighted per instance, -> parent_from_joint, then applies the pose override. Reads only
// poses whose weight is not 0. One workgroup per instance, joints in strides. Per joint it reads 48 or 96 bytes and
// writes 48, or 32 as similarities.
#include "gpu/buffers_io.h"
#include "blend/blend_io.h"
#include "gpu/table.glsl"

WORKGROUP(kBlendWorkgroupSize);
READONLY_BUFFER(kCursorsBuffer, InstanceCursor, cursors);
READONLY_BUFFER(kFirstPosesBuffer, JointPose, first_poses);
READONLY_BUFFER(kSecondPosesBuffer, JointPose, second_poses);
WRITEONLY_BUFFER(kLocalBuffer, vec4, local);
TABLE_OF_WORDS(kPoseOverridesBuffer, pose_overrides);
TABLE_OF_ROWS(kSetPosesBuffer, poses);
CONSTANT(1, bool, kSimilarity, false);
CONSTANT(2, bool, kPoseOverrides, false);
CONSTANT(3, bool, kVaries, false);
PUSH(BlendPush);

uint rig_joint_count() { return push.joint_count; }
#include "blend/local.glsl"
#include "control/births.glsl"
#include "blend/pose_override.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    if (kVaries && is_free(instance)) return;
    const float weight = cursors[instance].weight;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += kBlendWorkgroupSize) {
        const uint i = instance * push.joint_count + joint;
        JointPose pose;
        if (weight >= 1)
            pose = first_poses[i];
        else if (weight <= 0)
            pose = second_poses[i];
        else
            pose = blend_joint(first_poses[i], second_poses[i], weight);
        if (kPoseOverrides) pose = overridden_pose(instance, joint, pose);
        store_local(i, pose);
    }
}
