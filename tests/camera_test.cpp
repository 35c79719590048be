// Cameras that fit a crowd into view, and what the shadow map covers of what they see.
#include "draw/camera.h"
#include "draw/shadow_map.h"
#include "tests/projection.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace throng {
namespace {

using test::project;

struct FitCase {
    Bounds bounds;
    float aspect_ratio;
};

TEST(FitCamera, HoldsAllCornersInViewAndFillsThePicture) {
    const FitCase cases[] = {
        {{{-0.5f, 0, -0.2f}, {0.5f, 1.8f, 0.2f}}, 16.0f / 9},  // a person
        {{{-0.5f, 0, -0.2f}, {0.5f, 1.8f, 0.2f}}, 0.5f},
        {{{-60, -10, -90}, {60, 80, 70}}, 1},               // a file in centimetres
        {{{-8, 0, -8}, {8, 1.8f, 8}}, 16.0f / 9},           // a hundred people
        {{{990, 0, -1008}, {1010, 1.8f, -992}}, 4.0f / 3},  // far from the origin
        {{{-0.01f, 0, -0.01f}, {0.01f, 0.02f, 0.01f}}, 2},
    };
    for (const auto& [bounds, aspect_ratio] : cases) {
        const Camera camera = fit_camera(bounds, aspect_ratio);
        EXPECT_GT(camera.eye.x, camera.target.x) << "from the right";
        EXPECT_GT(camera.eye.y, camera.target.y) << "from above";
        EXPECT_GT(camera.eye.z, camera.target.z) << "from the front";
        double widest = 0;
        for (int i = 0; i < 8; ++i) {
            const Vec3<double> corner{i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                                      i & 4 ? bounds.max.z : bounds.min.z};
            const Vec3<double> seen = project(camera, aspect_ratio, corner);
            EXPECT_GT(seen.z, 0);
            EXPECT_LT(std::abs(seen.x), 1);
            EXPECT_LT(std::abs(seen.y), 1);
            widest = std::max({widest, std::abs(seen.x), std::abs(seen.y)});
        }
        EXPECT_GT(widest, 0.9);
    }
}

TEST(FitCamera, FillsThePictureWithAVastCrowd) {
    const Bounds bounds{{-75, 0, -75}, {75, 1.8f, 75}};
    const Camera camera = fit_camera(bounds, 16.0f / 9);
    const Vec3<double> near = project(camera, 16.0 / 9, {0, 0, 75}), far = project(camera, 16.0 / 9, {0, 0, -75});
    EXPECT_LT(near.y, -0.7);
    EXPECT_GT(far.y, 0.3);
    EXPECT_LT(far.y, 1);
}

TEST(FitCamera, AcceptsBoundsOfASinglePoint) {
    const Camera camera = fit_camera({{1, 2, 3}, {1, 2, 3}}, 1);
    EXPECT_GT(length(camera.target - camera.eye), 0);
    const Vec3<double> seen = project(camera, 1, {1, 2, 3});
    EXPECT_NEAR(seen.x, 0, 1e-3);
    EXPECT_NEAR(seen.y, 0, 1e-3);
}

// When the camera moves, the shadow map's texels stay at the same world positions.
TEST(ShadowMap, MovesInWholeTexels) {
    const Bounds bounds{{-20, 0, -20}, {20, 2, 20}};
    const Vec3<float> sun = normalized(Vec3<float>{-0.45f, 0.85f, 0.5f});
    constexpr uint32_t kSize = 1024;
    const Vec3<float> point{3, 1, -2};
    const auto place_in = [&](const ShadowFit& fit, size_t row) {
        return double{
                   dot(Vec3<float>{fit.map_from_world[row][0], fit.map_from_world[row][1], fit.map_from_world[row][2]},
                       point) +
                   fit.map_from_world[row][3]} *
               kSize;
    };
    std::optional<ShadowFit> before;
    int compared = 0;
    for (int step = 0; step < 40; ++step) {
        const Camera camera{.eye = {0.07f * static_cast<float>(step), 3, 12},
                            .target = {0.02f * static_cast<float>(step), 0, 0}};
        const ShadowFit fit = fit_shadow(camera, make_view(camera, 1.5f), bounds, sun, kSize);
        for (size_t row = 0; row < 2; ++row) {
            EXPECT_GT(place_in(fit, row), 2);
            EXPECT_LT(place_in(fit, row), kSize - 2);
            if (!before || before->map_from_world[row][0] != fit.map_from_world[row][0]) continue;
            const double moved = place_in(fit, row) - place_in(*before, row);
            EXPECT_NEAR(moved, std::round(moved), 0.01);
            EXPECT_NEAR(std::remainder(moved + fit.grid[row] - before->grid[row], 65536), 0, 0.01) << "same texel";
            ++compared;
        }
        before = fit;
    }
    EXPECT_GT(compared, 60) << "the size of a texel seldom changes";
}

TEST(ShadowMap, AxesAreAtRightAnglesUnderAnySun) {
    const Camera camera{.eye = {0, 3, 12}, .target = {0, 0, 0}};
    for (const Vec3<float> to_sun : {Vec3<float>{0, 1, 0}, Vec3<float>{0.014f, 1, 0}, Vec3<float>{0.01f, 1, -0.009f},
                                     Vec3<float>{0, 1, 0.2f}, Vec3<float>{-0.9f, 0.1f, 0.3f}}) {
        const ShadowFit fit = fit_shadow(camera, make_view(camera, 1), {{-3, 0, -3}, {3, 2, 3}}, normalized(to_sun),
                                         512);
        std::array<Vec3<double>, 3> axes;
        for (size_t k = 0; k < 3; ++k) {
            const auto& row = fit.map_from_world[k];
            axes[k] = normalized(Vec3<double>{row[0], row[1], row[2]});
        }
        EXPECT_NEAR(dot(axes[0], axes[1]), 0, 1e-6);
        EXPECT_NEAR(dot(axes[0], axes[2]), 0, 1e-6);
        EXPECT_NEAR(dot(axes[1], axes[2]), 0, 1e-6);
    }
}

// A game's camera aims at what the crosshair hits, a kilometre away; its own hands must still be visible.
TEST(View, NearObjectsAreVisibleAtAnyTargetDistance) {
    for (const float distance : {0.1f, 5.0f, 1000.0f}) {
        const View view = make_view({.eye = {1, 2, 3}, .target = {1, 2, 3 - distance}}, 1.5f);
        const Vec3<float> close{1, 2, 3 - 1e-4f * distance};
        const auto along = [&](size_t row) {
            const auto& of = view.clip_from_world[row];
            return of[0] * close.x + of[1] * close.y + of[2] * close.z + of[3];
        };
        EXPECT_LE(along(2), along(3)) << distance;
        EXPECT_GT(along(2), 0) << distance;
    }
}

TEST(View, ShadowReachFollowsTheHighestPoint) {
    const Camera camera{.eye = {0, 1, 5}, .target = {0, 1, 0}};
    const DrawOptions options{.to_sun = {0, 0.6f, 0.8f}};
    const Bounds at_rest{{-1, 0.5f, -1}, {1, 1, 1}};
    const auto reach_below = [&](float highest) {
        return -crowd_view_of(camera, 64, 64, at_rest, highest, options).shadow.y;
    };
    EXPECT_NEAR(reach_below(1), 1, 1e-5) << "twice the height at rest";
    EXPECT_NEAR(reach_below(20.5f), 20.125, 1e-4) << "of a clip that flies, down to below the rest poses";
}

}  // namespace
}  // namespace throng
