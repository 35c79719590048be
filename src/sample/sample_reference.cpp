#include "sample/sample_reference.h"

#include <algorithm>
#include <bit>

namespace throng {
namespace {

using Key = std::array<float, 4>;

struct KeyPair {
    Key earlier, later;
};

KeyPair fetch(const Character& character, uint32_t track, uint32_t row_stride, const RowCursor& rows) {
    const uint32_t position = track & kTrackPosition;
    if (!(track & kTrackAnimated)) return {character.keys[position], character.keys[position]};
    const Key& earlier = character.keys[position + rows.earlier * row_stride];
    return {earlier, track & kTrackStep ? earlier : character.keys[position + rows.later * row_stride]};
}

Quaternion<double> quaternion(const Key& key) { return normalized(Quaternion<double>{key[0], key[1], key[2], key[3]}); }

Vec3<double> lerp_keys(const KeyPair& keys, double w) {
    return lerp(Vec3<double>{keys.earlier[0], keys.earlier[1], keys.earlier[2]},
                {keys.later[0], keys.later[1], keys.later[2]}, w);
}

Trs<double> sample_exact(const Character& character, const JointTracks& tracks, uint32_t row_stride,
                         const RowCursor& rows) {
    const KeyPair rotation = fetch(character, tracks.rotation, row_stride, rows);
    return {slerp_reference(quaternion(rotation.earlier), quaternion(rotation.later), rows.fraction),
            lerp_keys(fetch(character, tracks.translation, row_stride, rows), rows.fraction),
            lerp_keys(fetch(character, tracks.scale, row_stride, rows), rows.fraction)};
}

// Words in which the two rows of a packed clip begin, and how far it is from the one to the other.
struct PackedRows {
    size_t earlier = 0, later = 0;
    double fraction = 0;
};

bool is_constant(const PackedTrack& track) {
    return packed_bit_count(track, 0) + packed_bit_count(track, 1) + packed_bit_count(track, 2) == 0;
}

PackedTrack packed_track(const Character& character, uint32_t position) {
    std::array<Key, 2> keys{character.keys[position]};
    if (!is_constant(std::bit_cast<PackedTrack>(keys))) keys[1] = character.keys[position + 1];
    return std::bit_cast<PackedTrack>(keys);
}

std::array<double, 4> packed_row(const Character& character, const PackedTrack& track, TrackTarget target,
                                 size_t row_word) {
    PackedBits bits{};
    size_t first_bit = row_word * 32 + track.first_bit;
    for (uint32_t c = 0; c < 4; ++c) {
        const uint32_t count = packed_bit_count(track, c);
        bits[c] = read_bits(character.words, first_bit, count);
        first_bit += count;
    }
    return packed_value(track, target, bits);
}

std::array<double, 4> sample_packed(const Character& character, uint32_t position, TrackTarget target,
                                    const PackedRows& rows) {
    const PackedTrack track = packed_track(character, position);
    std::array<double, 4> value = packed_row(character, track, target, rows.earlier);
    if (is_constant(track) || (track.layout & kPackedStep)) return value;
    const std::array<double, 4> later = packed_row(character, track, target, rows.later);
    for (size_t c = 0; c < 4; ++c) value[c] = value[c] * (1 - rows.fraction) + later[c] * rows.fraction;
    return value;
}

Trs<double> sample_packed(const Character& character, const JointTracks& tracks, const PackedRows& rows) {
    const std::array<double, 4> q = sample_packed(character, tracks.rotation, TrackTarget::kRotation, rows);
    const std::array<double, 4> t = sample_packed(character, tracks.translation, TrackTarget::kTranslation, rows);
    const std::array<double, 4> s = sample_packed(character, tracks.scale, TrackTarget::kScale, rows);
    return {normalized(Quaternion<double>{q[0], q[1], q[2], q[3]}), {t[0], t[1], t[2]}, {s[0], s[1], s[2]}};
}

}  // namespace

Quaternion<double> slerp_reference(Quaternion<double> a, Quaternion<double> b, double w) {
    double cosine = dot(a, b);
    if (cosine < 0) {
        b = -b;
        cosine = -cosine;
    }
    const double angle = std::acos(std::min(cosine, 1.0));
    double from = 1 - w, to = w;
    if (angle > 1e-6) {  // below, chord and arc agree to 1e-13
        from = std::sin((1 - w) * angle) / std::sin(angle);
        to = std::sin(w * angle) / std::sin(angle);
    }
    return normalized(
        Quaternion<double>{from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z, from * a.w + to * b.w});
}

uint32_t packed_bit_count(const PackedTrack& track, uint32_t component) {
    if (component == 3) return track.layout & kPackedFull ? kPackedFullBits : 0;
    return (track.layout >> (5 * component)) & 31;
}

uint32_t read_bits(std::span<const uint32_t> words, size_t first_bit, uint32_t count) {
    if (count == 0) return 0;
    const size_t word = first_bit / 32;
    const uint64_t both = uint64_t{words[word]} | uint64_t{words[word + 1]} << 32;
    return static_cast<uint32_t>(both >> (first_bit % 32)) & ((1u << count) - 1);
}

std::array<double, 4> packed_value(const PackedTrack& track, TrackTarget target, const PackedBits& bits) {
    std::array<double, 3> components;
    for (size_t c = 0; c < 3; ++c) components[c] = double{track.minimum[c]} + double{track.step[c]} * bits[c];
    if (target != TrackTarget::kRotation) return {components[0], components[1], components[2], 0};
    const uint32_t left_out = (track.layout >> kPackedLeftOutShift) & 3;
    std::array<double, 4> q;
    double rest = 1;
    for (uint32_t c = 0; c < 3; ++c) {
        q[(left_out + 1 + c) % 4] = components[c];
        rest -= components[c] * components[c];
    }
    q[left_out] = track.layout & kPackedFull ? double{track.minimum[0]} + double{track.step[0]} * bits[3]
                                             : std::sqrt(std::max(rest, 0.0));
    return q;
}

std::vector<Trs<double>> sample_reference(const Character& character, uint32_t clip, double local_time_s) {
    const uint32_t joint_count = character.rig.joint_count();
    RowCursor rows;
    PackedRows packed_rows;
    uint32_t row_stride = 0;
    if (clip < character.clips.size()) {
        const Clip& c = character.clips[clip];
        rows = find_rows_reference(std::span(character.times_s).subspan(c.first_time, c.row_count), local_time_s);
        row_stride = c.row_stride;
        packed_rows = {c.first_row + size_t{rows.earlier} * row_stride, c.first_row + size_t{rows.later} * row_stride,
                       rows.fraction};
    }
    std::vector<Trs<double>> pose(joint_count);
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        const JointTracks& tracks = character.tracks[size_t{clip} * joint_count + joint];
        pose[joint] = character.packed ? sample_packed(character, tracks, packed_rows)
                                       : sample_exact(character, tracks, row_stride, rows);
    }
    return pose;
}

}  // namespace throng
