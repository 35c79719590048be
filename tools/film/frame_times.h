// How long frames took, on the GPU or on the processor that does its work, as printed by the commands that draw.
#pragma once

#include "tools/cli/command.h"

#include <throng/crowd.h>

#include <cstdint>
#include <span>

namespace throng::tools {

struct FrameTimes {
    StageTimes stages;
    double draw_ms = 0;
};

// The median of each time on its own; zeros if there are no frames.
FrameTimes median_of(std::span<const FrameTimes> frames);

nlohmann::json to_json(const FrameTimes& times);
void print_times(const FrameTimes& times);

// Characters of each level of detail, the finest first.
void print_drawn(std::span<const uint32_t> drawn);

}  // namespace throng::tools
