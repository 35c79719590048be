// `throng bench population`: the cost of instances that come and go: unused capacity, and births and deaths in each
// update.
#pragma once

#include "bench/updates.h"

#include <throng/crowd.h>

#include <span>
#include <string>
#include <vector>

namespace throng::bench {

struct PopulationCase {
    std::string configuration;  // its name
    const Character* character = nullptr;
    std::span<const Playback> playback;  // [capacity]
    std::span<const Affine> placement;   // [capacity]
    UpdatePath path = UpdatePath::kAuto;
};

// Returns records (bench/README.md lists their fields). For some fractions of the capacity, it times updates of a crowd
// with as many permanent instances, and of those where they are the first of their group, the last of it, and anywhere
// in it. Then it times frames in which some instances get new playbacks, and frames in which as many die and as many
// are born.
//
// All are checked first, the latter after one such frame. What `reference` shows to be wrong is not timed, and its
// record says so.
std::vector<Json> measure_population(const Device& device, const PopulationCase& population, uint32_t samples,
                                     const Progress& progress, const SkinReference& reference = skin_reference_of);

}  // namespace throng::bench
