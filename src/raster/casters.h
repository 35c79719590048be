// Which parts of the shadow map hold anything, so that light far from everything that throws shadows is computed
// without reading it.
#pragma once

#include "raster/frame.h"

#include <vector>

namespace throng::raster {

// Counts, for each cell of the map (Frame::casters), the draws that may reach into it or the texels just beyond, by the
// boxes that skin has written to the draws.
void count_casters(const Frame& frame, std::vector<uint32_t>& counts);

}  // namespace throng::raster
