#version 460
// layered, in order: as layered.comp, where layers blend rotations in model space: these need what lies above a joint,
// so an invocation walks its instance's joints, parents before children. Reads and writes beside what layered.comp does
// 96 bytes a joint and layer in model space. A dispatch takes the joints that a software device's loops can go through
// (record_layered_in_order()); the rotations pass from one to the next in memory.
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
TABLE_OF_WORDS(kParentsBuffer, Parents, parents);
layout(set = 0, binding = kRotationsBuffer, std430) buffer Rotations { ModelRotations rotations[]; };
layout(constant_id = 1) const bool kPacked = false;
layout(constant_id = 2) const bool kSimilarity = false;
layout(constant_id = 3) const bool kInertial = false;
layout(constant_id = 4) const bool kPoseOverrides = false;
layout(push_constant) uniform Push { LayeredInOrderPush push; };

#define ACTIVE_CLIPS_IN_ORDER
uint rig_joint_count() { return push.joint_count; }
#include "blend/local.glsl"
#include "blend/inertial.glsl"
#include "blend/model_rotations.glsl"
#include "blend/pose_override.glsl"
#include "blend/active_clips.glsl"

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count) return;
    for (uint joint = push.first_joint; joint < push.joint_end; ++joint) {
        const uint index = instance * push.joint_count + joint;
        JointPose pose = active_clips_pose(instance, joint);
        if (kInertial) pose = inertial_pose(instance, index, pose);
        if (kPoseOverrides) pose = overridden_pose(instance, joint, pose);
        store_local(index, pose);
    }
}
