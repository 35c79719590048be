// Which parts of the shadow map hold anything, so that light far from all that throws shadows is found without it.
#pragma once

#include "raster/frame.h"

#include <vector>

namespace throng::raster {

// Of each cell of the map (Frame::casters), how many draws may reach into it or the texels just beyond, by the
// boxes that skin has left in them.
void count_casters(const Frame& frame, std::vector<uint32_t>& counts);

}  // namespace throng::raster
