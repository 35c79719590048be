// What the renderer for processors draws, before it is lit: samples against Vulkan's rules, counted in integers.
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
using Triangle = std::array<ScreenVertex, 3>;

struct Sample {
    int x, y;  // subpixels
};
// Vulkan's standard places, of one and of four.
Sample sample_at(size_t index, uint32_t sample_count) {
    static constexpr Sample kFour[4]{{96, 32}, {224, 96}, {32, 160}, {160, 224}};
    const auto pixel = static_cast<int>(index / sample_count);
    const Sample in_pixel = sample_count == 1 ? Sample{128, 128} : kFour[index % sample_count];
    return {pixel % kSize * 256 + in_pixel.x, pixel / kSize * 256 + in_pixel.y};
}

int64_t cross_of(const ScreenVertex& a, const ScreenVertex& b, const Sample& p) {
    return int64_t{b.x - a.x} * (p.y - a.y) - int64_t{b.y - a.y} * (p.x - a.x);
}

// By the rule of top and left edges, of either winding.
bool covers(Triangle t, const Sample& p) {
    if (cross_of(t[0], t[1], {t[2].x, t[2].y}) < 0) std::swap(t[1], t[2]);  // clockwise, y down
    if (cross_of(t[0], t[1], {t[2].x, t[2].y}) == 0) return false;
    for (size_t i = 0; i < 3; ++i) {
        const ScreenVertex &a = t[i], &b = t[(i + 1) % 3];
        const int64_t side = cross_of(a, b, p);
        const bool is_top = a.y == b.y && b.x > a.x, is_left = b.y < a.y;
        if (side < 0 || (side == 0 && !is_top && !is_left)) return false;
    }
    return true;
}

// 1 / w is linear on the screen.
double depth_at(const Triangle& t, const Sample& p) {
    const auto area = static_cast<double>(cross_of(t[0], t[1], {t[2].x, t[2].y}));
    double depth = 0;
    for (size_t i = 0; i < 3; ++i)
        depth += static_cast<double>(cross_of(t[(i + 1) % 3], t[(i + 2) % 3], p)) / area / t[i].w;
    return depth * RasterFrame::kNear;
}

// Of all sizes, some of them reaching out of the picture.
Triangle random_triangle(Random& random, int largest) {
    const double size = 256 * std::exp(random.between(std::log(0.2), std::log(largest)));
    const double x = random.between(-20, kSize + 20) * 256, y = random.between(-20, kSize + 20) * 256;
    Triangle t;
    for (ScreenVertex& v : t)
        v = {static_cast<int32_t>(std::lround(x + random.between(-size, size))),
             static_cast<int32_t>(std::lround(y + random.between(-size, size))),
             static_cast<float>(1 << random.below(4))};
    return t;
}

class RasterTest : public testing::TestWithParam<NativeIsa> {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, RasterTest, testing::ValuesIn(native_isas()), [](const auto& of) {
    std::string name(name_of(of.param));
    std::erase(name, '-');  // which GoogleTest does not take
    return name;
});

TEST_P(RasterTest, CoversTheSamplesOfATriangleAndNoOthers) {
    for (const uint32_t sample_count : {1u, 4u}) {
        Random random(sample_count);
        size_t covered = 0;
        for (int round = 0; round < 400; ++round) {
            RasterFrame frame(sample_count);
            raster::Material& material = frame.material();
            material.is_double_sided = true;
            const Triangle t = random_triangle(random, 60);
            frame.add({t[0], t[1], t[2]}, {0, 1, 2}, material);
            frame.draw(GetParam());
            for (size_t i = 0; i < frame.samples().size(); ++i) {
                const Sample at = sample_at(i, sample_count);
                const bool wanted = covers(t, at);
                ASSERT_EQ(frame.samples()[i] != 0, wanted) << "round " << round << ", sample " << at.x << ", " << at.y;
                if (!wanted) continue;
                ++covered;
                ASSERT_NEAR(RasterFrame::depth_of(frame.samples()[i]), depth_at(t, at), 2e-6);
            }
        }
        EXPECT_GT(covered, 50'000u * sample_count / 4);
    }
}

TEST_P(RasterTest, TrianglesThatMeetCoverEachSampleOnce) {
    // A picture full of small and large ones, whose corners are shared
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
        // Of no sample is there another triangle behind.
        for (size_t i = 0; i < all.samples().size(); ++i) {
            const Sample at = sample_at(i, 4);
            const auto t = static_cast<size_t>(all.triangle_at(i)) * 3;
            ASSERT_TRUE(covers({vertices[corners[t]], vertices[corners[t + 1]], vertices[corners[t + 2]]}, at));
        }
    }
}

