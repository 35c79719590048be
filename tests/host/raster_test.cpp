// Rasterisation in the native renderer, before lighting: samples against Vulkan's rules.
#include "tests/host/raster_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng::test {
namespace {

// 1 / w is linear on the screen.
double depth_at(const ScreenTriangle& t, const Sample& p) {
    const auto area = static_cast<double>(cross_of(t[0], t[1], {t[2].x, t[2].y}));
    double depth = 0;
    for (size_t i = 0; i < 3; ++i)
        depth += static_cast<double>(cross_of(t[(i + 1) % 3], t[(i + 2) % 3], p)) / area / t[i].w;
    return depth * RasterFrame::kNear;
}

class RasterTest : public testing::TestWithParam<NativeIsa> {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, RasterTest, testing::ValuesIn(native_isas()), isa_name);

// Computing the expected result takes longer than the tested code, so it is computed once for all instruction sets.
TEST(Raster, CoversTheSamplesOfATriangleAndNoOthers) {
    for (const uint32_t sample_count : {1u, 4u}) {
        Random random(sample_count);
        size_t covered = 0;
        for (int round = 0; round < 400; ++round) {
            RasterFrame frame(sample_count);
            raster::Material& material = frame.material();
            material.is_double_sided = true;
            const ScreenTriangle t = random_triangle(random, 60);
            frame.add({t[0], t[1], t[2]}, {0, 1, 2}, material);
            std::vector<double> depths(frame.samples().size());  // 0: not covered
            Coverage(t).visit_samples(sample_count, [&](size_t i, const Sample& at) {
                ++covered;
                depths[i] = depth_at(t, at);
            });
            for (const NativeIsa isa : native_isas()) {
                frame.draw(isa);
                for (size_t i = 0; i < depths.size(); ++i) {
                    const uint64_t got = frame.samples()[i];
                    const bool is_right = depths[i] == 0
                                              ? got == 0
                                              : got != 0 && std::abs(RasterFrame::depth_of(got) - depths[i]) <= 2e-6;
                    if (!is_right)
                        FAIL() << name_of(isa) << ", round " << round << ", sample " << i << ": depth "
                               << RasterFrame::depth_of(got) << ", not " << depths[i];
                }
            }
        }
        EXPECT_GT(covered, 50'000u * sample_count / 4);
    }
}

TEST_P(RasterTest, TrianglesThatMeetCoverEachSampleOnce) {
    // A picture filled with small and large triangles that share corners
    Random random(3);
    for (const int cells : {5, 90}) {
        const int step = kPictureSize * 256 / cells + 1;
        std::vector<ScreenVertex> vertices;
        for (int y = 0; y <= cells; ++y)
            for (int x = 0; x <= cells; ++x) {
                const auto jitter = [&](int at) {
                    return at == 0 || at == cells ? 0 : static_cast<int>(random.between(-0.3, 0.3) * step);
                };
                vertices.push_back({x * step + jitter(x), y * step + jitter(y)});
            }
        std::vector<uint32_t> corners;
        for (int y = 0; y < cells; ++y)
            for (int x = 0; x < cells; ++x) {
                const auto a = static_cast<uint32_t>(y * (cells + 1) + x), b = a + 1,
                           c = a + static_cast<uint32_t>(cells) + 1, d = c + 1;
                corners.insert(corners.end(), {a, c, b, b, c, d});
            }
        RasterFrame all(4);
        raster::Material& material = all.material();
        material.is_double_sided = true;
        all.add(vertices, corners, material);
        all.draw(GetParam());
        EXPECT_TRUE(std::ranges::none_of(all.samples(), [](uint64_t sample) { return sample == 0; }));
        // Each sample shows a triangle that covers it. There are no others that could hide it
        for (size_t i = 0; i < all.samples().size(); ++i) {
            const Sample at = sample_at(i, 4);
            const auto t = static_cast<size_t>(all.triangle_at(i)) * 3;
            const Coverage coverage({vertices[corners[t]], vertices[corners[t + 1]], vertices[corners[t + 2]]});
            ASSERT_TRUE(coverage.has(at));
        }
    }
}

TEST(Raster, ShowsTheNearestTriangleAndTheFirstOfEqualOnes) {
    for (const uint32_t sample_count : {1u, 4u}) {
        Random random(5);
        RasterFrame frame(sample_count);
        raster::Material& material = frame.material();
        material.is_double_sided = true;
        std::vector<ScreenTriangle> triangles;
        for (int draw = 0; draw < 30; ++draw) {
            std::vector<ScreenVertex> vertices;
            std::vector<uint32_t> corners;
            for (uint32_t i = 0; i < 40; ++i) {
                const bool again = !triangles.empty() && random.chance(0.1);
                triangles.push_back(again ? triangles[random.below(static_cast<uint32_t>(triangles.size()))]
                                          : random_triangle(random, 20));
                for (uint32_t k = 0; k < 3; ++k) {
                    vertices.push_back(triangles.back()[k]);
                    corners.push_back(3 * i + k);
                }
            }
            frame.add(vertices, corners, material);
        }
        struct Nearest {
            double depth = 0, second = 0;
            int triangle = -1;
        };
        std::vector<Nearest> wanted(frame.samples().size());
        for (size_t t = 0; t < triangles.size(); ++t)
            Coverage(triangles[t]).visit_samples(sample_count, [&](size_t i, const Sample& at) {
                Nearest& nearest = wanted[i];
                const double depth = depth_at(triangles[t], at);
                if (depth > nearest.depth)
                    nearest = {depth, nearest.depth, static_cast<int>(t)};
                else if (depth != nearest.depth)
                    nearest.second = std::max(nearest.second, depth);
            });
        for (const NativeIsa isa : native_isas()) {
            frame.draw(isa);
            size_t compared = 0;
            for (size_t i = 0; i < wanted.size(); ++i) {
                const Nearest& nearest = wanted[i];
                if (nearest.depth - nearest.second < 1e-5 && nearest.triangle >= 0) continue;  // rounding may decide
                ++compared;
                ASSERT_EQ(frame.triangle_at(i), nearest.triangle) << name_of(isa) << ", sample " << i;
            }
            EXPECT_GT(compared, wanted.size() * 9 / 10);
        }
    }
}

// A quadrilateral across the picture, `w` from the eye.
raster::Line line_across(float top, float bottom, float w) {
    raster::Line across{};
    const float corners[4][2]{{-1, top}, {-1, bottom}, {1, top}, {1, bottom}};
    for (size_t i = 0; i < 4; ++i) {
        across.corners[i][0] = corners[i][0] * w;
        across.corners[i][1] = corners[i][1] * w;
        across.corners[i][3] = w;
    }
    return across;
}

struct TileCase {
    uint32_t sample_count;
    bool has_masks, has_lines;
};

void expect_same_in_tiles(NativeIsa isa, const TileCase& of) {
    Random random(7);
    RasterFrame frame(of.sample_count);
    raster::Material &opaque = frame.material(), &masked = frame.material();
    opaque.is_double_sided = masked.is_double_sided = true;
    masked.is_masked = true;
    masked.alpha_cutoff = 0.4f;
    const auto add = [&](float w, int size, int count) {
        std::vector<ScreenVertex> vertices;
        std::vector<uint32_t> corners;
        for (uint32_t i = 0; i < 3 * static_cast<uint32_t>(count); i += 3) {
            ScreenTriangle t = random_triangle(random, size);
            for (uint32_t k = 0; k < 3; ++k) {
                t[k].w *= w;
                vertices.push_back(t[k]);
                corners.push_back(i + k);
            }
        }
        frame.add(vertices, corners, of.has_masks && random.chance(0.5) ? masked : opaque);
    };
    // Large triangles in front hide most of those behind.
    add(0.125f, 200, 8);
    for (int i = 0; i < 60; ++i) add(2, 10, 50);
    for (int i = 0; of.has_lines && i < 10; ++i) {
        const auto top = static_cast<float>(random.between(-1, 0.9));
        frame.add_line(line_across(top, top + 0.1f, static_cast<float>(random.between(1, 8))), i < 5);
    }
    frame.draw(isa);
    const std::vector<uint64_t> samples = frame.samples();
    const std::vector<float> map = frame.map();
    for (const uint32_t side : {64u, 32u, 17u, 8u})
        for (const bool farthest_first : {true, false}) {
            frame.draw(isa, side, farthest_first);
            EXPECT_EQ(frame.samples(), samples) << side;
            EXPECT_EQ(frame.map(), map) << side;
        }
}

TEST_P(RasterTest, TilesAndOrderChangeNothing) {
    for (const uint32_t sample_count : {1u, 4u})
        for (const bool has_masks : {false, true})
            for (const bool has_lines : {false, true}) {
                SCOPED_TRACE(testing::Message() << sample_count << " samples" << (has_masks ? ", masks" : "")
                                                << (has_lines ? ", lines" : ""));
                expect_same_in_tiles(GetParam(), {sample_count, has_masks, has_lines});
            }
}

TEST_P(RasterTest, CullsBackFacesOfOneSidedMaterials) {
    // Clockwise, with y down, also in the map
    const ScreenTriangle t{{{34 * 256, 34 * 256}, {60 * 256, 34 * 256}, {34 * 256, 60 * 256}}};
    const ScreenTriangle small{{{34 * 256, 34 * 256}, {35 * 256, 34 * 256}, {34 * 256, 35 * 256}}};
    for (const ScreenTriangle& of : {t, small})
        for (const bool is_mirrored : {false, true})
            for (const bool turned : {false, true}) {
                RasterFrame frame(4);
                frame.add({of[0], of[turned ? 2 : 1], of[turned ? 1 : 2]}, {0, 1, 2}, frame.material(), is_mirrored);
                frame.draw(GetParam());
                // Front faces wind counterclockwise, as the file has them.
                const bool is_front = turned != is_mirrored;
                EXPECT_EQ(std::ranges::any_of(frame.samples(), [](uint64_t s) { return s != 0; }), is_front);
                EXPECT_TRUE(std::ranges::any_of(frame.map(), [](float height) { return height > 0; }))
                    << "both sides cast shadows";
            }
}

// A triangle in world space, intersected with rays from the eye.
class MetByRays {
public:
    explicit MetByRays(const std::array<Vec3<float>, 3>& corners) {
        const Vec3<double> a = corners[0].as<double>(), b = corners[1].as<double>(), c = corners[2].as<double>();
        edges_ = {normalized(cross(a, b)), normalized(cross(b, c)), normalized(cross(c, a))};
        normal_ = cross(b - a, c - a);
        offset_ = dot(normal_, a);
    }
    // Whether the ray through a sample hits the triangle behind the near plane, and the margin: the angle between the
    // ray and the plane through the nearest edge.
    std::pair<bool, double> meets(const Sample& at) const {
        const double half = kPictureSize * 128;
        const Vec3<double> ray{at.x / half - 1, at.y / half - 1, 1};
        const double distance = offset_ / dot(normal_, ray);
        double sureness = std::abs(distance - RasterFrame::kNear);
        int positive = 0, negative = 0;
        for (const Vec3<double>& edge : edges_) {
            const double side = dot(edge, ray);
            positive += side > 0;
            negative += side < 0;
            sureness = std::min(sureness, std::abs(side));
        }
        return {(positive == 3 || negative == 3) && distance > RasterFrame::kNear, sureness};
    }

private:
    std::array<Vec3<double>, 3> edges_;
    Vec3<double> normal_;
    double offset_ = 0;
};

TEST(Raster, ClipsTrianglesBehindTheEyeOrFarAway) {
    enum Wanted : uint8_t { kNothing, kTriangle, kEither };
    Random random(9);
    size_t inside = 0, outside = 0;
    for (int round = 0; round < 200; ++round) {
        const double size = round % 2 == 0 ? 4 : 1e5;  // also beyond the guard band
        std::array<Vec3<float>, 3> corners;
        for (Vec3<float>& corner : corners)
            corner = Vec3<double>{random.between(-size, size), random.between(-size, size), random.between(-3, 5)}
                         .as<float>();
        RasterFrame frame(4);
        raster::Material& material = frame.material();
        material.is_double_sided = true;
        frame.add_world({corners.begin(), corners.end()}, {0, 1, 2}, material);
        const MetByRays triangle(corners);
        std::vector<Wanted> wanted;
        for (size_t i = 0; i < frame.samples().size(); ++i) {
            const auto [is_met, sureness] = triangle.meets(sample_at(i, 4));
            wanted.push_back(sureness < 2e-3 ? kEither : is_met ? kTriangle : kNothing);
            inside += wanted.back() == kTriangle;
            outside += wanted.back() == kNothing;
        }
        for (const NativeIsa isa : native_isas()) {
            frame.draw(isa);
            for (size_t i = 0; i < wanted.size(); ++i)
                if (wanted[i] != kEither && wanted[i] != (frame.samples()[i] != 0 ? kTriangle : kNothing))
                    FAIL() << name_of(isa) << ", round " << round << ", sample " << i;
        }
    }
    EXPECT_GT(inside, 100'000u);
    EXPECT_GT(outside, 100'000u);
}

// With extreme scales, drawing must stay inside its memory. Triangles with a NaN corner are left out.
TEST_P(RasterTest, AcceptsExtremeAndNonFiniteCorners) {
    constexpr float kMaximum = std::numeric_limits<float>::max();
    Random random(19);
    for (const float extreme :
         {test::kNan, test::kInfinity, -test::kInfinity, 1e38f, -1e38f, kMaximum, -kMaximum, 1e20f, 1e-38f, 1e-45f})
        for (int round = 0; round < 27; ++round) {
            std::vector<Vec3<float>> corners;
            for (int k = 0; k < 3; ++k) {
                Vec3<float> corner = random.vector(1).as<float>();
                if (k == 0 || random.chance(0.5)) {
                    if (round % 3 == 0) corner.x = extreme;
                    if (round / 3 % 3 == 0) corner.y = extreme;
                    if (round / 9 % 3 == 0) corner.z = extreme;
                }
                corners.push_back(corner);
            }
            RasterFrame frame(round % 2 == 0 ? 1 : 4);
            raster::Material& material = frame.material();
            material.is_double_sided = true;
            material.is_masked = random.chance(0.5);
            frame.add_world(corners, {0, 1, 2}, material);
            frame.draw(GetParam(), 16);
            const bool is_number = std::ranges::all_of(corners, [](const Vec3<float>& corner) {
                return std::isfinite(corner.x) && std::isfinite(corner.y) && std::isfinite(corner.z);
            });
            if (is_number) continue;
            EXPECT_TRUE(std::ranges::all_of(frame.samples(), [](uint64_t sample) { return sample == 0; })) << extreme;
            EXPECT_TRUE(std::ranges::all_of(frame.map(), [](float height) { return height == 0; })) << extreme;
        }
}

TEST_P(RasterTest, LinesAreHiddenOrCoverAll) {
    RasterFrame frame(4);
    raster::Material& material = frame.material();
    material.is_double_sided = true;
    // A wall over the left half, in front of all lines
    frame.add({{0, 0, 0.5f},
               {0, kPictureSize * 256, 0.5f},
               {kPictureSize * 128, 0, 0.5f},
               {kPictureSize * 128, kPictureSize * 256, 0.5f}},
              {0, 1, 2, 2, 1, 3}, material);
    frame.add_line(line_across(-0.5f, -0.25f, 2), true);
    frame.add_line(line_across(0.25f, 0.5f, 2), false);  // covers the next one
    frame.add_line(line_across(0.4f, 0.75f, 2), false);
    frame.draw(GetParam(), 16);
    const auto shows = [&](int x, int y) {
        return frame.triangle_at(4 * (static_cast<size_t>(y) * kPictureSize + static_cast<size_t>(x)));
    };
    const int first_line = 2;
    const auto line_at = [&](int x, int y) { return shows(x, y) < first_line ? -1 : (shows(x, y) - first_line) / 2; };
    EXPECT_EQ(line_at(50, 20), 0);
    EXPECT_EQ(line_at(10, 20), -1);
    for (const int x : {10, 50}) {
        EXPECT_EQ(line_at(x, 42), 1);
        EXPECT_EQ(line_at(x, 46), 1);
        EXPECT_EQ(line_at(x, 52), 2);
    }
    EXPECT_EQ(shows(50, 60), -1);
}

}  // namespace
}  // namespace throng::test
