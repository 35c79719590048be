// `throng bench frame`: whole updates of a crowd on every path that throng has, each checked against the reference and
// then timed in turns with the floors, which do the memory traffic alone.
#pragma once

#include "bench/updates.h"

namespace throng::bench {

struct FrameCase {
    std::string configuration;  // its name
    const Character* character = nullptr;
    std::string keys;                    // of the character, for the records: "exact", or the error bound
    const Character* exact = nullptr;    // the same character with exact keys, for comparison; may be null
    std::span<const Playback> playback;  // [instance_count], two clips each
};

// A record for each variant and each floor of the case (bench/README.md lists their fields). A variant that `reference`
// shows to be wrong is not timed, and its record says so; if the device or the character does not support a variant,
// its record says why. Throws if the device fails.
std::vector<Json> measure_frame(const Device& device, const FrameCase& frame, uint32_t samples,
                                const Progress& progress, const SkinReference& reference = skin_reference_of);

}  // namespace throng::bench
