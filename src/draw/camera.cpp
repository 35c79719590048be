#include "draw/camera.h"

#include "base/failure.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace throng {
namespace {

struct Axes {
    Vec3<float> right, up, forward;
};

Axes look_along(const Vec3<float>& direction) {
    const Vec3<float> forward = normalized(direction);
    const bool vertical = std::abs(forward.y) > 0.9999f;
    const Vec3<float> right = normalized(cross(forward, vertical ? Vec3<float>{0, 0, -1} : Vec3<float>{0, 1, 0}));
    return {right, cross(right, forward), forward};
}

}  // namespace

View make_view(const Camera& camera, float aspect_ratio) {
    const Vec3<float> direction = camera.target - camera.eye;
    const float distance = length(direction);
    if (!(distance > 0) || !std::isfinite(distance) || !std::isfinite(length(camera.eye)))
        throw Failure(ErrorCode::kInvalidArgument, "camera", "eye and target must be finite and must differ");
    if (!(camera.vertical_field_of_view_rad > 0 && camera.vertical_field_of_view_rad < std::numbers::pi_v<float>))
        throw Failure(ErrorCode::kInvalidArgument, "camera", "vertical_field_of_view_rad must be above 0 and below pi");
    const Axes axes = look_along(direction);
    View view{axes.right, axes.up, axes.forward};
    view.half_height = std::tan(camera.vertical_field_of_view_rad / 2);
    view.half_width = view.half_height * aspect_ratio;
    // Reversed float depths are equally precise for any near plane. So the near plane may be closer than anything to be
    // seen, even where the target is a mountain.
    constexpr float kNear = 2e-5f;
    const float near = distance * kNear;
    const auto row = [&](const Vec3<float>& axis) {
        return std::array<float, 4>{axis.x, axis.y, axis.z, -dot(axis, camera.eye)};
    };
    view.clip_from_world = {row(axes.right * (1 / view.half_width)),
                            row(axes.up * (-1 / view.half_height)),
                            {0, 0, 0, near},
                            row(axes.forward)};
    return view;
}

const DrawOptions& checked(const DrawOptions& options) {
    if (!(options.exposure > 0 && std::isfinite(options.exposure)))
        throw Failure(ErrorCode::kInvalidArgument, "draw options", "exposure must be finite and above 0");
    if (!(options.lod_pixels > 0 && std::isfinite(options.lod_pixels)))
        throw Failure(ErrorCode::kInvalidArgument, "draw options", "lod_pixels must be finite and above 0");
    if (!(options.full_rate_pixels >= 0 && options.full_rate_pixels <= 1e30f) || !(options.budget_ms >= 0))
        throw Failure(ErrorCode::kInvalidArgument, "draw options",
                      "full_rate_pixels must be from 0 to 1e30, and budget_ms must not be negative");
    if (!(options.shared_pose_pixels >= 0))
        throw Failure(ErrorCode::kInvalidArgument, "draw options", "shared_pose_pixels must not be negative");
    const float height = normalized(options.to_sun).y;
    if (!(height >= kLowestSun))
        throw Failure(
            ErrorCode::kInvalidArgument, "draw options",
            "to_sun must be finite and point above the horizon: its y must be at least a twentieth of its length");
    return options;
}

