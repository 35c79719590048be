// Sample, blend, scan and bind in one pass: the host of a scan method whose local transforms are computed where it loads them, and
// whose model transforms become skin matrices where it stores them. Nothing else passes through memory. Two forms:
//   FUSED_TILED    a workgroup first computes the local transforms of its characters into shared memory, joints side by side; for
//                  methods that load a joint more than once
//   else           load_local() computes: for methods that load each joint once
// Bytes a joint: keys (once for all characters in the caches), 24 to 48 written; tiled also 48 through shared memory and back.
#include "bind/bind.glsl"
#include "blend/blend.glsl"
#include "fused/fused_io.h"
#include "gpu/table.glsl"

layout(local_size_x_id = 0) in;
layout(set = 0, binding = 0, std430) readonly buffer Cursors { InstanceCursor cursors[]; };
TABLE_OF_ROWS(1, Tracks, tracks);
TABLE_OF_ROWS(2, Keys, keys);
TABLE_OF_WORDS(3, Words, words);
TABLE_OF_WORDS(4, Links, link_words);
TABLE_OF_WORDS(5, BindRanges, bind_ranges);    // [joint_count + 1]: where a joint's palette entries begin in the next two
TABLE_OF_WORDS(6, BindEntries, bind_entries);  // palette entries, sorted by joint
TABLE_OF_ROWS(7, Binds, binds);                // their inverse binds, three rows each
layout(set = 0, binding = 9, std430) buffer Model { StoredAffine model[]; };
#define scratch model  // named by methods that exchange through memory where shared memory is too small: no such plan is fused
layout(constant_id = 8) const bool kPacked = false;
layout(constant_id = 9) const bool kBlends = true;      // false: every instance plays one clip
layout(constant_id = 10) const bool kKeepsModel = false;
layout(constant_id = 11) const uint kSkinFormat = kSkinAffine;
layout(constant_id = 12) const uint kTileInstances = 1;  // of a workgroup
layout(constant_id = 13) const uint kTileTransforms = 1;  // of all of them
layout(push_constant) uniform Push { FusedPush push; };

#define SKIN_SET 0
#define SKIN_BINDING 8
#define SKIN_STORES
#include "bind/skin_format.glsl"
#include "sample/sample.glsl"

uint link(uint index) { return WORD_AT(link_words, index); }
uint at(uint instance, uint joint) { return instance * push.joint_count + joint; }

JointPose sampled(SlotCursor slot, uint joint) { return sample_joint(ROW_AT(tracks, slot.first_track + joint), slot); }

Transform local_transform(InstanceCursor cursor, uint joint) {
    JointPose pose;
    if (!kBlends) {
        SlotCursor slot = cursor.first;
        if (cursor.weight <= 0) slot = cursor.second;
        pose = sampled(slot, joint);
    } else {
        JointPose first, second;
        if (cursor.weight > 0) first = sampled(cursor.first, joint);
        if (cursor.weight < 1) second = sampled(cursor.second, joint);
        if (cursor.weight >= 1) pose = first;
        else if (cursor.weight <= 0) pose = second;
        else pose = blend_joint(first, second, cursor.weight);
    }
#ifdef SCAN_QUATERNION
    return similarity_parent_from_joint(pose);
#else
    return parent_from_joint(pose);
#endif
}

void store_model(uint instance, uint joint, Transform transform) {
    const Affine model_from_joint = to_affine(transform);
    if (kKeepsModel) model[at(instance, joint)] = pack(model_from_joint);
    const uint end = WORD_AT(bind_ranges, joint + 1);
    for (uint i = WORD_AT(bind_ranges, joint); i < end; ++i) {
        store_skin(instance * push.palette_count + WORD_AT(bind_entries, i), skin_matrix(model_from_joint, AFFINE_AT(binds, i)));
    }
}

void scan_barrier(bool through_buffers) { barrier(); }

#ifdef FUSED_TILED

shared StoredTransform tile[kTileTransforms];  // [instance of the workgroup][joint]

void scan_begin(uint instance) {}
Transform load_local(uint instance, uint joint) { return unpack(tile[instance % kTileInstances * push.joint_count + joint]); }

void main() {
    const uint first_instance = gl_WorkGroupID.x * kTileInstances;
    for (uint slot = 0; slot < kTileInstances && first_instance + slot < push.instance_count; ++slot) {
        const InstanceCursor cursor = cursors[first_instance + slot];
        for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += gl_WorkGroupSize.x)
            tile[slot * push.joint_count + joint] = pack(local_transform(cursor, joint));
    }
    barrier();
    scan();
}

#else

InstanceCursor scan_cursor;

void scan_begin(uint instance) { scan_cursor = cursors[instance]; }
Transform load_local(uint instance, uint joint) { return local_transform(scan_cursor, joint); }

void main() { scan(); }

#endif
