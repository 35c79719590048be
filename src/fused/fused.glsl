// Sample, blend, scan and bind in one pass: the host of a scan method whose local transforms are computed where it
// loads them, and whose model transforms become skin matrices where it stores them. Nothing else passes through memory.
// Two forms:
// - FUSED_TILED: a workgroup first computes the local transforms of its characters into shared memory, joints side by
//   side; for methods that load a joint more than once;
// - else load_local() computes: for methods that load each joint once.
// Bytes a joint: keys (once for all characters in the caches), 24 to 48 written; tiled also 48 through shared memory
// and back.
#include "gpu/buffers_io.h"
#include "bind/bind.glsl"
#include "blend/blend.glsl"
#include "blend/inertia_io.h"
#include "control/controller_io.h"
#include "cull/cull_io.h"
#include "fused/fused_io.h"
#include "gpu/table.glsl"

WORKGROUP_OF_CONSTANT;
READONLY_BUFFER(kCursorsBuffer, InstanceCursor, cursors);
TABLE_OF_ROWS(kTracksBuffer, tracks);
TABLE_OF_ROWS(kKeysBuffer, keys);
TABLE_OF_WORDS(kWordsBuffer, words);
TABLE_OF_WORDS(kScanLinksBuffer, link_words);
// [joint_count + 1]: where a joint's palette entries begin in the next two
TABLE_OF_WORDS(kBindRangesBuffer, bind_ranges);
TABLE_OF_WORDS(kBindEntriesBuffer, bind_entries);  // palette entries, sorted by joint
TABLE_OF_ROWS(kBindsBuffer, binds);                // their inverse binds, three rows each
BUFFER(kModelBuffer, StoredAffine, model);
TABLE_OF_ROWS(kActiveClipsBuffer, active_clips);  // of layers, in place of cursors
TABLE_OF_WORDS(kMasksBuffer, masks);
TABLE_OF_WORDS(kSocketSlotsBuffer, socket_slots);  // [joint_count]: 1 + the joint's place in sockets, or 0
WRITEONLY_BUFFER(kSocketsBuffer, StoredAffine, sockets);
READONLY_BUFFER(kInertiasBuffer, InstanceInertia, inertias);
BUFFER(kInertiaStatesBuffer, InertiaState, inertia_states);
TABLE_OF_WORDS(kPoseOverridesBuffer, pose_overrides);
TABLE_OF_ROWS(kSetPosesBuffer, poses);
TABLE_OF_WORDS(kWorkBuffer, work);                  // of listed instances (cull/cull_io.h)
TABLE_OF_WORDS(kAnimatedJointsBuffer, rig_joints);  // of a part of the joints: their numbers in the rig
// Named by methods that exchange through memory where shared memory is too small: no such plan is fused
#define scratch model
CONSTANT(8, bool, kPacked, false);
CONSTANT(9, bool, kBlends, true);  // false: every instance plays one clip
CONSTANT(10, bool, kKeepsModel, false);
CONSTANT(11, uint, kSkinFormat, kSkinAffine);
CONSTANT(12, bool, kOneBind, false);     // no joint has two palette entries
CONSTANT(13, uint, kTileInstances, 1);   // of a workgroup
CONSTANT(14, uint, kTileTransforms, 1);  // of all of them
CONSTANT(15, bool, kLayered, false);     // instances play active clips in layers, not two clips
CONSTANT(16, uint, kSocketCount, 0);
CONSTANT(17, bool, kInertial, false);       // of layers
CONSTANT(18, bool, kPoseOverrides, false);  // poses may be set
CONSTANT(19, bool, kListed, false);         // only listed instances are animated
CONSTANT(20, bool, kSomeJoints, false);     // not all joints are
PUSH(FusedPush);

#define SKIN_STORES
uint rig_joint_count() { return push.rig_joint_count; }
#include "bind/skin_format.glsl"
#include "blend/inertial.glsl"
#include "blend/pose_override.glsl"
#include "blend/active_clips.glsl"
#include "sample/sample.glsl"

uint link(uint index) { return WORD_AT(link_words, index); }
// Scan methods count what they are dispatched for; this is the instance that one stands for.
uint instance_at(uint index) { return kListed ? WORD_AT(work, WORD_AT(work, 2 * push.section) + index) : index; }
uint instance_count() { return kListed ? WORD_AT(work, 2 * push.section + 1) : push.instance_count; }

// Scan methods count the joints that are animated; clips, masks and poses those of the rig.
uint rig_joint(uint joint) { return kSomeJoints ? WORD_AT(rig_joints, joint) : joint; }
uint at(uint instance, uint joint) { return instance * push.rig_joint_count + joint; }

// Layers have none.
InstanceCursor cursor_of(uint instance) {
    InstanceCursor cursor;
    if (!kLayered) cursor = cursors[instance];
    return cursor;
}

SlotCursor only_slot(InstanceCursor cursor) {
    if (cursor.weight <= 0) return cursor.second;
    return cursor.first;
}

uvec4 tracks_of(SlotCursor slot, uint joint) { return ROW_AT(tracks, slot.first_track + joint); }

