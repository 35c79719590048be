// A square to draw, and functions that read the pictures.
#pragma once

#include "tests/crowd_cases.h"
#include "tests/test_rig.h"

#include <throng/draw.h>

#include <vector>

namespace throng::test {

inline constexpr uint32_t kDrawWidth = 64, kDrawHeight = 48;

// A red square of side 1 in the plane z = 0 that faces +z and stands on the ground, with one joint; its clip moves it
// to x = 1 at 1 s.
Asset square();

Affine placed(const Trs<float>& placement);
Affine turned();  // by half a turn
Affine mirrored();

// One unit of the plane z = 0 is 14 pixels, x = 0 is in the middle.
inline constexpr Camera kFront{.eye = {0, 0.5f, 5}, .target = {0, 0.5f, 0}, .vertical_field_of_view_rad = 0.7f};

// Shaders, if the device has any. On native devices the same tests check the native renderer.
DrawPath device_path();

// A renderer of kDrawWidth x kDrawHeight pixels, created once per sample count: creating its pipelines takes longer
// than drawing a small picture.
Renderer& shared_renderer(uint32_t samples, const DrawOptions& options = {});

// Three instances that play the clip, the last far away.
Crowd crowd_of(const Character& character, const CrowdSettings& settings = {});

// A picture of a crowd of `asset`, with one instance per placement, seen by `camera`.
Picture pictured(const Asset& asset, const std::vector<Affine>& placements, const Camera& camera,
                 const DrawOptions& options, const CrowdSettings& settings = {});

struct Pixel {
    int r, g, b;
};
Pixel seen_at(const Picture& picture, const Camera& camera, const Vec3<double>& point);
// The pixel in which kFront sees the point (x, y) of the plane z = 0.
Pixel at(const Picture& picture, double x, double y);
int sum_of(const Pixel& pixel);
bool is_red(const Pixel& pixel);
bool is_green(const Pixel& pixel);
bool is_blue(const Pixel& pixel);
bool is_pale(const Pixel& pixel);  // ground, sky or white

double linear(double srgb);    // 0..1 both
double encoded(double light);  // 0..255, as pictures have it

}  // namespace throng::test
