// The definition of step 4 of docs/controller.md: which clips a state plays, and how fast.
#pragma once

#include "controller/controller_arrays.h"

#include <span>
#include <vector>

namespace throng {

struct MixedClip {
    uint32_t clip;
    float weight;  // 0..1
};

struct MixedClips {
    std::vector<MixedClip> clips;  // 1 to 3, of one phase
    float rate = 0;                // cycles a second
    bool loop = true;
    uint32_t sync = io::kAbsent;

    const MixedClip& heaviest() const;  // the first of equals
};

MixedClips mix_of_state(const ControllerArrays& arrays, const io::ControlState& state,
                        std::span<const float> parameters);
MixedClips mix_of_direct_play(const ControllerArrays& arrays, const io::LayerPlay& play);

// What is not finite counts as 0.
float parameter_at(std::span<const float> parameters, uint32_t index);

}  // namespace throng
