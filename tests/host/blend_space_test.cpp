// Parts of controllers: blend spaces, joint masks, and the kernel's tables.
#include "controller/blend_space.h"
#include "base/failure.h"
#include "control/array_tables.h"
#include "controller/controller_tables.h"
#include "controller/joint_mask.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace throng {
namespace io {
namespace {

struct Mixer : ArrayTables {
    std::array<float, 2> place;
    ControllerLayout layout_of_group{.clip_count = kNone};

    float parameter_at(uint index) const { return place[index]; }
#include "control/blend_space.glsl"
};

}  // namespace
}  // namespace io
namespace {

using namespace test;

// Computes the weights of all points at (x, y) with the tables of a controller with one state, whose point k plays clip
// k.
class Space {
public:
    explicit Space(std::vector<BlendPoint> points) : points_(std::move(points)), space(make_blend_space(points_)) {
        state_ = {.point_count = static_cast<uint32_t>(points_.size()),
                  .triangle_count = static_cast<uint32_t>(space.triangles.size()),
                  .edge_count = static_cast<uint32_t>(space.edges.size()),
                  .x_parameter = 0,
                  .y_parameter = 1,
                  .speed_parameter = kNone,
                  .speed = 1,
                  .sync = kNone};
        for (uint32_t i = 0; i < points_.size(); ++i) arrays_.points.push_back({i, points_[i].x, points_[i].y, 0});
        arrays_.clips.resize(points_.size());
        arrays_.triangles = space.triangles;
        arrays_.edges = space.edges;
    }
    std::vector<double> weights_at(float x, float y) const {
        std::vector<double> weights(points_.size(), 0.0);
        const io::Mixer::ClipMix mix = io::Mixer{{arrays_}, {x, y}}.mix_of_state(state_);
        for (uint32_t k = 0; k < 3; ++k) weights[mix.clips[k]] += mix.weights[k];
        return weights;
    }
    // The average of the points by these weights: (x, y) itself inside the hull.
    std::array<double, 2> place_of(const std::vector<double>& weights) const {
        std::array<double, 2> place{};
        for (size_t i = 0; i < points_.size(); ++i) {
            place[0] += weights[i] * points_[i].x;
            place[1] += weights[i] * points_[i].y;
        }
        return place;
    }
    double area_of_triangles() const {
        double area = 0;
        for (const io::ControlTriangle& t : space.triangles) {
            const BlendPoint &a = points_[t.a], &b = points_[t.b], &c = points_[t.c];
            const double twice = (double{b.x} - a.x) * (double{c.y} - a.y) - (double{b.y} - a.y) * (double{c.x} - a.x);
            EXPECT_GT(twice, 0);
            area += twice / 2;
        }
        return area;
    }

private:
    std::vector<BlendPoint> points_;
    io::ControlState state_{};
    ControllerArrays arrays_;

public:
    BlendSpace space;
};

double cross(const BlendPoint& o, const BlendPoint& a, const BlendPoint& b) {
    return (double{a.x} - o.x) * (double{b.y} - o.y) - (double{a.y} - o.y) * (double{b.x} - o.x);
}

// Andrew's monotone chain, 1979: a different hull algorithm than the one tested.
std::vector<BlendPoint> hull_of(std::vector<BlendPoint> points) {
    std::ranges::sort(points, [](const auto& a, const auto& b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); });
    std::vector<BlendPoint> hull;
    for (int pass = 0; pass < 2; ++pass) {
        const size_t begin = hull.size();
        for (const BlendPoint& point : points) {
            while (hull.size() >= begin + 2 && cross(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
            hull.push_back(point);
        }
        hull.pop_back();
        std::ranges::reverse(points);
    }
    return hull;
}

double area_of_hull(const std::vector<BlendPoint>& points) {
    const std::vector<BlendPoint> hull = hull_of(points);
    double area = 0;
    for (size_t i = 0; i + 1 < hull.size(); ++i) area += cross(hull[0], hull[i], hull[i + 1]) / 2;
    return area;
}

// Queries at the points, inside random triangles of points (so inside the hull), on segments between points, and
// outside.
void check_space(const std::vector<BlendPoint>& points, double size, Random& random) {
    const Space space(points);
    EXPECT_NEAR(space.area_of_triangles(), area_of_hull(points), 1e-4 * size * size);
    const auto check = [&](double x, double y, bool inside) {
        const std::vector<double> weights = space.weights_at(static_cast<float>(x), static_cast<float>(y));
        double sum = 0;
        for (const double weight : weights) {
            EXPECT_GE(weight, 0);
            sum += weight;
        }
        EXPECT_NEAR(sum, 1, 4e-5);
        if (!inside) return;
        EXPECT_NEAR(space.place_of(weights)[0], x, 1e-3 * size) << x << ", " << y;
        EXPECT_NEAR(space.place_of(weights)[1], y, 1e-3 * size) << x << ", " << y;
    };
    for (size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(space.weights_at(points[i].x, points[i].y)[i], 1, 1e-3) << "point " << i << " of " << points.size();
    for (int i = 0; i < 300; ++i) {
        const auto pick = [&]() -> const BlendPoint& {
            return points[random.below(static_cast<uint32_t>(points.size()))];
        };
        const BlendPoint &a = pick(), &b = pick(), &c = pick();
        double u = random.unit(), v = i % 3 == 0 ? 0 : random.unit();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        check(a.x + u * (double{b.x} - a.x) + v * (double{c.x} - a.x),
              a.y + u * (double{b.y} - a.y) + v * (double{c.y} - a.y), true);
        check(random.between(-3, 3) * size, random.between(-3, 3) * size, false);
    }
}

TEST(BlendSpace, TrianglesFillTheHullOfRandomPoints) {
    Random random(1);
    for (int round = 0; round < 200; ++round) {
        const uint32_t count = 3 + random.below(62);
        std::vector<BlendPoint> points;
        for (uint32_t i = 0; i < count; ++i)
            points.push_back(
                {"", static_cast<float>(random.between(-2, 2)), static_cast<float>(random.between(-2, 2))});
        check_space(points, 4, random);
        if (testing::Test::HasFailure()) FAIL() << "round " << round;
    }
}

TEST(BlendSpace, NoCircleAroundATriangleHoldsAPoint) {
    Random random(3);
    for (int round = 0; round < 50; ++round) {
        std::vector<BlendPoint> points{{"", 0, 0}, {"", 1, 1}};  // the box is not scaled
        for (int i = 0; i < 30; ++i)
            points.push_back({"", static_cast<float>(random.unit()), static_cast<float>(random.unit())});
        for (const io::ControlTriangle& t : make_blend_space(points).triangles) {
            const BlendPoint &a = points[t.a], &b = points[t.b], &c = points[t.c];
            const auto length = [](double x, double y) { return x * x + y * y; };
            const double bx = double{b.x} - a.x, by = double{b.y} - a.y, cx = double{c.x} - a.x, cy = double{c.y} - a.y,
                         twice = 2 * (bx * cy - by * cx);
            // The circumcentre, relative to a
            const double x = (cy * length(bx, by) - by * length(cx, cy)) / twice,
                         y = (bx * length(cx, cy) - cx * length(bx, by)) / twice;
            for (const BlendPoint& point : points)
                EXPECT_GE(length(point.x - (a.x + x), point.y - (a.y + y)), length(x, y) * (1 - 1e-6) - 1e-9);
        }
    }
}

TEST(BlendSpace, GridsAndCirclesHaveNeitherHolesNorOverlaps) {
    Random random(2);
    for (const float step : {1.0f, 0.1f, 1 / 3.0f})  // with steps of 0.1 and 1/3, points are not exactly on lines
        for (int width = 2; width <= 8; ++width)
            for (int height = 2; height <= 8; ++height) {
                std::vector<BlendPoint> points;
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x)
                        points.push_back({"", step * static_cast<float>(x), 3 * step * static_cast<float>(y - 2)});
                for (size_t i = points.size(); i > 1; --i)
                    std::swap(points[i - 1], points[random.below(static_cast<uint32_t>(i))]);
                check_space(points, 8 * step, random);
                if (testing::Test::HasFailure()) FAIL() << width << " x " << height << " by " << step;
            }
    for (int count = 3; count <= 63; ++count) {
        std::vector<BlendPoint> points;
        for (int i = 0; i < count; ++i)
            points.push_back({"", std::cos(6.2831853f * static_cast<float>(i) / static_cast<float>(count)),
                              std::sin(6.2831853f * static_cast<float>(i) / static_cast<float>(count))});
        points.push_back({"", 0, 0});
        check_space(points, 2, random);
        if (testing::Test::HasFailure()) FAIL() << count << " on a circle";
    }
}

TEST(BlendSpace, PointsOnALineAreJoinedInTheirOrder) {
    for (const auto& [dx, dy] :
         {std::pair(1.0f, 0.0f), std::pair(0.0f, 1.0f), std::pair(1.0f, 0.3f), std::pair(-0.1f, 0.7f)}) {
        std::vector<BlendPoint> points;
        for (const float t : {2.0f, -1.0f, 0.5f, 3.0f}) points.push_back({"", t * dx, t * dy});
        const Space space(points);
        EXPECT_TRUE(space.space.triangles.empty());
        EXPECT_EQ(space.space.edges.size(), 3u);
        const std::vector<double> weights = space.weights_at(dx - dy, dy + dx);  // beside the line, at t = 1
        EXPECT_NEAR(weights[0], 1 / 3.0, 1e-6);
        EXPECT_NEAR(weights[2], 2 / 3.0, 1e-6);
        EXPECT_NEAR(space.weights_at(9 * dx, 9 * dy)[3], 1, 1e-6);
    }
}

TEST(BlendSpace, OnePointIsEverywhere) {
    const Space space({{"", 3, 4}});
    EXPECT_TRUE(space.space.triangles.empty());
    ASSERT_EQ(space.space.edges.size(), 1u);
    EXPECT_EQ(space.space.edges[0].dx, 0);
    EXPECT_EQ(space.weights_at(-7, 1e30f)[0], 1);
}

// Speeds in mm/s and leans in radians: the points span a very thin area, but it still has two dimensions.
TEST(BlendSpace, UnitsOfTheTwoParametersMayDiffer) {
    const Space space({{"", 0, -0.05f}, {"", 5000, -0.05f}, {"", 0, 0.05f}, {"", 5000, 0.05f}});
    EXPECT_EQ(space.space.triangles.size(), 2u);
    EXPECT_NEAR(space.place_of(space.weights_at(1250, 0.02f))[1], 0.02, 1e-6);
}

TEST(BlendSpace, FlatBorderTrianglesAreReplacedByEdges) {
    const Space space({{"", 0, 0}, {"", 2, 0}, {"", 1, 1e-6f}, {"", 1, 2}});
    EXPECT_EQ(space.space.triangles.size(), 2u);
    EXPECT_EQ(space.space.edges.size(), 4u);
    EXPECT_NEAR(space.weights_at(0.5f, 0)[2], 0.5, 1e-6);
    EXPECT_NEAR(space.weights_at(0.5f, 0)[0], 0.5, 1e-6);
}

TEST(BlendSpace, OutsideTheHullTheNearestEdgeIsUsed) {
    const Space space({{"", 0, 0}, {"", 2, 0}, {"", 0, 2}});
    EXPECT_NEAR(space.weights_at(0.5f, -3)[0], 0.75, 1e-6);
    EXPECT_NEAR(space.weights_at(0.5f, -3)[1], 0.25, 1e-6);
    EXPECT_NEAR(space.weights_at(9, -1)[1], 1, 1e-6);
    EXPECT_NEAR(space.weights_at(2, 2)[2], 0.5, 1e-6);
}

Rig chain_with_side_joint() {
    Rig rig;
    rig.names = {"hips", "spine", "chest", "head", "leg"};
    rig.parents = {kNone, 0, 1, 2, 0};
    return rig;
}

TEST(JointMask, CoversAJointAndAllBelow) {
    const Rig rig = chain_with_side_joint();
    EXPECT_EQ(mask_weights({"none", {}}, rig), (std::vector<float>{0, 0, 0, 0, 0}));
    EXPECT_EQ(mask_weights({"upper", {{"spine"}}}, rig), (std::vector<float>{0, 1, 1, 1, 0}));
    EXPECT_EQ(mask_weights({"later wins", {{"hips", 0.5f}, {"chest", 0}}}, rig),
              (std::vector<float>{0.5f, 0.5f, 0, 0, 0.5f}));
    EXPECT_EQ(mask_weights({"earlier loses", {{"chest", 0}, {"hips", 0.5f}}}, rig),
              (std::vector<float>{0.5f, 0.5f, 0.5f, 0.5f, 0.5f}));
}

TEST(JointMask, RampsRiseInEqualSteps) {
    const Rig rig = chain_with_side_joint();
    EXPECT_EQ(mask_weights({"", {{"hips", 1, 3}}}, rig), (std::vector<float>{0.25f, 0.5f, 0.75f, 1, 0.5f}));
    EXPECT_EQ(mask_weights({"", {{"spine", 0.5f, 1}}}, rig), (std::vector<float>{0, 0.25f, 0.5f, 0.5f, 0}));
    EXPECT_EQ(mask_weights({"", {{"hips", 0.5f}, {"head", 0.5f, 1}}}, rig),
              (std::vector<float>{0.5f, 0.5f, 0.5f, 0.25f, 0.5f}));
}

TEST(ControllerTables, TimesBecomePhases) {
    EXPECT_EQ(phase_at(0.5, 2, true), 0x40000000u);
    EXPECT_EQ(phase_at(-0.5, 2, true), 0xC0000000u);
    EXPECT_EQ(phase_at(5, 2, true), 0x80000000u);
    EXPECT_EQ(phase_at(2, 2, true), 0u);
    EXPECT_EQ(phase_at(-1e-30, 2, true), 0u);
    EXPECT_EQ(phase_at(2, 2, false), io::kLastPhase);
    EXPECT_EQ(phase_at(9, 2, false), io::kLastPhase);
    EXPECT_EQ(phase_at(-1, 2, false), 0u);
    EXPECT_EQ(phase_at(1, 0, true), 0u);
}

template <class T>
T read(const ControllerTables& tables, uint32_t begin, uint32_t index) {
    T item;
    std::memcpy(&item, tables.words.data() + begin + index * (sizeof(T) / 4), sizeof(T));
    return item;
}

TEST(ControllerTables, HoldTheStructsAsWords) {
    const Character character = make_character({.joint_count = 6, .clip_count = 3});  // 1, 2, 3 s
    const std::string a = character.clips[0].name, b = character.clips[1].name, c = character.clips[2].name;
    Controller controller{.name = "test",
                          .parameters = {{"x", ParameterType::kFloat, 0.5f}, {"y"}, {"go", ParameterType::kTrigger}}};
    controller.events = {{"late", b, 1.5}, {"end", c, 3}, {"early", b, 0.5}};
    controller.masks = {{"some", {{character.rig.names[1]}}}, {"all", {{character.rig.names[0]}}}};
    controller.layers = {
        {.name = "base",
         .states = {{.name = "one", .points = {{a}}, .sync = "step"},
                    {.name = "line", .points = {{a, 0}, {b, 4}}, .x_parameter = "x"},
                    {.name = "plane",
                     .points = {{a, 0, 0}, {b, 1, 0}, {c, 0, 1}},
                     .x_parameter = "x",
                     .y_parameter = "y",
                     .sync = "step"}},
         .transitions = {{.to = "one", .conditions = {{"go", ControllerCondition::Test::kTriggered}}, .fade_s = 0.25f},
                         {.from = "one", .to = "line", .exit = 1.5f, .interrupts = true}}},
        {.name = "top", .mode = LayerMode::kAdditive, .mask = "all", .weight = 0.75f, .weight_parameter = "x"}};
    const ControllerTables tables = make_controller_tables(controller, character);
    EXPECT_EQ(std::memcmp(tables.words.data(), &tables.layout, sizeof(tables.layout)), 0);
    EXPECT_EQ(tables.layout.clip_count, 3u);
    EXPECT_EQ(tables.layout.layer_count, 2u);
    EXPECT_EQ(tables.layout.parameter_count, 3u);
    EXPECT_EQ(tables.initial_parameters, (std::vector<float>{0.5f, 0, 0}));
    EXPECT_EQ(tables.masks.size(), 12u);
    EXPECT_EQ(tables.active_clip_limit, 1u + 3 * 3 + 3);
    EXPECT_EQ(tables.initial_layers[1].mask, 1u);
    EXPECT_EQ(tables.initial_layers[1].weight, 0.75f);

    const auto clip = [&](uint32_t i) { return read<io::ControlClip>(tables, tables.layout.clips, i); };
    EXPECT_EQ(clip(1).rate, 0.5f);
    EXPECT_EQ(clip(0).event_count, 0u);
    ASSERT_EQ(clip(1).event_count, 2u);
    EXPECT_EQ(clip(3).rate, 0) << "the rest pose";
    const auto event = read<io::ControlEvent>(tables, tables.layout.events, clip(1).first_event);
    EXPECT_EQ(event.event, 2u);
    EXPECT_EQ(event.phase, 0x40000000u);
    EXPECT_EQ(read<io::ControlEvent>(tables, tables.layout.events, clip(2).first_event).phase, io::kLastPhase);

    const auto state = [&](uint32_t i) { return read<io::ControlState>(tables, tables.layout.states, i); };
    EXPECT_EQ(state(0).sync, state(2).sync);
    EXPECT_EQ(state(1).sync, kNone);
    EXPECT_EQ(read<io::ControlPoint>(tables, tables.layout.points, state(1).first_point).inverse_span, 0.25f);
    EXPECT_EQ(read<io::ControlPoint>(tables, tables.layout.points, state(1).first_point + 1).inverse_span, 0);
    EXPECT_EQ(state(2).triangle_count, 1u);
    EXPECT_EQ(state(2).edge_count, 3u);
    const auto transition = [&](uint32_t i) {
        return read<io::ControlTransition>(tables, tables.layout.transitions, i);
    };
    ASSERT_EQ(state(0).transition_count, 1u) << "not from any to itself";
    const auto to_line = transition(state(0).first_transition);
    EXPECT_EQ(to_line.to, 1u);
    EXPECT_EQ(to_line.exit_loops, 1u);
    EXPECT_EQ(to_line.exit_phase, 0x7FFFFFFFu);
    EXPECT_EQ(to_line.flags, io::kTransitionInterrupts);
    ASSERT_EQ(state(2).transition_count, 1u);
    const auto to_one = transition(state(2).first_transition);
    EXPECT_EQ(to_one.fade_rate, 4);
    EXPECT_EQ(read<io::ControlCondition>(tables, tables.layout.conditions, to_one.first_condition).parameter, 2u);

    controller.layers[0].states[0].points[0].clip = "nobody's";
    EXPECT_THROW(make_controller_tables(controller, character), Failure);
}

}  // namespace
}  // namespace throng
