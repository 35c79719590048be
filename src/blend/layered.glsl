// The buffers of both layered kernels, and what they do for one joint. The includer declares `push` and, if it defines
// ACTIVE_CLIPS_IN_ORDER, what blend/model_rotations.glsl needs.
#include "gpu/buffers_io.h"
#include "blend/inertia_io.h"
#include "blend/layered_io.h"
#include "control/controller_io.h"
#include "gpu/table.glsl"

WORKGROUP(kLayeredWorkgroupSize);
TABLE_OF_ROWS(kActiveClipsBuffer, active_clips);
TABLE_OF_WORDS(kMasksBuffer, masks);
TABLE_OF_ROWS(kTracksBuffer, tracks);
TABLE_OF_ROWS(kKeysBuffer, keys);
TABLE_OF_WORDS(kWordsBuffer, words);
WRITEONLY_BUFFER(kLocalBuffer, vec4, local);
READONLY_BUFFER(kInertiasBuffer, InstanceInertia, inertias);
BUFFER(kInertiaStatesBuffer, InertiaState, inertia_states);
TABLE_OF_WORDS(kPoseOverridesBuffer, pose_overrides);
TABLE_OF_ROWS(kSetPosesBuffer, poses);
CONSTANT(1, bool, kPacked, false);
CONSTANT(2, bool, kSimilarity, false);
CONSTANT(3, bool, kInertial, false);
CONSTANT(4, bool, kPoseOverrides, false);
CONSTANT(5, bool, kVaries, false);

uint rig_joint_count() { return push.joint_count; }
#include "blend/local.glsl"
#include "blend/inertial.glsl"
#ifdef ACTIVE_CLIPS_IN_ORDER
#include "blend/model_rotations.glsl"
#endif
#include "blend/pose_override.glsl"
#include "blend/active_clips.glsl"
#include "control/births.glsl"

void pose_joint(uint instance, uint joint) {
    const uint index = instance * push.joint_count + joint;
    JointPose pose = active_clips_pose(instance, joint);
    if (kInertial) pose = inertial_pose(instance, index, pose);
    if (kPoseOverrides) pose = overridden_pose(instance, joint, pose);
    store_local(index, pose);
}
