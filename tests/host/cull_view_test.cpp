// The planes of a view match its projection, for every kind of projection.
#include "crowd/cull_stage.h"
#include "tests/test_rig.h"

#include <throng/view.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace throng::test {
namespace {

enum class Projection { kPerspective, kOrthographic, kReversedInfinite };

// Which limit of the view a point exceeds.
enum class Beyond { kNothing, kLeft, kRight, kBottom, kTop, kNear, kFar };

constexpr double kHalfWidth = 0.8, kHalfHeight = 0.5;  // of the picture, at distance 1
constexpr double kNearest = 0.5, kFarthest = 90;       // distances of points that are seen

// A random camera, and the projection of a point to its right, above it and in front of it.
struct ProjectingCamera {
    Projection projection;
    Vec3<double> eye, right, up, forward;

    ProjectingCamera(Projection of, Random& random)
        : projection(of), eye(random.vector(20)), right(random.direction()), up(), forward() {
        forward = normalized(cross(right, random.direction()));
        up = cross(right, forward);
    }
    double width_at(double depth) const { return projection == Projection::kOrthographic ? 1 : depth; }
    Vec3<double> world(double across, double upward, double depth) const {
        const double width = width_at(depth);
        return eye + right * (across * kHalfWidth * width) + up * (upward * kHalfHeight * width) + forward * depth;
    }
    CrowdView view() const {
        CrowdView made{.eye = eye.as<float>()};
        const auto set = [&](size_t row, const Vec3<double>& axis, double constant) {
            made.clip_from_world[row] = {static_cast<float>(axis.x), static_cast<float>(axis.y),
                                         static_cast<float>(axis.z), static_cast<float>(constant - dot(axis, eye))};
        };
        const bool is_flat = projection == Projection::kOrthographic;
        set(0, right * (1 / kHalfWidth), 0);
        set(1, up * (1 / kHalfHeight), 0);
        // Depth is 0 at the near and 1 at the far plane. Reversed, it is 1 at the near plane and 0 at infinity
        const double slope = (is_flat ? 1 : kFarthest) / (kFarthest - kNearest);
        if (projection == Projection::kReversedInfinite)
            set(2, {}, kNearest);
        else
            set(2, forward * slope, -slope * kNearest);
        set(3, is_flat ? Vec3<double>{} : forward, is_flat ? 1 : 0);
        return made;
    }
};

TEST(CullView, PlanesAreThoseOfTheProjection) {
    Random random(3);
    for (const Projection projection :
         {Projection::kPerspective, Projection::kOrthographic, Projection::kReversedInfinite})
        for (int round = 0; round < 200; ++round) {
            const ProjectingCamera camera(projection, random);
            const CrowdView view = camera.view();
            const io::CullView seen = cull_view_of(&view, 0);
            for (const Beyond beyond : {Beyond::kNothing, Beyond::kLeft, Beyond::kRight, Beyond::kBottom, Beyond::kTop,
                                        Beyond::kNear, Beyond::kFar}) {
                if (beyond == Beyond::kFar && projection == Projection::kReversedInfinite) continue;
                double across = random.between(-0.95, 0.95), upward = random.between(-0.95, 0.95),
                       depth = random.between(1.1 * kNearest, 0.95 * kFarthest);
                if (beyond == Beyond::kLeft) across = random.between(-3, -1.05);
                if (beyond == Beyond::kRight) across = random.between(1.05, 3);
                if (beyond == Beyond::kBottom) upward = random.between(-3, -1.05);
                if (beyond == Beyond::kTop) upward = random.between(1.05, 3);
                if (beyond == Beyond::kNear) depth = random.between(0.1 * kNearest, 0.9 * kNearest);
                if (beyond == Beyond::kFar) depth = random.between(1.05 * kFarthest, 3 * kFarthest);
                const Vec3<double> p = camera.world(across, upward, depth);
                int outside_count = 0;
                for (const io::vec4& plane : seen.planes)
                    outside_count += dot(Vec3<double>{plane.x, plane.y, plane.z}, p) + double{plane.w} < 0;
                EXPECT_EQ(outside_count, beyond == Beyond::kNothing ? 0 : 1)
                    << "projection " << static_cast<int>(projection) << ", beyond " << static_cast<int>(beyond);
            }
        }
}

TEST(CullView, SizesAreRelativeToTheAllowedPixels) {
    CrowdView view{.eye = {1, 2, 3},
                   .pixels = 600,
                   .lod_pixels = 2,
                   .shadow = {4, -5, 6},
                   .ground = -7,
                   .shared_pose_pixels = 0.5f};
    const io::CullView seen = cull_view_of(&view, 30);
    const auto parts = [](const io::vec4& v) { return std::array{v.x, v.y, v.z, v.w}; };
    EXPECT_EQ(parts(seen.eye), (std::array{1.0f, 2.0f, 3.0f, 300.0f}));
    EXPECT_EQ(parts(seen.shadow), (std::array{4.0f, -5.0f, 6.0f, 20.0f}));
    EXPECT_EQ(seen.ground, -7);
    EXPECT_EQ(seen.shared_pixels, 1200);
    EXPECT_EQ(cull_view_of(&view, 0).shadow.w, 0) << "all in every update";
    view.pixels = std::numeric_limits<float>::infinity();
    const io::CullView exact = cull_view_of(&view, 30);
    EXPECT_TRUE(std::isfinite(exact.eye.w) && exact.eye.w >= 1e30f);
    EXPECT_TRUE(std::isfinite(exact.shared_pixels) && exact.shared_pixels >= 1e30f);
}

}  // namespace
}  // namespace throng::test