CrowdView crowd_view_of(const Camera& camera, uint32_t width, uint32_t height, const Bounds& bounds, float highest,
                        const DrawOptions& options) {
    if (width == 0 || height == 0)
        throw Failure(ErrorCode::kInvalidArgument, "view",
                      "the picture is empty: " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    const View view = make_view(camera, static_cast<float>(width) / static_cast<float>(height));
    const Vec3<float> to_sun = direction_to_sun(options);
    constexpr float kHighest = 2;  // above bounds.min.y, in heights of the crowd at rest
    // How far CrowdView::ground lies below bounds.min.y, in the same unit: rest poses may float above the floor that
    // clips walk on
    constexpr float kDeepest = 0.25f;
    const float extent = bounds.max.y - bounds.min.y,
                above = std::max(kHighest * extent, highest - bounds.min.y + kDeepest * extent),
                reach = options.shadows ? above / to_sun.y : 0;
    return {.clip_from_world = view.clip_from_world,
            .eye = camera.eye,
            .pixels = static_cast<float>(height) / (2 * view.half_height),
            .lod_pixels = options.lod_pixels,
            .shadow = to_sun * -reach,
            .ground = bounds.min.y - kDeepest * extent,
            .full_rate_pixels = options.full_rate_pixels,
            .budget_ms = options.budget_ms,
            .shared_pose_pixels = options.shared_pose_pixels};
}

Result<CrowdView> view_of(const Camera& camera, uint32_t width, uint32_t height, const Bounds& bounds,
                          const DrawOptions& options) {
    return as_result([&] { return crowd_view_of(camera, width, height, bounds, bounds.max.y, checked(options)); });
}

// Both fits below take the corners of the bounds in the camera's axes, relative to the centre of the bounds: `side`
// along one axis of the picture, and `forward`. An eye at distance `back` behind the centre, moved by `shift` along
// that axis, sees a corner at (side - shift) / (forward + back). The corner is in the picture if the absolute value of
// that is at most half_extent.
namespace {

struct Corner {
    float side, forward;
};
using Corners = std::array<Corner, 8>;

// The least `back` for which some shift has all corners in the picture: the two extreme half-planes, met with equality.
float fit_back(const Corners& corners, float half_extent) {
    float low = -std::numeric_limits<float>::infinity(), high = low;
    for (const Corner& c : corners) {
        high = std::max(high, c.side - half_extent * c.forward);
        low = std::max(low, -c.side - half_extent * c.forward);
    }
    return (low + high) / (2 * half_extent);
}

// The shift that leaves the same margin on both sides of the picture, by bisection: both margins are monotonic in it.
float centre_shift(const Corners& corners, float back) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const Corner& c : corners) {
        low = std::min(low, c.side);
        high = std::max(high, c.side);
    }
    for (int step = 0; step < 40; ++step) {
        const float shift = (low + high) / 2;
        float least = std::numeric_limits<float>::infinity(), most = -least;
        for (const Corner& c : corners) {
            least = std::min(least, (c.side - shift) / (c.forward + back));
            most = std::max(most, (c.side - shift) / (c.forward + back));
        }
        (least + most > 0 ? low : high) = shift;
    }
    return (low + high) / 2;
}

}  // namespace

Camera fit_camera(const Bounds& bounds, float aspect_ratio) {
    const Vec3<float> extent = bounds.max - bounds.min, centre = (bounds.min + bounds.max) * 0.5f;
    const float width = std::max(extent.x, extent.z), flatness = width / std::max({extent.y, width * 1e-3f, 1e-30f});
    // 0 for one character, 1 for a crowd much wider than high
    const float crowd = std::clamp((flatness - 2) / 6, 0.0f, 1.0f);
    // 1 for a crowd so wide that, shown whole, it would be a distant carpet
    const float vast = std::clamp((flatness - 25) / 50, 0.0f, 1.0f);
    const float elevation_rad = 0.17f + crowd * 0.25f - vast * 0.12f, yaw_rad = 0.5f - crowd * 0.25f;
    // Only this part of a vast crowd's width and depth is fitted: its corners may lie outside the picture.
    const float kept = 1 - 0.6f * vast;
    constexpr float kMargin = 1.06f;

    Camera camera;
    const Vec3<float> to_eye{std::cos(elevation_rad) * std::sin(yaw_rad), std::sin(elevation_rad),
                             std::cos(elevation_rad) * std::cos(yaw_rad)};
    const Axes axes = look_along(to_eye * -1.0f);
    const float half_height = std::tan(camera.vertical_field_of_view_rad / 2) / kMargin,
                half_width = half_height * aspect_ratio;
    Corners across{}, upward{};
    float nearest = 0;
    for (size_t i = 0; i < across.size(); ++i) {
        const Vec3<float> p{(i & 1 ? 0.5f : -0.5f) * extent.x * kept, (i & 2 ? 0.5f : -0.5f) * extent.y,
                            (i & 4 ? 0.5f : -0.5f) * extent.z * kept};
        const float forward = dot(p, axes.forward);
        across[i] = {dot(p, axes.right), forward};
        upward[i] = {dot(p, axes.up), forward};
        nearest = std::min(nearest, forward);
    }
    const float least = std::max(length(extent), 1.0f) * 1e-3f;  // where the bounds have no extent to fit
    const float back = std::max({fit_back(across, half_width), fit_back(upward, half_height), least - nearest});
    camera.eye = centre + axes.right * centre_shift(across, back) + axes.up * centre_shift(upward, back) -
                 axes.forward * back;
    camera.target = camera.eye + axes.forward * back;
    return camera;
}

}  // namespace throng
