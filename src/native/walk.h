// In which order joints are walked, what is kept for later children, and when matrices are written.
#pragma once

#include "native/kernel_data.h"

#include <throng/character.h>

#include <span>
#include <vector>

namespace throng::native {

struct WalkRequest {
    std::span<const uint32_t> parents;  // of the rig
    std::vector<bool> moves;            // [joint]: whether it moves; then its parent does too
    std::span<const PaletteEntry> palette;
    bool keeps_model = false;
    std::span<const uint32_t> sockets;
};

struct Walk {
    std::vector<uint32_t> joints;          // in the order of the walk
    std::vector<WalkStep> steps;           // parent, keep and emission_count of each
    std::vector<Emission> emissions;       // in their order
    std::vector<uint32_t> emitted_joints;  // [emission]
    uint32_t slot_count = 1;
};

// If all palette entries are written, they are written in order, so that whole cache lines are filled: a joint is
// walked as late as that order allows, and its matrix is kept if its entry comes later.
Walk plan_walk(const WalkRequest& request);

}  // namespace throng::native
