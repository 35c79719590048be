// How long a frame of `throng bench million` would take on GPUs, from the machine code that AMD's compiler makes of its
// kernels (bench/isa): predictions, not measurements.
#pragma once

#include "bench/record.h"

#include <throng/crowd.h>

#include <span>
#include <string>
#include <vector>

namespace throng::bench {

struct DrawnCounts {
    uint32_t own = 0, shared = 0;  // instances with poses of their own, and others
    uint32_t cells = 0;            // with any instance that is drawn
};

struct ViewToPredict {
    std::string name;
    DrawnCounts drawn;
};

// A record for each machine and view; none if AMD's driver is not installed; a single one that says why if nothing can
// be predicted.
std::vector<Json> predict_million(const Character& character, const SkinPool& pool, uint32_t instance_count,
                                  std::span<const ViewToPredict> views);

}  // namespace throng::bench
