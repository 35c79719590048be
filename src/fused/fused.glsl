// Sample, blend, scan and bind in one pass. This is the host of a scan method: when the method loads a local transform,
// it is computed, and when the method stores a model transform, it becomes skin matrices. Nothing else goes through
// memory. There are two forms:
// - FUSED_TILED: a workgroup first computes the local transforms of its characters into shared memory, in parallel over
//   joints. For methods that load a joint more than once.
// - Otherwise load_local() computes them. For methods that load each joint once.
// Bytes per joint: keys, or with rows 8 for each column and row (which all characters share in the caches); 24 to 48
// written; if tiled, also 48 to shared memory and back.
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
TABLE_OF_WORDS(kScanLinksBuffer, link_words);
// [joint_count + 1]: where a joint's palette entries begin in bind_entries and binds
TABLE_OF_WORDS(kBindRangesBuffer, bind_ranges);
TABLE_OF_WORDS(kBindEntriesBuffer, bind_entries);  // palette entries, sorted by joint
TABLE_OF_ROWS(kBindsBuffer, binds);                // three rows each: walked matrix * bind = skin matrix
BUFFER(kModelBuffer, StoredAffine, model);
TABLE_OF_ROWS(kActiveClipsBuffer, active_clips);  // with layers, in place of cursors
TABLE_OF_WORDS(kMasksBuffer, masks);
TABLE_OF_WORDS(kSocketSlotsBuffer, socket_slots);  // [joint_count]: 1 + the joint's place in sockets, or 0
WRITEONLY_BUFFER(kSocketsBuffer, StoredAffine, sockets);
READONLY_BUFFER(kInertiasBuffer, InstanceInertia, inertias);
BUFFER(kInertiaStatesBuffer, InertiaState, inertia_states);
TABLE_OF_WORDS(kWorkBuffer, work);                  // which instances are listed (cull/cull_io.h)
TABLE_OF_WORDS(kSkinRowsBuffer, skin_rows);         // [instance]: row in the skin pool
TABLE_OF_WORDS(kAnimatedJointsBuffer, rig_joints);  // with kMapsJoints: index of each joint in the rig
// Only so that methods that exchange through memory compile; plans that would use it are not fused
#define scratch model
CONSTANT(kBlendsId, bool, kBlends, true);  // false: every instance plays one clip
CONSTANT(kKeepsModelId, bool, kKeepsModel, false);
CONSTANT(kSkinFormatId, uint, kSkinFormat, kSkinAffine);
CONSTANT(kOneBindId, bool, kOneBind, false);            // no joint has two palette entries
CONSTANT(kTileInstancesId, uint, kTileInstances, 1);    // instances of a workgroup
CONSTANT(kTileTransformsId, uint, kTileTransforms, 1);  // local transforms of all of them
CONSTANT(kLayeredId, bool, kLayered, false);            // instances play active clips in layers, not two clips
CONSTANT(kSocketCountId, uint, kSocketCount, 0);
CONSTANT(kInertialId, bool, kInertial, false);      // layers with inertial transitions
CONSTANT(kListedId, bool, kListed, false);          // only listed instances are animated
CONSTANT(kMapsJointsId, bool, kMapsJoints, false);  // only some joints are animated, or in another order
CONSTANT(kSkinPoolId, bool, kSkinPool, false);      // skin matrices lie in a pool, not in the order of the instances
PUSH(FusedPush);

#define SKIN_STORES
uint rig_joint_count() { return push.rig_joint_count; }
#include "bind/skin_format.glsl"

uint link(uint index) { return WORD_AT(link_words, index); }
// Maps the index of an instance in the dispatch, which scan methods use, to the instance.
uint instance_at(uint index) { return kListed ? WORD_AT(work, WORD_AT(work, 2 * push.section) + index) : index; }
uint instance_count() { return kListed ? WORD_AT(work, 2 * push.section + 1) : push.instance_count; }

// Maps an animated joint, as scan methods number them, to a joint of the rig, as clips, masks and poses number them.
uint rig_joint(uint joint) { return kMapsJoints ? WORD_AT(rig_joints, joint) : joint; }
// Where an instance's skin matrices begin.
uint palette_of(uint instance) { return (kSkinPool ? WORD_AT(skin_rows, instance) : instance) * push.palette_count; }
uint at(uint instance, uint joint) { return instance * push.rig_joint_count + joint; }

#ifdef FUSED_ROWS
#include "fused/from_rows.glsl"
#else
#include "fused/from_keys.glsl"
#endif

void store_instance(uint instance, uint joint, Transform walked) {
    if (kKeepsModel || kSocketCount > 0) {
        const uint number = rig_joint(joint);
        const uint slot = kSocketCount > 0 ? WORD_AT(socket_slots, number) : 0;
        if (kKeepsModel || slot > 0) {
            const StoredAffine model_from_joint = pack(model_from_joint_of(walked, joint));
            if (kKeepsModel) model[at(instance, number)] = model_from_joint;
            if (slot > 0) sockets[instance * kSocketCount + slot - 1] = model_from_joint;
        }
    }
    const Affine affine = to_affine(walked);
    const uint begin = WORD_AT(bind_ranges, joint), end = WORD_AT(bind_ranges, joint + 1);
    if (kOneBind) {  // no loop: a software device would run one iteration more than needed
        if (begin < end) bind_entry(instance, begin, affine);
    } else {
        for (uint i = begin; i < end; ++i) bind_entry(instance, i, affine);
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
        begin_clips(instance);
        for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += gl_WorkGroupSize.x)
            tile[slot * push.joint_count + joint] = pack(local_transform(instance, joint));
    }
    barrier();
    scan();
}

#else

uint scan_instance;  // the instance of this invocation

void begin_instance(uint index) {
    scan_instance = instance_at(index);
    begin_clips(scan_instance);
}
Transform load_local(uint index, uint joint) { return local_transform(scan_instance, joint); }
#ifndef FUSED_ROWS
Transform load_local_of_fixed(uint joint) { return local_transform_of_fixed(scan_instance, joint); }
#endif
void store_model(uint index, uint joint, Transform transform) { store_instance(scan_instance, joint, transform); }

void main() { scan(); }

#endif
