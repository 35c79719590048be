// Values of a track -> the bits of a packed one (throng/character.h has the layout, sample_reference.h reads it).
#pragma once

#include "sample/sample_reference.h"

namespace throng {

// A track of one value. Rotations: unit length.
PackedTrack constant_track(TrackTarget target, const TrackKey& value);

// Bits of one row.
uint32_t packed_row_bits(const PackedTrack& track);

// The nearest bits. A rotation must have unit length, and the sign that makes its `left_out` component positive.
PackedBits quantised(const PackedTrack& track, TrackTarget target, const TrackValue& value);

// The bits written to must be 0 so far.
void write_bits(std::span<uint32_t> words, size_t first_bit, uint32_t bits, uint32_t count);
void write_row(std::span<uint32_t> words, size_t row_bit, const PackedTrack& track, const PackedBits& bits);

}  // namespace throng
