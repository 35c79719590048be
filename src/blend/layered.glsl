// What both layered kernels read and write, and what they do with a joint. The includer declares `push`, and where it
// defines ACTIVE_CLIPS_IN_ORDER what blend/model_rotations.glsl asks for.
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

uint rig_joint_count() { return push.joint_count; }
#include "blend/local.glsl"
#include "blend/inertial.glsl"
#ifdef ACTIVE_CLIPS_IN_ORDER
#include "blend/model_rotations.glsl"
#endif
#include "blend/pose_override.glsl"
#include "blend/active_clips.glsl"

void pose_joint(uint instance, uint joint) {
    const uint index = instance * push.joint_count + joint;
    JointPose pose = active_clips_pose(instance, joint);
    if (kInertial) pose = inertial_pose(instance, index, pose);
    if (kPoseOverrides) pose = overridden_pose(instance, joint, pose);
    store_local(index, pose);
}
