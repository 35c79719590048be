// Keys -> the pose of one joint. The includer declares the tables `keys` (rows) and `words`, and the constant kPacked.
#ifndef THRONG_SAMPLE_GLSL
#define THRONG_SAMPLE_GLSL
#include "sample/exact.glsl"
#include "sample/packed.glsl"

vec4 sample_rotation(uint track, ClipCursor cursor) {
    if (kPacked) return packed_rotation(track, cursor);
    return exact_rotation(track, cursor);
}

JointPose sample_joint(uvec4 tracks, ClipCursor cursor) {
    if (kPacked) return sample_packed(tracks, cursor);
    return sample_exact(tracks, cursor);
}

#endif
