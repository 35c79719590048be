// Rasterisation in the native renderer, before lighting: samples against Vulkan's rules, computed with integers.
#include "tests/host/raster_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace throng {
namespace {

using test::Random;
using test::RasterFrame;
using test::ScreenVertex;

constexpr int kSize = RasterFrame::kSize;
using ScreenTriangle = std::array<ScreenVertex, 3>;

struct Sample {
    int x, y;  // subpixels
};
// Vulkan's standard sample locations, for one and four samples.
Sample sample_at(size_t index, uint32_t sample_count) {
    static constexpr Sample kFour[4]{{96, 32}, {224, 96}, {32, 160}, {160, 224}};
    const auto pixel = static_cast<int>(index / sample_count);
    const Sample in_pixel = sample_count == 1 ? Sample{128, 128} : kFour[index % sample_count];
    return {pixel % kSize * 256 + in_pixel.x, pixel / kSize * 256 + in_pixel.y};
}

int64_t cross_of(const ScreenVertex& a, const ScreenVertex& b, const Sample& p) {
    return int64_t{b.x - a.x} * (p.y - a.y) - int64_t{b.y - a.y} * (p.x - a.x);
}

// The samples that a triangle covers: by the top-left rule, for either winding.
class Coverage {
public:
    explicit Coverage(ScreenTriangle t) {
        if (cross_of(t[0], t[1], {t[2].x, t[2].y}) < 0) std::swap(t[1], t[2]);  // clockwise, y down
        if (cross_of(t[0], t[1], {t[2].x, t[2].y}) == 0) return;                // and the box stays empty
        low_ = {std::min({t[0].x, t[1].x, t[2].x}), std::min({t[0].y, t[1].y, t[2].y})};
        high_ = {std::max({t[0].x, t[1].x, t[2].x}), std::max({t[0].y, t[1].y, t[2].y})};
        for (size_t i = 0; i < 3; ++i) {
            const ScreenVertex &a = t[i], &b = t[(i + 1) % 3];
            const bool is_top = a.y == b.y && b.x > a.x, is_left = b.y < a.y;
            edges_[i] = {a, b, is_top || is_left ? 0 : 1};
        }
    }
    bool has(const Sample& p) const {
        if (p.x < low_.x || p.x > high_.x || p.y < low_.y || p.y > high_.y) return false;
        for (const Edge& edge : edges_)
            if (cross_of(edge.a, edge.b, p) < edge.least) return false;
        return true;
    }
    // Calls visit(index, place) for each covered sample of the picture. Tests only the triangle's bounding box.
    template <class Visit>
    void visit_samples(uint32_t sample_count, const Visit& visit) const {
        const auto pixel_of = [](int subpixel) { return static_cast<size_t>(std::clamp(subpixel >> 8, 0, kSize - 1)); };
        for (size_t y = pixel_of(low_.y); y <= pixel_of(high_.y); ++y)
            for (size_t x = pixel_of(low_.x); x <= pixel_of(high_.x); ++x)
                for (size_t index = (y * kSize + x) * sample_count, end = index + sample_count; index < end; ++index)
                    if (const Sample at = sample_at(index, sample_count); has(at)) visit(index, at);
    }

private:
    struct Edge {
        ScreenVertex a, b;
        int64_t least;  // the smallest cross product of a covered sample
    };
    Sample low_{1, 1}, high_{0, 0};
    std::array<Edge, 3> edges_{};
};

// 1 / w is linear on the screen.
double depth_at(const ScreenTriangle& t, const Sample& p) {
    const auto area = static_cast<double>(cross_of(t[0], t[1], {t[2].x, t[2].y}));
    double depth = 0;
    for (size_t i = 0; i < 3; ++i)
        depth += static_cast<double>(cross_of(t[(i + 1) % 3], t[(i + 2) % 3], p)) / area / t[i].w;
    return depth * RasterFrame::kNear;
}

// Some are smaller than a pixel, others reach beyond the picture.
ScreenTriangle random_triangle(Random& random, int largest) {
    const double size = 256 * std::exp(random.between(std::log(0.2), std::log(largest)));
    const double x = random.between(-20, kSize + 20) * 256, y = random.between(-20, kSize + 20) * 256;
    ScreenTriangle t;
    for (ScreenVertex& v : t)
        v = {static_cast<int32_t>(std::lround(x + random.between(-size, size))),
             static_cast<int32_t>(std::lround(y + random.between(-size, size))),
             static_cast<float>(1 << random.below(4))};
    return t;
}

class RasterTest : public testing::TestWithParam<NativeIsa> {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, RasterTest, testing::ValuesIn(native_isas()), [](const auto& of) {
    std::string name(name_of(of.param));
    std::erase(name, '-');  // not allowed in GoogleTest's names
    return name;
});

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
        const int step = kSize * 256 / cells + 1;
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
        const double half = kSize * 128;
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

TEST_P(RasterTest, TheMapHoldsTheGreatestHeightsLessTheirSlope) {
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
            vertices.push_back({static_cast<float>(v.x) / (kSize * 256), static_cast<float>(v.y) / (kSize * 256), v.w});
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
TEST_P(RasterTest, ClipsTrianglesFarOutsideTheMap) {
    Random random(17);
    size_t inside = 0, outside = 0;
    for (int round = 0; round < 200; ++round) {
        const double size = round % 4 == 0 ? 64 : 1e6;  // texels
        std::array<Vec3<float>, 3> corners;
        for (Vec3<float>& corner : corners)
            corner = Vec3<double>{random.between(-size, size) / kSize, random.between(-size, size) / kSize,
                                  random.between(1, 2)}
                         .as<float>();
        RasterFrame frame(1);
        frame.add_world({corners.begin(), corners.end()}, {0, 1, 2}, frame.material());
        frame.draw(GetParam());
        // Converts to texels
        std::array<Vec3<double>, 3> at;
        for (size_t k = 0; k < 3; ++k) {
            at[k] = corners[k].as<double>();
            at[k].x *= kSize;
            at[k].y *= kSize;
        }
        const Vec3<double> normal = cross(at[1] - at[0], at[2] - at[0]);
        const double slope_x = -normal.x / normal.z, slope_y = -normal.y / normal.z,
                     slope = std::max(std::abs(slope_x), std::abs(slope_y));
        for (size_t i = 0; i < frame.map().size(); ++i) {
            const double x = static_cast<double>(i % kSize) + 0.5, y = static_cast<double>(i / kSize) + 0.5;
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
    frame.add({{0, 0, 0.5f}, {0, kSize * 256, 0.5f}, {kSize * 128, 0, 0.5f}, {kSize * 128, kSize * 256, 0.5f}},
              {0, 1, 2, 2, 1, 3}, material);
    frame.add_line(line_across(-0.5f, -0.25f, 2), true);
    frame.add_line(line_across(0.25f, 0.5f, 2), false);  // covers the next one
    frame.add_line(line_across(0.4f, 0.75f, 2), false);
    frame.draw(GetParam(), 16);
    const auto shows = [&](int x, int y) {
        return frame.triangle_at(4 * (static_cast<size_t>(y) * kSize + static_cast<size_t>(x)));
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

TEST_P(RasterTest, SkinsVerticesAndTheirNormals) {
    const raster::Kernel& kernel = raster::kernel_of(GetParam());
    Random random(13);
    for (const uint32_t influence_count : {4u, 8u})
        for (const bool some_mirror : {false, true}) {
            constexpr uint32_t kEntries = 9, kVertices = 37;
            std::vector<Affine> skin(kEntries);
            for (Affine& matrix : skin) {
                Trs<double> trs = random.trs(1, 0.4);
                if (some_mirror && random.chance(0.3)) trs.scale.x = -trs.scale.x;
                matrix = to_affine(trs).as<float>();
            }
            const Affine placement = to_affine(random.trs(20, 0.5)).as<float>();
            const native::AlignedBytes columns = native::aligned_bytes(kEntries * 16 * sizeof(float)),
                                       bind = native::aligned_bytes(48 * 8 * sizeof(float)),
                                       kept = native::aligned_bytes(48 * 4 * sizeof(float));
            const auto floats = [](const native::AlignedBytes& bytes) { return reinterpret_cast<float*>(bytes.get()); };
            // Half turns by all axes blend to a point reflection, though none of them mirrors
            for (size_t axis = 0; axis < 3; ++axis) {
                skin[axis] = Affine{};
                for (size_t row = 0; row < 3; ++row) skin[axis].row[row][row] = row == axis ? 1 : -1;
            }
            kernel.place(&placement.row[0][0], &skin[0].row[0][0], kEntries, floats(columns));

            std::vector<float> weights;
            std::vector<uint16_t> entries;
            for (uint32_t v = 0; v < kVertices; ++v) {
                const Vec3<float> place = random.vector(1).as<float>(), normal = random.direction().as<float>();
                const float numbers[8]{place.x, place.y, place.z, 1, normal.x, normal.y, normal.z, 0};
                std::ranges::copy(numbers, floats(bind) + size_t{v} * 8);
                float left = 1;
                // Only one influence if some mirror, since blends of mirroring and other matrices may be flat
                for (uint32_t i = 0; i < influence_count; ++i) {
                    const float weight = i + 1 == influence_count ? left : some_mirror ? 0 : left * 0.6f;
                    left -= weight;
                    weights.push_back(weight);
                    entries.push_back(static_cast<uint16_t>(random.below(kEntries)));
                }
            }
            for (uint32_t i = 0; i < influence_count; ++i) {
                weights[i] = i < 3 ? 1 / 3.0f : 0;
                entries[i] = static_cast<uint16_t>(i);
            }
            RasterFrame frame(4);
            raster::Section section{.vertex_count = kVertices,
                                    .bind = floats(bind),
                                    .weights = weights.data(),
                                    .entries = entries.data(),
                                    .influence_count = influence_count};
            raster::Draw draw{.section = &section, .vertices = floats(kept)};
            kernel.skin(frame.frame(), floats(columns), nullptr, draw);

            for (uint32_t v = 0; v < kVertices; ++v) {
                AffineT<double> blended{};
                for (auto& row : blended.row) std::ranges::fill(row, 0.0);
                for (uint32_t i = 0; i < influence_count; ++i)
                    for (size_t r = 0; r < 3; ++r)
                        for (size_t c = 0; c < 4; ++c)
                            blended.row[r][c] += double{weights[v * influence_count + i]} *
                                                 double{skin[entries[v * influence_count + i]].row[r][c]};
                const AffineT<double> world = placement.as<double>() * blended;
                const float* const in = floats(bind) + size_t{v} * 8;
                const Vec3<double> place = transform_point(world,
                                                           Vec3<double>{double{in[0]}, double{in[1]}, double{in[2]}});
                constexpr uint32_t kFour = raster::kFour, kFourFloats = raster::kFourFloats;
                const float* const out = floats(kept) + v / kFour * kFourFloats + v % kFour;
                EXPECT_NEAR(static_cast<double>(out[0]), place.x, 2e-5);
                EXPECT_NEAR(static_cast<double>(out[kFour]), place.y, 2e-5);
                EXPECT_NEAR(static_cast<double>(out[2 * kFour]), place.z, 2e-5);
                // The normal of two transformed tangents, on the same side as the vertex normal
                const Vec3<double> normal{double{in[4]}, double{in[5]}, double{in[6]}};
                const Vec3<double> along = normalized(
                    cross(normal, std::abs(normal.x) < 0.9 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}));
                const auto turned = [&](const Vec3<double>& t) {
                    return transform_point(world, t) - transform_point(world, Vec3<double>{});
                };
                Vec3<double> wanted = normalized(cross(turned(along), turned(cross(normal, along))));
                if (determinant(world) < 0) wanted = wanted * -1.0;
                EXPECT_LT(length(test::unpacked_normal(out[3 * kFour]) - wanted), 2e-4) << v;
            }
            const auto right_edge_at = [&](float distance) {
                Affine moved = placement;
                moved.row[2][3] = distance;
                kernel.place(&moved.row[0][0], &skin[0].row[0][0], kEntries, floats(columns));
                kernel.skin(frame.frame(), floats(columns), nullptr, draw);
                return draw.picture_box[2];
            };
            EXPECT_EQ(right_edge_at(RasterFrame::kNear), RasterFrame::kSize) << "partly behind the eye it is anywhere";
            EXPECT_LT(right_edge_at(-100), 0) << "wholly, nowhere";
        }
}

}  // namespace
}  // namespace throng
