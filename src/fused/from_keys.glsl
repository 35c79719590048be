// For fused.glsl: samples local transforms from a character's keys, exact or packed, and multiplies model transforms by
// its inverse binds to get skin matrices.
#include "blend/inertial.glsl"

TABLE_OF_ROWS(kTracksBuffer, tracks);
TABLE_OF_ROWS(kKeysBuffer, keys);
TABLE_OF_WORDS(kWordsBuffer, words);
TABLE_OF_WORDS(kPoseOverridesBuffer, pose_overrides);
TABLE_OF_ROWS(kSetPosesBuffer, poses);
CONSTANT(kPackedId, bool, kPacked, false);
CONSTANT(kPoseOverridesId, bool, kPoseOverrides, false);  // the application may set poses
#include "blend/pose_override.glsl"
#include "blend/active_clips.glsl"
#include "sample/sample.glsl"

InstanceCursor cursor;  // of the current instance; not used with layers

void begin_clips(uint instance) {
    if (!kLayered) cursor = cursors[instance];
}

ClipCursor only_clip() {
    if (cursor.weight <= 0) return cursor.second;
    return cursor.first;
}

uvec4 tracks_of(ClipCursor of_clip, uint joint) { return ROW_AT(tracks, of_clip.first_track + joint); }

JointPose animated_pose(uint instance, uint joint) {
    if (kInertial) return inertial_pose(instance, at(instance, joint), active_clips_pose(instance, joint));
    if (kLayered) return active_clips_pose(instance, joint);
    if (!kBlends) {
        const ClipCursor only = only_clip();
        return sample_joint(tracks_of(only, joint), only);
    }
    JointPose first, second;
    if (cursor.weight > 0) first = sample_joint(tracks_of(cursor.first, joint), cursor.first);
    if (cursor.weight < 1) second = sample_joint(tracks_of(cursor.second, joint), cursor.second);
    if (cursor.weight >= 1) return first;
    if (cursor.weight <= 0) return second;
    return blend_joint(first, second, cursor.weight);
}

// The pose of a joint whose translation and scale equal the rest pose's in every clip (fused/fixed_joints.h).
JointPose animated_pose_of_fixed(uint instance, uint joint) {
    if (kInertial) return animated_pose(instance, joint);
    const uvec4 rest = ROW_AT(tracks, push.rest_track + joint) & kTrackPositionMask;
    JointPose pose;
    pose.translation = uintBitsToFloat(ROW_AT(keys, rest.y));
    pose.scale = uintBitsToFloat(ROW_AT(keys, rest.z));
    if (kLayered) {
        pose.rotation = active_clips_rotation(instance, joint);
        return pose;
    }
    if (!kBlends) {
        const ClipCursor only = only_clip();
        pose.rotation = sample_rotation(tracks_of(only, joint).x, only);
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

JointPose local_pose(uint instance, uint walked_joint) {
    const uint joint = rig_joint(walked_joint);
    const JointPose pose = animated_pose(instance, joint);
    if (kPoseOverrides) return overridden_pose(instance, joint, pose);
    return pose;
}

JointPose local_pose_of_fixed(uint instance, uint walked_joint) {
    const uint joint = rig_joint(walked_joint);
    const JointPose pose = animated_pose_of_fixed(instance, joint);
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

Transform local_transform(uint instance, uint joint) { return to_local(local_pose(instance, joint)); }
Transform local_transform_of_fixed(uint instance, uint joint) { return to_local(local_pose_of_fixed(instance, joint)); }

Affine model_from_joint_of(Transform walked, uint joint) { return to_affine(walked); }

void bind_entry(uint instance, uint i, Affine walked) {
    store_skin(palette_of(instance) + WORD_AT(bind_entries, i), skin_matrix(walked, AFFINE_AT(binds, i)));
}
