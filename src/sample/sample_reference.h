// The definition of the sample stage.
#pragma once

#include "control/control_reference.h"

namespace throng {

// The shortest arc between unit quaternions.
Quaternion<double> slerp_reference(Quaternion<double> a, Quaternion<double> b, double w);

// parent_from_joint of every joint; clip == clip count is the rest pose.
std::vector<Trs<double>> sample_reference(const Character& character, uint32_t clip, double local_time_s);

// What a packed track holds in one row: the bits of components 0, 1, 2, and of the fourth of a full rotation.
using PackedBits = std::array<uint32_t, 4>;
uint32_t packed_bit_count(const PackedTrack& track, uint32_t component);

// `count` (0 to 21) bits of `words` from bit `first_bit`.
uint32_t read_bits(std::span<const uint32_t> words, size_t first_bit, uint32_t count);

// x, y, z, 0 of a translation or scale; of a rotation x, y, z, w, of unit length but for what quantising cost.
std::array<double, 4> packed_value(const PackedTrack& track, TrackTarget target, const PackedBits& bits);

}  // namespace throng
