#version 460
// layered: the active clips of each instance to parent_from_joint: sample and blend in one, for characters that play in
// layers. One workgroup per instance, joints in strides. Reads 32 bytes an active clip, and for each joint and active
// clip 16 bytes of table and up to 6 keys of 16 bytes, packed ones fewer, additive active clips twice that; writes 48
// bytes a joint, or 32 as similarities.
#include "gpu/buffers_io.h"
#include "blend/inertia_io.h"
#include "blend/layered_io.h"
#include "control/controller_io.h"
#include "gpu/table.glsl"

layout(local_size_x = kLayeredWorkgroupSize) in;
TABLE_OF_ROWS(kActiveClipsBuffer, ActiveClips, active_clips);
TABLE_OF_WORDS(kMasksBuffer, Masks, masks);
TABLE_OF_ROWS(kTracksBuffer, Tracks, tracks);
TABLE_OF_ROWS(kKeysBuffer, Keys, keys);
TABLE_OF_WORDS(kWordsBuffer, Words, words);
layout(set = 0, binding = kLocalBuffer, std430) writeonly buffer Local { vec4 local[]; };
layout(set = 0, binding = kInertiasBuffer, std430) readonly buffer Inertias { InstanceInertia inertias[]; };
layout(set = 0, binding = kInertiaStatesBuffer, std430) buffer InertiaStates { InertiaState inertia_states[]; };
TABLE_OF_WORDS(kPoseOverridesBuffer, PoseOverrides, pose_overrides);
TABLE_OF_ROWS(kSetPosesBuffer, Poses, poses);
layout(constant_id = 1) const bool kPacked = false;
layout(constant_id = 2) const bool kSimilarity = false;
layout(constant_id = 3) const bool kInertial = false;
layout(constant_id = 4) const bool kPoseOverrides = false;
layout(push_constant) uniform Push { LayeredPush push; };

uint rig_joint_count() { return push.joint_count; }
#include "blend/local.glsl"
#include "blend/inertial.glsl"
#include "blend/pose_override.glsl"
#include "blend/active_clips.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += kLayeredWorkgroupSize) {
        const uint index = instance * push.joint_count + joint;
        JointPose pose = active_clips_pose(instance, joint);
        if (kInertial) pose = inertial_pose(instance, index, pose);
        if (kPoseOverrides) pose = overridden_pose(instance, joint, pose);
        store_local(index, pose);
    }
}
