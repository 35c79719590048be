// Which parts of the shadow map are not empty, so that places far from everything that casts shadows are lit without
// reading the map.
#pragma once

#include "raster/frame.h"

#include <vector>

namespace throng::raster {

// Counts, for each cell of the map (Frame::casters), the draws whose map_box comes near enough for the shadow filter,
// which reads to the right and below, to find them from the cell. Call it when skin or keep has set all boxes.
void count_casters(const Frame& frame, std::vector<uint32_t>& counts);

}  // namespace throng::raster
