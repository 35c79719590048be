#include "compile/clip/packed_track.h"

#include <algorithm>

namespace throng {

PackedTrack constant_track(TrackTarget target, const TrackKey& value) {
    PackedTrack track;
    if (target != TrackTarget::kRotation) {
        std::copy_n(value.begin(), 3, track.minimum.begin());
        return track;
    }
    const auto larger = [](float a, float b) { return std::abs(a) < std::abs(b); };
    const auto left_out = static_cast<uint32_t>(std::max_element(value.begin(), value.end(), larger) - value.begin());
    const float sign = value[left_out] < 0 ? -1.0f : 1.0f;
    // No -0, so that each value has one pattern of bits
    for (uint32_t c = 0; c < 3; ++c) track.minimum[c] = sign * value[(left_out + 1 + c) % 4] + 0.0f;
    track.layout = left_out << kPackedLeftOutShift;
    return track;
}

uint32_t packed_row_bits(const PackedTrack& track) {
    uint32_t count = 0;
    for (uint32_t c = 0; c < 4; ++c) count += packed_bit_count(track, c);
    return count;
}

PackedBits quantised(const PackedTrack& track, TrackTarget target, const TrackValue& value) {
    const auto nearest = [&](uint32_t component, uint32_t of_track, double v) {
        const uint32_t count = packed_bit_count(track, component);
        if (count == 0) return 0u;
        const double level = std::nearbyint((v - double{track.minimum[of_track]}) / double{track.step[of_track]});
        return level > 0 ? static_cast<uint32_t>(std::min(level, double((1u << count) - 1))) : 0u;  // also if it is NaN
    };
    PackedBits bits{};
    if (target != TrackTarget::kRotation) {
        for (uint32_t c = 0; c < 3; ++c) bits[c] = nearest(c, c, value[c]);
        return bits;
    }
    const uint32_t left_out = (track.layout >> kPackedLeftOutShift) & 3;
    for (uint32_t c = 0; c < 3; ++c) bits[c] = nearest(c, c, value[(left_out + 1 + c) % 4]);
    bits[3] = nearest(3, 0, value[left_out]);
    return bits;
}

void write_bits(std::span<uint32_t> words, size_t first_bit, uint32_t bits, uint32_t count) {
    if (count == 0) return;
    const size_t word = first_bit / 32, shift = first_bit % 32;
    words[word] |= bits << shift;
    if (shift + count > 32) words[word + 1] |= bits >> (32 - shift);
}

void write_row(std::span<uint32_t> words, size_t row_bit, const PackedTrack& track, const PackedBits& bits) {
    size_t first_bit = row_bit + track.first_bit;
    for (uint32_t c = 0; c < 4; ++c) {
        const uint32_t count = packed_bit_count(track, c);
        write_bits(words, first_bit, bits[c], count);
        first_bit += count;
    }
}

}  // namespace throng
