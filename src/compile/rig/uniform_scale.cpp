#include "compile/rig/uniform_scale.h"

#include "compile/clip/packed_track.h"

#include <cstring>

namespace throng {
namespace {

bool is_same(const auto& xyz) { return xyz[0] == xyz[1] && xyz[0] == xyz[2]; }

class ScaleReader {
public:
    explicit ScaleReader(const Character& character)
        : c_(character), rows_left_(c_.keys.size() + c_.words.size() * 32) {}

    bool is_uniform(uint32_t word, const Clip& clip) {
        return c_.packed ? is_packed_uniform(word, clip) : is_exact_uniform(word, clip);
    }

private:
    // No two compiled tracks have a key, or a bit, in common.
    bool take(uint64_t row_count) {
        if (row_count > rows_left_) return false;
        rows_left_ -= row_count;
        return true;
    }

    bool is_exact_uniform(uint32_t word, const Clip& clip) {
        const uint32_t row_count = word & kTrackAnimated ? clip.row_count : 1;
        if (row_count > 1 && !take(row_count)) return false;
        for (uint32_t row = 0; row < row_count; ++row)
            if (!is_same(c_.keys[(word & kTrackPosition) + size_t{row} * clip.row_stride])) return false;
        return true;
    }

    bool is_packed_uniform(uint32_t position, const Clip& clip) {
        PackedTrack track;
        std::memcpy(static_cast<void*>(&track), &c_.keys[position], sizeof(c_.keys[0]));
        if (!is_same(track.minimum)) return false;
        const uint32_t count = packed_bit_count(track, 0);
        if (packed_bit_count(track, 1) != count || packed_bit_count(track, 2) != count) return false;
        if (count == 0) return true;
        std::memcpy(static_cast<void*>(&track), &c_.keys[position], sizeof(track));
        if (!is_same(track.step) || !take(clip.row_count)) return false;
        for (size_t row = 0; row < clip.row_count; ++row) {
            const size_t first_bit = (clip.first_row + row * clip.row_stride) * 32 + track.first_bit;
            const auto bits = [&](size_t component) {
                return read_bits(c_.words, first_bit + component * count, count);
            };
            if (!is_same(std::array{bits(0), bits(1), bits(2)})) return false;
        }
        return true;
    }

    const Character& c_;
    uint64_t rows_left_;
};

}  // namespace

bool has_uniform_scale(const Character& character) {
    const size_t joint_count = character.rig.joint_count();
    const Clip rest{.row_count = 1};
    ScaleReader reader(character);
    for (size_t index = 0; index < character.tracks.size(); ++index) {
        const size_t clip = index / joint_count;
        if (!reader.is_uniform(character.tracks[index].scale,
                               clip < character.clips.size() ? character.clips[clip] : rest))
            return false;
    }
    return true;
}

}  // namespace throng
