// Movement on the ground: the algebra, and that loops and steps add up.
#include "control/root_motion_reference.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace throng {
namespace {

using namespace test;

constexpr uint32_t kHalf = 0x80000000u;

// A quarter turn to the right and two metres ahead per cycle, along an arc of 5 rows.
std::vector<std::array<float, 4>> arc() {
    std::vector<std::array<float, 4>> rows;
    for (int i = 0; i <= 4; ++i) {
        const double yaw = -i * 3.14159265358979 / 8, radius = 2;
        rows.push_back({static_cast<float>(radius * (std::cos(yaw) - 1)), static_cast<float>(-radius * std::sin(yaw)),
                        static_cast<float>(std::cos(yaw)), static_cast<float>(std::sin(yaw))});
    }
    return rows;
}

void expect_same(const GroundMove& got, const GroundMove& wanted, double tolerance = 1e-6) {
    EXPECT_NEAR(got.x, wanted.x, tolerance);
    EXPECT_NEAR(got.z, wanted.z, tolerance);
    EXPECT_NEAR(got.cos, wanted.cos, tolerance);
    EXPECT_NEAR(got.sin, wanted.sin, tolerance);
}

TEST(RootMotion, MovesCompose) {
    const GroundMove turn{.x = 1, .z = 2, .cos = 0, .sin = 1};  // (0, 0, 1) comes to x
    expect_same(turn * GroundMove{.z = 3}, {.x = 4, .z = 2, .cos = 0, .sin = 1});
    expect_same(turn * inverse(turn), {});
    expect_same(inverse(turn) * turn, {});
    expect_same(power(turn, 4), {});
    expect_same(power(turn, 5), turn);
    expect_same(power(turn, -3), inverse(turn * turn * turn));
    expect_same(power(GroundMove{.x = 1e-3}, 1'000'000'000), {.x = 1e6}, 1e-3);
    expect_same(turned_to_length_one({.x = 5, .cos = 0, .sin = 0}), {.x = 5});
}

TEST(RootMotion, IsExactOverLoops) {
    const auto rows = arc();
    expect_same(move_between(rows, 0, 0, 4), {});
    expect_same(move_between(rows, 0, 0, 400'001), move_between(rows, 0, 0, 1), 1e-3);
    expect_same(move_between(rows, 123, 123, 0), {});
    expect_same(move_between(rows, 0, kHalf, 0), place_at(rows, kHalf));
    expect_same(move_between({}, 5, 7, 3), {});
    Random random(3);
    for (int round = 0; round < 1000; ++round) {
        const auto phase = [&] { return static_cast<uint32_t>(random.next()); };
        const auto loops = [&] { return static_cast<int64_t>(random.below(20)) - 10; };
        const uint32_t a = phase(), b = phase(), c = phase();
        const int64_t ab = loops(), bc = loops();
        expect_same(move_between(rows, a, b, ab) * move_between(rows, b, c, bc), move_between(rows, a, c, ab + bc),
                    1e-5);
        expect_same(inverse(move_between(rows, a, b, ab)), move_between(rows, b, a, -ab), 1e-5);
    }
}

}  // namespace
}  // namespace throng
