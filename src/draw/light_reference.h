// The light of a picture in double precision (draw/*_model.glsl).
#pragma once

#include "draw/draw_io.h"

#include <throng/transform.h>

#include <array>
#include <functional>

namespace throng {

// A point of a character.
struct LitSurface {
    Vec3<double> place, normal;  // world space, unit
    Vec3<double> albedo;         // linear
    double metallic = 0, roughness = 1;
    double occlusion = 1;  // the part of the ambient light that arrives
    Vec3<double> emissive;
    double size = 1;  // of the character, in the world
};

// The light that leaves it towards the scene's eye; `sun` is the part of the sun that arrives.
Vec3<double> reflected_light_reference(const io::DrawScene& scene, const LitSurface& surface, double sun);
// What the picture shows of that light: through fog, tone-mapped, linear.
Vec3<double> pictured_reference(const io::DrawScene& scene, const Vec3<double>& place, const Vec3<double>& light);

// Returns the height in a column and row of the shadow map.
using MapHeights = std::function<double(int column, int row)>;
// The part of the sun that arrives at a surface.
double sun_reference(const io::DrawScene& scene, const MapHeights& heights, const Vec3<double>& place,
                     const Vec3<double>& normal);
// The colour of a pixel where no character is. `ray`, `beside`, `below`: through the centres of this pixel and of the
// pixels beside and below it.
Vec3<double> background_reference(const io::DrawScene& scene, const MapHeights& heights, const Vec3<double>& ray,
                                  const Vec3<double>& beside, const Vec3<double>& below);

// The texels of a material's maps at a point, and how the point changes from its pixel to the next ones.
struct MapsReference {
    double metallic = 1, roughness = 1;
    Vec3<double> normal{1, 1, 1};  // as stored in the texel
    double occlusion = 1;
    Vec3<double> emissive{1, 1, 1};
    double normal_scale = 0;  // 0: there is no normal map
    double occlusion_strength = 0;
    Vec3<double> place_x{}, place_y{};  // steps to the right, and down
    std::array<double, 2> texcoord_x{}, texcoord_y{};
};
// The colour of a pixel of a character. `surface`: its front, without maps. Its occlusion is ignored, and computed from
// its place instead.
Vec3<double> character_reference(const io::DrawScene& scene, const MapHeights& heights, const LitSurface& surface,
                                 bool is_front, const MapsReference& maps = {});

}  // namespace throng
