// The light of a picture in double precision (draw/light_model.glsl).
#pragma once

#include "draw/draw_io.h"

#include <throng/transform.h>

namespace throng {

// A point of a character, all maps applied.
struct LitSurface {
    Vec3<double> place, normal;  // world space, unit
    Vec3<double> albedo;         // linear
    double metallic = 0, roughness = 1;
    double occlusion = 1;  // the part of the ambient light that arrives
    Vec3<double> emissive;
};

// The light that leaves it towards the scene's eye; `sun` is the part of the sun that arrives.
Vec3<double> reflected_light_reference(const io::DrawScene& scene, const LitSurface& surface, double sun);
// What of it arrives, as the picture has it: through fog, tone-mapped, linear.
Vec3<double> pictured_reference(const io::DrawScene& scene, const Vec3<double>& place, const Vec3<double>& light);

}  // namespace throng
