// A clip while it is compiled: read once from the file (read_clips.h), changed by passes (root_motion.h), written once,
// with exact keys (here) or packed ones (pack.h). Passes compute in double precision; keys are floats, as they are
// stored, so that packing measures its error against what exact keys would show.
#pragma once

#include "sample/sample_reference.h"

#include <span>
#include <vector>

namespace throng {

// What a clip does with one component of a joint's transform.
struct ExactTrack {
    uint32_t joint = 0;
    TrackTarget target = TrackTarget::kTranslation;
    bool step = false;             // a key holds until the next one
    std::vector<TrackKey> keys{};  // [row_count], or the one that always holds

    bool varies() const { return keys.size() > 1; }
    TrackValue at_row(size_t row) const { return value_of(keys[varies() ? row : 0]); }
    // At a row, the key itself; between rows, a rotation has unit length.
    TrackValue between(const RowCursor& rows) const;
};

struct ExactClip {
    Clip facts{};                       // name, duration and counts; the writers complete the character's copy
    std::vector<float> times_s{};       // [row_count], ascending
    std::vector<ExactTrack> tracks{};   // what has no track stays in the rest pose
    std::vector<TrackKey> root_rows{};  // as Character::root_rows

    // A copy of the track; if there is none, a constant one with the value of the rest pose.
    ExactTrack track(const Rig& rig, uint32_t joint, TrackTarget target) const;
};

// The pose that sample_reference() gives once the clip is written exactly.
std::vector<Trs<double>> sample_exact(const ExactClip& clip, const Rig& rig, double time_s);

// Whether two rotations are so close to half a turn apart that a float's rounding decides in which direction the arc
// between them goes. Such keys get a row in the middle.
bool is_half_turn(const TrackValue& a, const TrackValue& b);

// q and -q are one rotation, and the sample stage expects neighbouring rows in one hemisphere.
template <class T>
void join_hemispheres(std::vector<std::array<T, 4>>& rotations) {
    for (size_t row = 1; row < rotations.size(); ++row) {
        double cosine = 0;
        for (size_t c = 0; c < 4; ++c) cosine += double{rotations[row - 1][c]} * double{rotations[row][c]};
        if (cosine < 0)
            for (T& component : rotations[row]) component = -component;
    }
}

inline constexpr uint64_t kKey_bytes = sizeof(TrackKey);

// The number of the clip's keys if it has `row_count` rows. (The rest pose has 3 keys per joint.)
uint64_t key_count(const ExactClip& clip, size_t row_count);

// Completes the character's clip `index`: appends its times (all rows, or those that packing keeps) and root rows. Its
// keys take `size_bytes`.
Clip& complete_clip(uint32_t index, const ExactClip& clip, std::span<const float> times_s, uint64_t size_bytes,
                    Character& character);

// Fills times_s, keys, root_rows and tracks of the character, and completes its clips. Keys: constants of a clip, then
// its rows, each in the order of its tracks.
void write_exact(std::span<const ExactClip> clips, Character& character);

}  // namespace throng
