// A Controller for a Character as the kernel reads it (controller_io.h), and the initial state of its instances.
#pragma once

#include "control/controller_io.h"

#include <throng/controller.h>

#include <cstdint>
#include <vector>

namespace throng {

struct ControllerTables {
    std::vector<uint32_t> words;                 // io::ControllerLayout, then the arrays that it locates
    io::ControllerLayout layout{};               // the first words
    std::vector<float> masks;                    // [mask_count][joint_count], 0..1
    std::vector<float> initial_parameters;       // [parameter_count]
    std::vector<io::LayerState> initial_layers;  // [layer_count]
    uint32_t active_clip_limit = 1;              // the most active clips that an instance can have
};

// Throws what check_controller() finds.
ControllerTables make_controller_tables(const Controller& controller, const Character& character);

}  // namespace throng
