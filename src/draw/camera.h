// A camera as the shaders take it.
#pragma once

#include <throng/draw.h>

#include <array>

namespace throng {

// What a camera sees through a picture of some aspect ratio. Depth is reversed and has no far plane: 1 at the near
// plane, 0 infinitely far, so that one setting serves a hand and a landscape.
struct View {
    Vec3<float> right, up, forward;         // unit, world space
    float half_width = 1, half_height = 1;  // of the picture, at distance 1
    std::array<std::array<float, 4>, 4> clip_from_world{};
};

// Throws kInvalidArgument if the camera is invalid.
View make_view(const Camera& camera, float aspect_ratio);

// As view_of() of throng/draw.h. `highest`: the greatest y of anything that casts a shadow, as far as it is known
// (CrowdBounds::posed, or else bounds). Throws kInvalidArgument if the camera is invalid.
CrowdView crowd_view_of(const Camera& camera, uint32_t width, uint32_t height, const Bounds& bounds, float highest,
                        const DrawOptions& options);

// Throws kInvalidArgument if they are invalid.
const DrawOptions& checked(const DrawOptions& options);

inline constexpr float kLowestSun = 0.05f;  // the sine of the sun's angle above the horizon

// Unit, world space.
inline Vec3<float> direction_to_sun(const DrawOptions& options) { return normalized(options.to_sun); }

}  // namespace throng
