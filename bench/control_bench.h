// What controllers cost: crowds whose characters are driven by a controller of twelve states in three layers. Each
// update sets parameters of a hundredth of them.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"

#include <throng/crowd.h>

namespace throng::bench {

// For creatures (tools/creatures/creature.h): six states and a blend space of two parameters in the lowest layer, three
// in a masked one, three in an additive one.
Controller control_bench_controller(const Character& character);

struct ControlCase {
    const Character* character = nullptr;
    uint32_t count = 0;
    uint32_t samples = 0;
    uint64_t seed = 1;
    UpdatePath path = UpdatePath::kAuto;
};

// One record: ms of the control stage and of the whole update, checked against the reference before it is timed (else
// the record has "wrong"). `progress` receives the name of what runs.
Json measure_control(const Device& device, const ControlCase& control, const Progress& progress);

}  // namespace throng::bench
