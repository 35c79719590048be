// Which cells of the shadow map may contain anything.
#include "raster/casters.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

constexpr uint32_t kMapSize = 100;  // not a whole number of cells

// Whether a cell reads any texel whose centre is between `least` and `greatest`. A cell reads its own texels and three
// more.
bool may_read(uint32_t cell, float least, float greatest) {
    const float first = static_cast<float>(cell << raster::kCellShift),
                end = static_cast<float>((cell + 1) << raster::kCellShift) + 3;
    return greatest >= first && least < end;
}

TEST(RasterCasters, AreCountedInCellsThatReadTheirHeights) {
    Random random(5);
    for (uint32_t count = 0; count < 40; ++count) {
        std::vector<raster::Draw> draws(count);
        for (raster::Draw& draw : draws)
            for (size_t axis = 0; axis < 2; ++axis) {
                draw.map_box[axis] = static_cast<float>(random.between(-60, kMapSize + 60));
                draw.map_box[axis + 2] = draw.map_box[axis] + static_cast<float>(random.between(0, 20));
            }
        raster::Frame frame;
        frame.map_size = kMapSize;
        frame.draws = draws.data();
        frame.draw_count = count;
        std::vector<uint32_t> counts;
        raster::count_casters(frame, counts);
        const uint32_t side = raster::cells_of_map(kMapSize);
        ASSERT_EQ(counts.size(), size_t{side} * side);
        for (uint32_t i = 0; i < counts.size(); ++i) {
            uint32_t least = 0, most = 0;  // boxes, and boxes with a margin of some texels
            for (const raster::Draw& draw : draws) {
                const auto& box = draw.map_box;
                const auto reads = [&](float margin) {
                    return may_read(i % side, box[0] - margin, box[2] + margin) &&
                           may_read(i / side, box[1] - margin, box[3] + margin);
                };
                least += reads(0);
                most += reads(3);
            }
            EXPECT_GE(counts[i], least) << i;
            EXPECT_LE(counts[i], most) << i;
        }
    }
}

}  // namespace
}  // namespace throng::test
