// What frames took, on the GPU or on the processor that does its work, as commands that draw print it.
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

// The median of each time for itself; zeros where there is no frame.
FrameTimes median_of(std::span<const FrameTimes> frames);

nlohmann::json to_json(const FrameTimes& times);
void print_times(const FrameTimes& times);

// Characters of each level of detail, the finest first.
void print_drawn(std::span<const uint32_t> drawn);

}  // namespace throng::tools
