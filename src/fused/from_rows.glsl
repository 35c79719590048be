// For fused.glsl: samples local transforms from rows (fused/rows_io.h, native/gpu_rows.h). These are in the spaces of
// the bind pose, so that the walk yields skin matrices. Only for rigs of uniform scale, without pose overrides.
#include "blend/inertial.glsl"
#include "fused/rows_io.h"

READONLY_BUFFER(kRowsBuffer, uvec2, rows);
READONLY_BUFFER(kRowJointsBuffer, uvec4, row_joints);
READONLY_BUFFER(kRowPlacesBuffer, uint, row_places);
READONLY_BUFFER(kRowColumnsBuffer, uint, row_columns);
CONSTANT(kRowJointsId, uint, kRowJoints, 1);  // number of joints that have columns
CONSTANT(kOtherColumnsId, bool, kOtherColumns,
         false);  // columns are those of a finer set of joints: row_columns[joint]
CONSTANT(kFineRotationsId, uint, kFineRotations, 0);
CONSTANT(kMotionsId, uint, kMotions, 0);
CONSTANT(kFineMotionsId, uint, kFineMotions, 0);
CONSTANT(kPlainEntriesId, bool, kPlainEntries, false);  // all entries are plain
const uint kRowColumns = kRowJoints + kFineRotations + kMotions + kFineMotions;

// A time in a clip, between two rows.
struct RowPlace {
    uint earlier, later;  // index of each row's first column
    float fraction;
};

// The data of the lane's joint that is the same in all rows.
struct RowJoint {
    uint column, motion, fine_rotation;
    vec4 middle, step_size;  // map the rotation's words to a quaternion
    vec4 centre;             // translation, w: scale; of a joint with motion rows: the middle of their range
    vec3 pivot;
};

RowPlace first_place, second_place;
float first_weight;
RowJoint row_joint;

RowPlace row_place(ClipCursor cursor) {
    // Divides floats, which are exact enough here, since integer division is slow
    const uint clip = kRowClipWords * uint(float(cursor.first_track) / float(push.rig_joint_count) + 0.5);
    const float keys = float(cursor.earlier - row_places[clip]) * uintBitsToFloat(row_places[clip + 1]);
    const uint span = row_places[clip + 2] + kRowSpanWords * uint(keys + 0.5);
    const float pieces = uintBitsToFloat(row_places[span + 1]), place = cursor.fraction * pieces;
    const float piece = floor(min(place, pieces - 1));
    const uint earlier = (row_places[span] + uint(piece)) * kRowColumns;
    return RowPlace(earlier, cursor.later != cursor.earlier ? earlier + kRowColumns : earlier, place - piece);
}

void begin_clips(uint instance) {
    if (kLayered) return;
    const InstanceCursor cursor = cursors[instance];
    first_weight = cursor.weight;
    ClipCursor first = cursor.second;
    if (cursor.weight > 0) first = cursor.first;
    first_place = row_place(first);
    if (!kBlends) return;
    if (cursor.weight <= 0) first_weight = 1;
    second_place = row_place(cursor.second);
}

vec4 words_of(uvec2 pair) {
    const ivec2 high = ivec2(pair), low = high << 16;
    return vec4(ivec4(low.x, high.x, low.y, high.y) >> 16);
}

vec4 words_between(uint column, RowPlace place) {
    return mix(words_of(rows[place.earlier + column]), words_of(rows[place.later + column]), place.fraction);
}

// An unnormalised quaternion.
vec4 rotation_at(RowPlace place) {
    vec4 parts = words_between(row_joint.column, place);
    if (kFineRotations > 0 && row_joint.fine_rotation != kNoColumn)
        parts += words_between(kRowJoints + row_joint.fine_rotation, place) * (1.0 / 65536);
    return row_joint.middle + row_joint.step_size * parts;
}

// Translation and scale of a joint that does not only rotate.
vec4 motion_at(RowPlace place, vec4 step_size) {
    const uint column = kRowJoints + kFineRotations + row_joint.motion;
    vec4 parts = words_between(column, place);
    if (row_joint.motion < kFineMotions) parts += words_between(column + kMotions, place) * (1.0 / 65536);
    return row_joint.centre + step_size * parts;
}

vec4 motion_step() { return uintBitsToFloat(row_joints[kRowJointRows * kRowJoints + row_joint.motion]); }
bool moves() { return kMotions > 0 && row_joint.motion != kNoColumn; }

