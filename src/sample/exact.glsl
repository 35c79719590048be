// Samples float keys (JointTracks in throng/character.h) between two rows. The includer declares the table
// `keys`.
#include "sample/sample_io.h"
#include "sample/slerp.glsl"

struct KeyPair {
    vec4 earlier, later;
};

KeyPair fetch_exact(uint track, ClipCursor cursor) {
    const uint position = track & kTrackPositionMask;
    const bool is_animated = (track & kTrackAnimatedBit) != 0, is_step = (track & kTrackStepBit) != 0;
    const uint earlier = is_animated ? cursor.earlier : 0, later = is_animated && !is_step ? cursor.later : earlier;
    return KeyPair(uintBitsToFloat(ROW_AT(keys, position + earlier)), uintBitsToFloat(ROW_AT(keys, position + later)));
}

vec4 exact_rotation(uint track, ClipCursor cursor) {
    const KeyPair pair = fetch_exact(track, cursor);
    return slerp(pair.earlier, pair.later, cursor.fraction);
}

vec4 exact_vector(uint track, ClipCursor cursor) {
    const KeyPair pair = fetch_exact(track, cursor);
    return mix(pair.earlier, pair.later, cursor.fraction);
}

JointPose sample_exact(uvec4 tracks, ClipCursor cursor) {
    return JointPose(exact_rotation(tracks.x, cursor), exact_vector(tracks.y, cursor), exact_vector(tracks.z, cursor));
}
