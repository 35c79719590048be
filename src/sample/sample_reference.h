// The definition of the sample stage.
#pragma once

#include "control/control_reference.h"
#include "sample/track_value.h"

namespace throng {

// One row of a packed track: the bits of components 0, 1 and 2, and of the fourth if a rotation is stored in full.
using PackedBits = std::array<uint32_t, 4>;
uint32_t packed_bit_count(const PackedTrack& track, uint32_t component);

// `count` (0 to 21) bits of `words` from bit `first_bit`.
uint32_t read_bits(std::span<const uint32_t> words, size_t first_bit, uint32_t count);

// Rotations have unit length, except for the quantisation error.
TrackValue packed_value(const PackedTrack& track, TrackTarget target, const PackedBits& bits);

// One track of a compiled character, exact or packed. Keeps references.
class TrackReader {
public:
    // clip == clip count: the rest pose.
    TrackReader(const Character& character, size_t clip, size_t joint, TrackTarget target);

    bool varies() const { return varies_; }
    uint32_t row_count() const { return varies_ ? clip_->row_count : 1; }
    const PackedTrack& packed() const { return packed_; }  // only for packed characters
    TrackValue at_row(uint32_t row) const {
        const size_t begin = varies_ ? size_t{row} * clip_->row_stride : 0;
        return character_.packed ? packed_row(begin) : value_of(character_.keys[position_ + begin]);
    }
    TrackValue between(const RowCursor& rows) const;

private:
    TrackValue packed_row(size_t begin) const;  // `begin`: in words, from where the clip's rows begin

    const Character& character_;
    const Clip* clip_;  // null: the rest pose, whose tracks are constant
    TrackTarget target_;
    uint32_t position_ = 0;  // in Character::keys
    PackedTrack packed_{};
    bool varies_ = false, step_ = false;
};

// The times of a clip's rows. [row_count], seconds
std::span<const float> row_times(const Character& character, uint32_t clip);

// parent_from_joint, between two rows of the clip.
Trs<double> sample_reference(const Character& character, uint32_t clip, size_t joint, const RowCursor& rows);

// parent_from_joint of every joint; clip == clip count is the rest pose.
std::vector<Trs<double>> sample_reference(const Character& character, uint32_t clip, double local_time_s);

}  // namespace throng
