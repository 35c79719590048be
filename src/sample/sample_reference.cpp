#include "sample/sample_reference.h"

#include <algorithm>
#include <bit>

namespace throng {

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

TrackValue packed_value(const PackedTrack& track, TrackTarget target, const PackedBits& bits) {
    std::array<double, 3> components;
    for (size_t c = 0; c < 3; ++c) components[c] = double{track.minimum[c]} + double{track.step[c]} * bits[c];
    if (target != TrackTarget::kRotation) return {components[0], components[1], components[2], 0};
    const uint32_t left_out = (track.layout >> kPackedLeftOutShift) & 3;
    TrackValue q;
    double rest = 1;
    for (uint32_t c = 0; c < 3; ++c) {
        q[(left_out + 1 + c) % 4] = components[c];
        rest -= components[c] * components[c];
    }
    q[left_out] = track.layout & kPackedFull ? double{track.minimum[0]} + double{track.step[0]} * bits[3]
                                             : std::sqrt(std::max(rest, 0.0));
    return q;
}

TrackReader::TrackReader(const Character& character, size_t clip, size_t joint, TrackTarget target)
    : character_(character), clip_(clip < character.clips.size() ? &character.clips[clip] : nullptr), target_(target) {
    const uint32_t word = character.tracks[clip * character.rig.joint_count() + joint].*word_of(target);
    position_ = character.packed ? word : word & kTrackPosition;
    if (!character.packed) {
        varies_ = clip_ && (word & kTrackAnimated);
        step_ = (word & kTrackStep) != 0;
        return;
    }
    std::array<TrackKey, 2> halves{character.keys[position_]};
    packed_ = std::bit_cast<PackedTrack>(halves);
    varies_ = clip_ && (packed_.layout & kPackedBitsMask);
    step_ = (packed_.layout & kPackedStep) != 0;
    if (!varies_) return;
    halves[1] = character.keys[position_ + 1];
    packed_ = std::bit_cast<PackedTrack>(halves);
}

TrackValue TrackReader::packed_row(size_t begin) const {
    PackedBits bits{};
    size_t first_bit = varies_ ? (clip_->first_row + begin) * 32 + packed_.first_bit : 0;
    for (uint32_t c = 0; varies_ && c < 4; ++c) {
        const uint32_t count = packed_bit_count(packed_, c);
        bits[c] = read_bits(character_.words, first_bit, count);
        first_bit += count;
    }
    return packed_value(packed_, target_, bits);
}

TrackValue TrackReader::between(const RowCursor& rows) const {
    const TrackValue earlier = at_row(rows.earlier);
    const bool moves = varies_ && !step_;
    if (!character_.packed)
        return interpolate_reference(target_, earlier, moves ? at_row(rows.later) : earlier, rows.fraction);
    const TrackValue value = moves ? lerp(earlier, at_row(rows.later), rows.fraction) : earlier;
    return target_ == TrackTarget::kRotation ? value_of(normalized(quaternion_of(value))) : value;
}

std::span<const float> row_times(const Character& character, uint32_t clip) {
    const Clip& of = character.clips[clip];
    return std::span(character.times_s).subspan(of.first_time, of.row_count);
}

Trs<double> sample_reference(const Character& character, uint32_t clip, size_t joint, const RowCursor& rows) {
    Trs<double> parent_from_joint;
    for (const TrackTarget target : kTrackTargets)
        set_component(parent_from_joint, target, TrackReader(character, clip, joint, target).between(rows));
    return parent_from_joint;
}

std::vector<Trs<double>> sample_reference(const Character& character, uint32_t clip, double local_time_s) {
    RowCursor rows;
    if (clip < character.clips.size()) rows = find_rows_reference(row_times(character, clip), local_time_s);
    std::vector<Trs<double>> pose;
    for (size_t joint = 0; joint < character.rig.joint_count(); ++joint)
        pose.push_back(sample_reference(character, clip, joint, rows));
    return pose;
}

}  // namespace throng