JointPose animated_pose(uint instance, InstanceCursor cursor, uint joint) {
    if (kInertial) return inertial_pose(instance, at(instance, joint), active_clips_pose(instance, joint));
    if (kLayered) return active_clips_pose(instance, joint);
    if (!kBlends) {
        const SlotCursor slot = only_slot(cursor);
        return sample_joint(tracks_of(slot, joint), slot);
    }
    JointPose first, second;
    if (cursor.weight > 0) first = sample_joint(tracks_of(cursor.first, joint), cursor.first);
    if (cursor.weight < 1) second = sample_joint(tracks_of(cursor.second, joint), cursor.second);
    if (cursor.weight >= 1) return first;
    if (cursor.weight <= 0) return second;
    return blend_joint(first, second, cursor.weight);
}

// The pose of a joint whose translation and scale are the rest pose's in every clip (scan/fixed_joints.h).
JointPose animated_pose_of_fixed(uint instance, InstanceCursor cursor, uint joint) {
    if (kInertial) return animated_pose(instance, cursor, joint);
    const uvec4 rest = ROW_AT(tracks, push.rest_track + joint) & kTrackPositionMask;
    JointPose pose;
    pose.translation = uintBitsToFloat(ROW_AT(keys, rest.y));
    pose.scale = uintBitsToFloat(ROW_AT(keys, rest.z));
    if (kLayered) {
        pose.rotation = active_clips_rotation(instance, joint);
        return pose;
    }
    if (!kBlends) {
        const SlotCursor slot = only_slot(cursor);
        pose.rotation = sample_rotation(tracks_of(slot, joint).x, slot);
        return pose;
    }
    vec4 first, second;
    if (cursor.weight > 0) first = sample_rotation(tracks_of(cursor.first, joint).x, cursor.first);
    if (cursor.weight < 1) second = sample_rotation(tracks_of(cursor.second, joint).x, cursor.second);
    if (cursor.weight >= 1)
        pose.rotation = first;
    else if (cursor.weight <= 0)
        pose.rotation = second;
    else
        pose.rotation = blend_rotation(first, second, cursor.weight);
    return pose;
}

JointPose local_pose(uint instance, InstanceCursor cursor, uint walked_joint) {
    const uint joint = rig_joint(walked_joint);
    const JointPose pose = animated_pose(instance, cursor, joint);
    if (kPoseOverrides) return overridden_pose(instance, joint, pose);
    return pose;
}

JointPose local_pose_of_fixed(uint instance, InstanceCursor cursor, uint walked_joint) {
    const uint joint = rig_joint(walked_joint);
    const JointPose pose = animated_pose_of_fixed(instance, cursor, joint);
    if (kPoseOverrides) return overridden_pose(instance, joint, pose);
    return pose;
}

Transform to_local(JointPose pose) {
#ifdef SCAN_QUATERNION
    return similarity_parent_from_joint(pose);
#else
    return parent_from_joint(pose);
#endif
}

void bind_entry(uint instance, uint i, Affine model_from_joint) {
    store_skin(instance * push.palette_count + WORD_AT(bind_entries, i),
               skin_matrix(model_from_joint, AFFINE_AT(binds, i)));
}

void store_instance(uint instance, uint joint, Transform transform) {
    const Affine model_from_joint = to_affine(transform);
    if (kKeepsModel) model[at(instance, rig_joint(joint))] = pack(model_from_joint);
    if (kSocketCount > 0) {
        const uint slot = WORD_AT(socket_slots, joint);
        if (slot > 0) sockets[instance * kSocketCount + slot - 1] = pack(model_from_joint);
    }
    const uint begin = WORD_AT(bind_ranges, joint), end = WORD_AT(bind_ranges, joint + 1);
    if (kOneBind) {  // without a loop, of which a software device runs one round more than there is to do
        if (begin < end) bind_entry(instance, begin, model_from_joint);
    } else {
        for (uint i = begin; i < end; ++i) bind_entry(instance, i, model_from_joint);
    }
}

void scan_barrier(bool through_buffers) { barrier(); }

#ifdef FUSED_TILED

shared StoredTransform tile[kTileTransforms];  // [instance of the workgroup][joint]

void begin_instance(uint index) {}
Transform load_local(uint index, uint joint) { return unpack(tile[index % kTileInstances * push.joint_count + joint]); }
void store_model(uint index, uint joint, Transform transform) { store_instance(instance_at(index), joint, transform); }

void main() {
    const uint first = gl_WorkGroupID.x * kTileInstances;
    for (uint slot = 0; slot < kTileInstances && first + slot < instance_count(); ++slot) {
        const uint instance = instance_at(first + slot);
        const InstanceCursor cursor = cursor_of(instance);
        for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += gl_WorkGroupSize.x)
            tile[slot * push.joint_count + joint] = pack(to_local(local_pose(instance, cursor, joint)));
    }
    barrier();
    scan();
}

#else

// The one that the invocation is at.
uint scan_instance;
InstanceCursor scan_cursor;

void begin_instance(uint index) {
    scan_instance = instance_at(index);
    scan_cursor = cursor_of(scan_instance);
}
Transform load_local(uint index, uint joint) { return to_local(local_pose(scan_instance, scan_cursor, joint)); }
Transform load_local_of_fixed(uint joint) { return to_local(local_pose_of_fixed(scan_instance, scan_cursor, joint)); }
void store_model(uint index, uint joint, Transform transform) { store_instance(scan_instance, joint, transform); }

void main() { scan(); }

#endif
