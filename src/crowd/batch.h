// A run of a group's instances whose buffers fit the device's limits.
#pragma once

#include "gpu/kernel.h"

namespace throng {

struct Batch {
    uint32_t group = 0;
    uint32_t first_instance = 0, instance_count = 0;
    uint32_t blending_count = 0;  // instances in which both clips have weight
    Buffer playbacks, cursors, placements, skin;
    Buffer kept_model;  // where CrowdSettings::keep_model_matrices
    Bindings control;
};

}  // namespace throng
