// The native renderer's shadow map: heights at its texels, and triangles that reach beyond it.
#include "tests/host/raster_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace throng::test {
namespace {

class RasterMap : public testing::TestWithParam<NativeIsa> {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, RasterMap, testing::ValuesIn(native_isas()), isa_name);

TEST_P(RasterMap, TheMapHoldsTheGreatestHeightsLessTheirSlope) {
    Random random(11);
    RasterFrame frame(1);
    raster::Material& material = frame.material();
    std::vector<ScreenTriangle> triangles;
    std::vector<Vec3<float>> vertices;
    std::vector<uint32_t> corners;
    for (uint32_t i = 0; i < 150; ++i) {
        triangles.push_back(random_triangle(random, 12));
        for (uint32_t k = 0; k < 3; ++k) {
            ScreenVertex& v = triangles.back()[k];
            v.w = static_cast<float>(random.between(1, 2));
            vertices.push_back(
                {static_cast<float>(v.x) / (kPictureSize * 256), static_cast<float>(v.y) / (kPictureSize * 256), v.w});
            corners.push_back(3 * i + k);
        }
    }
    frame.add_world(vertices, corners, material);
    frame.draw(GetParam());
    std::vector<Coverage> coverages;
    for (const ScreenTriangle& t : triangles) coverages.emplace_back(t);
    for (size_t i = 0; i < frame.map().size(); ++i) {
        const Sample at = sample_at(i, 1);
        double wanted = 0, steepest = 0;
        for (size_t n = 0; n < triangles.size(); ++n) {
            if (!coverages[n].has(at)) continue;
            const ScreenTriangle& t = triangles[n];
            const auto height = [&](const Sample& p) {
                const auto area = static_cast<double>(cross_of(t[0], t[1], {t[2].x, t[2].y}));
                double sum = 0;
                for (size_t k = 0; k < 3; ++k)
                    sum += static_cast<double>(cross_of(t[(k + 1) % 3], t[(k + 2) % 3], p)) / area * double{t[k].w};
                return sum;
            };
            const double here = height(at), slope = std::max(std::abs(height({at.x + 256, at.y}) - here),
                                                             std::abs(height({at.x, at.y + 256}) - here));
            wanted = std::max(wanted, here - 1.5 * slope);
            steepest = std::max(steepest, slope);
        }
        ASSERT_NEAR(static_cast<double>(frame.map()[i]), std::max(wanted, 0.0), 1e-5 * (1 + steepest)) << i;
    }
}

// Most of these reach so far out that floats cannot represent their subpixels exactly.
TEST_P(RasterMap, ClipsTrianglesFarOutsideTheMap) {
    Random random(17);
    size_t inside = 0, outside = 0;
    for (int round = 0; round < 200; ++round) {
        const double size = round % 4 == 0 ? 64 : 1e6;  // texels
        std::array<Vec3<float>, 3> corners;
        for (Vec3<float>& corner : corners)
            corner = Vec3<double>{random.between(-size, size) / kPictureSize,
                                  random.between(-size, size) / kPictureSize, random.between(1, 2)}
                         .as<float>();
        RasterFrame frame(1);
        frame.add_world({corners.begin(), corners.end()}, {0, 1, 2}, frame.material());
        frame.draw(GetParam());
        // Converts to texels
        std::array<Vec3<double>, 3> at;
        for (size_t k = 0; k < 3; ++k) {
            at[k] = corners[k].as<double>();
            at[k].x *= kPictureSize;
            at[k].y *= kPictureSize;
        }
        const Vec3<double> normal = cross(at[1] - at[0], at[2] - at[0]);
        const double slope_x = -normal.x / normal.z, slope_y = -normal.y / normal.z,
                     slope = std::max(std::abs(slope_x), std::abs(slope_y));
        for (size_t i = 0; i < frame.map().size(); ++i) {
            const double x = static_cast<double>(i % kPictureSize) + 0.5,
                         y = static_cast<double>(i / kPictureSize) + 0.5;
            double nearest_edge = std::numeric_limits<double>::infinity();
            bool covered = true;
            for (size_t k = 0; k < 3; ++k) {
                const Vec3<double>&a = at[k], &b = at[(k + 1) % 3];
                const double side = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) /
                                    std::hypot(b.x - a.x, b.y - a.y) * (normal.z > 0 ? 1 : -1);
                covered = covered && side > 0;
                nearest_edge = std::min(nearest_edge, std::abs(side));
            }
            if (nearest_edge < 0.05) continue;  // too close: rounding may decide
            const double height = at[0].z + slope_x * (x - at[0].x) + slope_y * (y - at[0].y),
                         wanted = covered ? std::max(height - 1.5 * slope, 0.0) : 0;
            ASSERT_NEAR(static_cast<double>(frame.map()[i]), wanted, 1e-4 + 0.02 * slope) << round << ", texel " << i;
            ++(covered ? inside : outside);
        }
    }
    EXPECT_GT(inside, 50'000u);
    EXPECT_GT(outside, 50'000u);
}

}  // namespace
}  // namespace throng::test