TEST_P(RasterTest, ShowsTheNearestTriangleAndTheFirstOfEqualOnes) {
    for (const uint32_t sample_count : {1u, 4u}) {
        Random random(5);
        RasterFrame frame(sample_count);
        raster::Material& material = frame.material();
        material.is_double_sided = true;
        std::vector<Triangle> triangles;
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
        frame.draw(GetParam());
        size_t compared = 0;
        for (size_t i = 0; i < frame.samples().size(); ++i) {
            const Sample at = sample_at(i, sample_count);
            double nearest = 0, second = 0;
            int wanted = -1;
            for (size_t t = 0; t < triangles.size(); ++t) {
                if (!covers(triangles[t], at)) continue;
                const double depth = depth_at(triangles[t], at);
                if (depth > nearest) {
                    second = nearest;
                    nearest = depth;
                    wanted = static_cast<int>(t);
                } else if (depth != nearest) {
                    second = std::max(second, depth);
                }
            }
            if (nearest - second < 1e-5 && wanted >= 0) continue;  // rounding may decide
            ++compared;
            ASSERT_EQ(frame.triangle_at(i), wanted) << at.x << ", " << at.y;
        }
        EXPECT_GT(compared, frame.samples().size() * 9 / 10);
    }
}

TEST_P(RasterTest, TilesAndOrderChangeNothing) {
    Random random(7);
    RasterFrame frame(4);
    raster::Material& material = frame.material();
    material.is_double_sided = true;
    const auto add = [&](float w, int size, int count) {
        std::vector<ScreenVertex> vertices;
        std::vector<uint32_t> corners;
        for (uint32_t i = 0; i < 3 * static_cast<uint32_t>(count); i += 3) {
            Triangle t = random_triangle(random, size);
            for (uint32_t k = 0; k < 3; ++k) {
                t[k].w *= w;
                vertices.push_back(t[k]);
                corners.push_back(i + k);
            }
        }
        frame.add(vertices, corners, material);
    };
    // Large ones in front hide most of what comes behind.
    add(0.125f, 200, 8);
    for (int i = 0; i < 60; ++i) add(2, 10, 50);
    frame.draw(GetParam());
    const std::vector<uint64_t> samples = frame.samples();
    const std::vector<float> map = frame.map();
    for (const uint32_t side : {64u, 32u, 17u, 8u})
        for (const bool farthest_first : {true, false}) {
            frame.draw(GetParam(), side, farthest_first);
            EXPECT_EQ(frame.samples(), samples) << side;
            EXPECT_EQ(frame.map(), map) << side;
        }
}

TEST_P(RasterTest, LeavesOutBacksOfMaterialsWithOneSide) {
    const Triangle t{{{10 * 256, 10 * 256}, {50 * 256, 10 * 256}, {10 * 256, 50 * 256}}};  // clockwise, y down
    const Triangle small{{{10 * 256, 10 * 256}, {11 * 256, 10 * 256}, {10 * 256, 11 * 256}}};
    for (const Triangle& of : {t, small})
        for (const bool is_mirrored : {false, true})
            for (const bool turned : {false, true}) {
                RasterFrame frame(4);
                frame.add({of[0], of[turned ? 2 : 1], of[turned ? 1 : 2]}, {0, 1, 2}, frame.material(), is_mirrored);
                frame.draw(GetParam());
                // Front faces wind counterclockwise, as the file has them.
                const bool is_front = turned != is_mirrored;
                EXPECT_EQ(std::ranges::any_of(frame.samples(), [](uint64_t s) { return s != 0; }), is_front);
                // In the map there are both.
            }
}

// Whether the ray through a sample meets a triangle of the world behind the near plane, and how surely: how far the
// ray's plane is from an edge's, as an angle.
std::pair<bool, double> meets(const std::array<Vec3<float>, 3>& corners, const Sample& at) {
    const double half = kSize * 128;
    const Vec3<double> ray{at.x / half - 1, at.y / half - 1, 1};
    const Vec3<double> a = corners[0].as<double>(), b = corners[1].as<double>(), c = corners[2].as<double>();
    const std::array sides{dot(normalized(cross(a, b)), ray), dot(normalized(cross(b, c)), ray),
                           dot(normalized(cross(c, a)), ray)};
    const Vec3<double> normal = cross(b - a, c - a);
    const double distance = dot(normal, a) / dot(normal, ray);
    const bool positive = sides[0] > 0 && sides[1] > 0 && sides[2] > 0,
               negative = sides[0] < 0 && sides[1] < 0 && sides[2] < 0;
    double sureness = std::abs(distance - RasterFrame::kNear);
    for (const double side : sides) sureness = std::min(sureness, std::abs(side));
    return {(positive || negative) && distance > RasterFrame::kNear, sureness};
}

