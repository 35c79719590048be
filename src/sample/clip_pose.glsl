// A clip's pose of a joint. The includer declares the table `tracks`, and what sample/sample.glsl needs.
#include "sample/sample.glsl"

vec4 clip_rotation(ClipCursor cursor, uint joint) {
    return sample_rotation(ROW_AT(tracks, cursor.first_track + joint).x, cursor);
}

JointPose clip_pose(ClipCursor cursor, uint joint) {
    return sample_joint(ROW_AT(tracks, cursor.first_track + joint), cursor);
}
