#include "raster/casters.h"

#include <algorithm>
#include <cmath>

namespace throng::raster {

// Each box changes the counts only at its four corners. Prefix sums along rows and columns then give the counts of all
// cells.
void count_casters(const Frame& frame, std::vector<uint32_t>& counts) {
    const uint32_t side = cells_of_map(frame.map_size);
    constexpr float kFilter = 4;  // texels that the filter reads to the right and below, and one for rounding
    const auto cell = [&](float texel) {
        const float at = std::floor(texel / (1u << kCellShift));
        return static_cast<uint32_t>(std::clamp(at, 0.0f, static_cast<float>(side)));
    };
    counts.assign(size_t{side} * side, 0);
    const auto change = [&](uint32_t x, uint32_t y, uint32_t by) {
        if (x < side && y < side) counts[size_t{y} * side + x] += by;
    };
    for (uint32_t i = 0; i < frame.draw_count; ++i) {
        const auto& box = frame.draws[i].map_box;
        if (box[2] < 0 || box[3] < 0) continue;
        const uint32_t x0 = cell(box[0] - kFilter), y0 = cell(box[1] - kFilter), x1 = cell(box[2] + 1) + 1,
                       y1 = cell(box[3] + 1) + 1;
        change(x0, y0, 1);
        change(x1, y0, ~0u);
        change(x0, y1, ~0u);
        change(x1, y1, 1);
    }
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 1; x < side; ++x) counts[size_t{y} * side + x] += counts[size_t{y} * side + x - 1];
    for (size_t i = side; i < counts.size(); ++i) counts[i] += counts[i - side];
}

}  // namespace throng::raster