TEST_P(RasterTest, ClipsWhatReachesBehindTheEyeOrFarAway) {
    Random random(9);
    size_t inside = 0, outside = 0;
    for (int round = 0; round < 200; ++round) {
        const double size = round % 2 == 0 ? 4 : 1e5;  // and beyond the guard
        std::array<Vec3<float>, 3> corners;
        for (Vec3<float>& corner : corners)
            corner = Vec3<double>{random.between(-size, size), random.between(-size, size), random.between(-3, 5)}
                         .as<float>();
        RasterFrame frame(4);
        raster::Material& material = frame.material();
        material.is_double_sided = true;
        frame.add_world({corners.begin(), corners.end()}, {0, 1, 2}, material);
        frame.draw(GetParam());
        for (size_t i = 0; i < frame.samples().size(); ++i) {
            const auto [wanted, sureness] = meets(corners, sample_at(i, 4));
            if (sureness < 2e-3) continue;
            ASSERT_EQ(frame.samples()[i] != 0, wanted) << round;
            ++(wanted ? inside : outside);
        }
    }
    EXPECT_GT(inside, 100'000u);
    EXPECT_GT(outside, 100'000u);
}

TEST_P(RasterTest, TheMapHasTheGreatestHeightsLessTheirSlope) {
    Random random(11);
    RasterFrame frame(1);
    raster::Material& material = frame.material();
    std::vector<Triangle> triangles;
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
    for (size_t i = 0; i < frame.map().size(); ++i) {
        const Sample at = sample_at(i, 1);
        double wanted = 0, steepest = 0;
        for (const Triangle& t : triangles) {
            if (!covers(t, at)) continue;
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

TEST_P(RasterTest, LinesAreHiddenOrCoverAll) {
    RasterFrame frame(4);
    raster::Material& material = frame.material();
    material.is_double_sided = true;
    // A wall over the left half, nearer than all lines
    frame.add({{0, 0, 0.5f}, {0, kSize * 256, 0.5f}, {kSize * 128, 0, 0.5f}, {kSize * 128, kSize * 256, 0.5f}},
              {0, 1, 2, 2, 1, 3}, material);
    const auto line = [](float top, float bottom) {
        raster::Line across{};
        const float corners[4][2]{{-1, top}, {-1, bottom}, {1, top}, {1, bottom}};
        for (size_t i = 0; i < 4; ++i) {
            across.corners[i][0] = corners[i][0] * 2;
            across.corners[i][1] = corners[i][1] * 2;
            across.corners[i][3] = 2;
        }
        return across;
    };
    frame.add_line(line(-0.5f, -0.25f), true);
    frame.add_line(line(0.25f, 0.5f), false);  // covers the next one
    frame.add_line(line(0.4f, 0.75f), false);
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
                // Of mirrored ones just one, or what they blend to may be flat
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
                const float* const out = floats(kept) + v / 16 * 64 + v % 16;
                EXPECT_NEAR(static_cast<double>(out[0]), place.x, 2e-5);
                EXPECT_NEAR(static_cast<double>(out[16]), place.y, 2e-5);
                EXPECT_NEAR(static_cast<double>(out[32]), place.z, 2e-5);
                // The normal of two tangents that have been transformed, on the side that the vertex's was
                const Vec3<double> normal{double{in[4]}, double{in[5]}, double{in[6]}};
                const Vec3<double> along = normalized(
                    cross(normal, std::abs(normal.x) < 0.9 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}));
                const auto turned = [&](const Vec3<double>& t) {
                    return transform_point(world, t) - transform_point(world, Vec3<double>{});
                };
                Vec3<double> wanted = normalized(cross(turned(along), turned(cross(normal, along))));
                if (determinant(world) < 0) wanted = wanted * -1.0;
                const auto bits = std::bit_cast<uint32_t>(out[48]);
                const double u = static_cast<int16_t>(bits & 0xFFFF) / 32767.0,
                             w = static_cast<int16_t>(bits >> 16) / 32767.0;
                const double z = 1 - std::abs(u) - std::abs(w);
                const auto folded = [](double a, double b) { return (1 - std::abs(b)) * (a >= 0 ? 1 : -1); };
                const Vec3<double> got = normalized(
                    Vec3<double>{z < 0 ? folded(u, w) : u, z < 0 ? folded(w, u) : w, z});
                EXPECT_LT(length(got - wanted), 1e-3) << v;
            }
        }
}

}  // namespace
}  // namespace throng
