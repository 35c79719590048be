// Samples packed keys (PackedTrack in throng/character.h) between two rows. The includer declares the tables `keys`
// (rows) and `words`.
#include "sample/sample_io.h"

const float kPackedFullStep = 2.0 / 65535.0;

// A track's stored components in both rows. A rotation's fourth component, if not stored, is still to be computed.
struct PackedPair {
    vec4 earlier, later;
    uint layout_word;
};

// Reads four fields, of the widths `bits` and kPackedFullBits, from bit `shift` of three words on.
uvec4 unpack_fields(uint word, uint shift, uvec3 bits) {
    const uvec3 w = uvec3(WORD_AT(words, word), WORD_AT(words, word + 1), WORD_AT(words, word + 2));
    uvec2 rest = (w.xy >> shift) | (w.yz << 1 << (31 - shift));  // two shifts, since a shift by 32 is undefined
    uvec4 fields;
    fields.x = rest.x & ((1u << bits.x) - 1);
    rest = uvec2((rest.x >> bits.x) | (rest.y << 1 << (31 - bits.x)), rest.y >> bits.x);
    fields.y = rest.x & ((1u << bits.y) - 1);
    rest = uvec2((rest.x >> bits.y) | (rest.y << 1 << (31 - bits.y)), rest.y >> bits.y);
    fields.z = rest.x & ((1u << bits.z) - 1);
    fields.w = ((rest.x >> bits.z) | (rest.y << 1 << (31 - bits.z))) & ((1u << kPackedFullBits) - 1);
    return fields;
}

PackedPair fetch_packed(uint track, ClipCursor cursor) {
    // A constant has no tail: for it, this reads another track's row, whose values are not used
    const uvec4 head = ROW_AT(keys, track), tail = ROW_AT(keys, track + 1);
    const uvec3 bits = uvec3(head.w, head.w >> 5, head.w >> 10) & 31u;
    const bool is_constant = (head.w & kPackedBitsMask) == 0, is_step = (head.w & kPackedStep) != 0;
    const uint word = is_constant ? 0 : tail.w >> 5, shift = tail.w & 31u;
    const vec4 minimum = vec4(uintBitsToFloat(head.xyz), -1);
    const vec4 step_size = is_constant ? vec4(0) : vec4(uintBitsToFloat(tail.xyz), kPackedFullStep);
    PackedPair pair;
    pair.earlier = minimum + step_size * vec4(unpack_fields(is_constant ? 0 : cursor.earlier + word, shift, bits));
    pair.later = is_step
                     ? pair.earlier
                     : minimum + step_size * vec4(unpack_fields(is_constant ? 0 : cursor.later + word, shift, bits));
    pair.layout_word = head.w;
    return pair;
}

float left_out_component(vec3 others) { return sqrt(max(1 - dot(others, others), 0)); }

vec4 packed_rotation(uint track, ClipCursor cursor) {
    PackedPair pair = fetch_packed(track, cursor);
    if ((pair.layout_word & kPackedFull) == 0) {
        pair.earlier.w = left_out_component(pair.earlier.xyz);
        pair.later.w = left_out_component(pair.later.xyz);
    }
    vec4 q = mix(pair.earlier, pair.later, cursor.fraction);
    // The stored components begin with the one after the component that was left out
    const uint turn = (pair.layout_word >> kPackedLeftOutShift) + 1;
    if ((turn & 1) != 0) q = q.wxyz;
    if ((turn & 2) != 0) q = q.zwxy;
    return q * inversesqrt(dot(q, q));
}

vec4 packed_vector(uint track, ClipCursor cursor) {
    const PackedPair pair = fetch_packed(track, cursor);
    return mix(pair.earlier, pair.later, cursor.fraction);
}

JointPose sample_packed(uvec4 tracks, ClipCursor cursor) {
    return JointPose(packed_rotation(tracks.x, cursor), packed_vector(tracks.y, cursor),
                     packed_vector(tracks.z, cursor));
}
