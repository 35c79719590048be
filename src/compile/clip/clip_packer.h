// One clip: which rows are kept, and how finely each track is quantised.
#pragma once

#include "base/progress.h"
#include "compile/clip/exact_clip.h"
#include "reference/influence_boxes.h"

namespace throng {

struct PackedClip {
    std::vector<float> times_s;       // [row_count]
    std::vector<PackedTrack> tracks;  // [joint_count][3], in the order of TrackTarget
    std::vector<uint32_t> words;      // [row_count][row_stride]
    uint32_t row_stride = 0;
    double error = 0;  // largest displacement found, in the unit of the character
};

struct PackSettings {
    // The largest displacement, in the unit of the character. If a clip cannot keep it, its keys are nearly the finest
    double bound = 0;
    uint64_t joint_rows = 0;  // of GridSettings
};

// Throws kInvalidFile where poses of the clip are not finite.
PackedClip pack_clip(const Character& character, const ExactClip& clip, std::span<const Box> boxes,
                     const PackSettings& settings, const Progress& progress = {});

}  // namespace throng
