// Which parts of the shadow map are not empty, so that places far from everything that casts shadows are lit without
// reading the map.
#pragma once

#include "raster/frame.h"

#include <vector>

namespace throng::raster {

// Counts, for each cell of the map (Frame::casters), the draws whose map_box, as written by skin, reaches into the cell
// or the texels just right of it or below it.
void count_casters(const Frame& frame, std::vector<uint32_t>& counts);

}  // namespace throng::raster