vec4 clip_rotation(ClipCursor cursor, uint joint) {
    const vec4 q = rotation_at(row_place(cursor));
    return q * inversesqrt(dot(q, q));
}

JointPose clip_pose(ClipCursor cursor, uint joint) {
    const RowPlace place = row_place(cursor);
    const vec4 q = rotation_at(place);
    vec4 motion = row_joint.centre;
    if (moves()) motion = motion_at(place, motion_step());
    return JointPose(q * inversesqrt(dot(q, q)), vec4(motion.xyz, 0), motion.wwww);
}

#include "blend/active_clips.glsl"

void begin_joint(uint joint) {
    row_joint.column = kOtherColumns ? row_columns[joint] : joint;
    const uvec4 range = row_joints[kRowRange * kRowJoints + row_joint.column],
                pivot = row_joints[kRowPivot * kRowJoints + row_joint.column];
    row_joint.middle = vec4(unpackHalf2x16(range.x), unpackHalf2x16(range.y));
    row_joint.step_size = vec4(unpackHalf2x16(range.z), unpackHalf2x16(range.w));
    row_joint.centre = uintBitsToFloat(row_joints[kRowCentre * kRowJoints + row_joint.column]);
    row_joint.pivot = uintBitsToFloat(pivot.xyz);
    row_joint.motion = pivot.w & 0xFFFFu;
    row_joint.fine_rotation = pivot.w >> 16;
}

// The transform p -> scale * rotate(q, p - pivot) + translation. `q` need not be normalised.
Affine turned(vec4 q, vec4 motion) {
    const float scale = motion.w;
    const vec3 v = q.xyz * (2 * scale / dot(q, q));
    const float xx = q.x * v.x, yy = q.y * v.y, zz = q.z * v.z, xy = q.x * v.y, xz = q.x * v.z, yz = q.y * v.z;
    const vec3 w = q.w * v;
    Affine m = Affine(vec4(scale - yy - zz, xy - w.z, xz + w.y, 0), vec4(xy + w.z, scale - xx - zz, yz - w.x, 0),
                      vec4(xz - w.y, yz + w.x, scale - xx - yy, 0));
    m.row0.w = motion.x - dot(m.row0.xyz, row_joint.pivot);
    m.row1.w = motion.y - dot(m.row1.xyz, row_joint.pivot);
    m.row2.w = motion.z - dot(m.row2.xyz, row_joint.pivot);
    return m;
}

// Like blend_rotation(), but takes and returns unnormalised quaternions.
vec4 blend_of_any_length(vec4 a, vec4 b, float weight) {
    const float of_b = (1 - weight) * inversesqrt(dot(b, b));
    return a * (weight * inversesqrt(dot(a, a))) + b * (dot(a, b) < 0 ? -of_b : of_b);
}

Transform local_transform(uint instance, uint joint) {
    begin_joint(joint);
    if (kLayered) {
        const uint number = rig_joint(joint);
        JointPose pose = active_clips_pose(instance, number);
        if (kInertial) pose = inertial_pose(instance, at(instance, number), pose);
        return turned(pose.rotation, vec4(pose.translation.xyz, pose.scale.x));
    }
    const bool blends = kBlends && first_weight < 1;
    vec4 q = rotation_at(first_place);
    if (blends) q = blend_of_any_length(q, rotation_at(second_place), first_weight);
    vec4 motion = row_joint.centre;
    if (moves()) {
        const vec4 step_size = motion_step();
        motion = motion_at(first_place, step_size);
        if (blends) motion = mix(motion_at(second_place, step_size), motion, first_weight);
    }
    return turned(q, motion);
}

Affine model_from_joint_of(Transform walked, uint joint) {
    const uint at = kRowSpace * kRowJoints + (kOtherColumns ? row_columns[joint] : joint);
    return affine_multiply(walked, Affine(uintBitsToFloat(row_joints[at]), uintBitsToFloat(row_joints[at + kRowJoints]),
                                          uintBitsToFloat(row_joints[at + 2 * kRowJoints])));
}

void bind_entry(uint instance, uint i, Affine walked) {
    const uint entry = WORD_AT(bind_entries, i);
    if (!kPlainEntries && (entry & kPlainEntry) == 0) walked = affine_multiply(walked, AFFINE_AT(binds, i));
    store_skin(palette_of(instance) + (entry & ~kPlainEntry), walked);
}
