#include "draw/light_reference.h"

#include <algorithm>
#include <numbers>

namespace throng {
namespace {

Vec3<double> of(const io::vec4& v) { return {v.x, v.y, v.z}; }
Vec3<double> times(const Vec3<double>& a, const Vec3<double>& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
Vec3<double> mixed(const Vec3<double>& a, const Vec3<double>& b, double part) { return a * (1 - part) + b * part; }
Vec3<double> all(double x) { return {x, x, x}; }

Vec3<double> sky(const io::DrawScene& scene, const Vec3<double>& direction) {
    const double glow = std::pow(std::max(dot(direction, of(scene.to_sun)), 0.0), 8);
    return mixed(of(scene.horizon), of(scene.zenith), std::sqrt(std::max(direction.y, 0.0))) +
           of(scene.sun_light) * (0.12 * glow);
}

Vec3<double> ambient(const io::DrawScene& scene, const Vec3<double>& normal) {
    return mixed(of(scene.bounce_light), of(scene.sky_light), 0.5 + 0.5 * normal.y);
}

double smooth_step(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace

Vec3<double> reflected_light_reference(const io::DrawScene& scene, const LitSurface& surface, double sun) {
    const Vec3<double>&normal = surface.normal, to_sun = of(scene.to_sun),
          to_eye = normalized(of(scene.eye) - surface.place), half_way = normalized(to_eye + to_sun);
    const double roughness = std::clamp(surface.roughness, 0.089, 1.0), alpha = roughness * roughness,
                 alpha2 = alpha * alpha;
    const double n_v = std::max(std::abs(dot(normal, to_eye)), 1e-4), n_l = std::max(dot(normal, to_sun), 0.0),
                 n_h = std::max(dot(normal, half_way), 0.0), v_h = std::max(dot(to_eye, half_way), 0.0);
    const Vec3<double> diffuse = surface.albedo * (1 - surface.metallic),
                       f0 = mixed(all(0.04), surface.albedo, surface.metallic);

    // The sun: Lambert below, and above it a GGX distribution of facets, each shadowing the others (Smith,
    // height-correlated) and reflecting by Schlick's approximation.
    const double distribution = alpha2 / (std::numbers::pi * std::pow(n_h * n_h * (alpha2 - 1) + 1, 2));
    const double visibility = 0.5 / std::max(n_l * std::sqrt(n_v * n_v * (1 - alpha2) + alpha2) +
                                                 n_v * std::sqrt(n_l * n_l * (1 - alpha2) + alpha2),
                                             1e-4);
    const Vec3<double> fresnel = f0 + (all(1) - f0) * std::pow(1 - v_h, 5);
    const Vec3<double> from_sun = times(times(diffuse, all(1) - fresnel) +
                                            fresnel * (std::numbers::pi * distribution * visibility),
                                        of(scene.sun_light)) *
                                  (n_l * sun);

    // All around: what the mirrored ray meets, the rougher the more like all that is around it; and how much of that a
    // rough surface reflects (Karis's fit).
    const double r[4] = {1 - roughness, 0.0425 - 0.0275 * roughness, 1.04 - 0.572 * roughness,
                         -0.04 + 0.022 * roughness};
    const double grazing = std::min(r[0] * r[0], std::exp2(-9.28 * n_v)) * r[0] + r[1];
    const Vec3<double> mirrored = normal * (2 * dot(normal, to_eye)) - to_eye;
    const Vec3<double> met = mixed(of(scene.bounce_light), sky(scene, mirrored), smooth_step(-0.1, 0.1, mirrored.y));
    const Vec3<double> reflected = times(mixed(met, ambient(scene, mirrored), roughness),
                                         f0 * (r[2] - 1.04 * grazing) + all(1.04 * grazing + r[3]));
    return from_sun + (times(diffuse, ambient(scene, normal)) + reflected) * surface.occlusion + surface.emissive;
}

Vec3<double> pictured_reference(const io::DrawScene& scene, const Vec3<double>& place, const Vec3<double>& light) {
    const Vec3<double> way = place - of(scene.eye);
    const Vec3<double> seen = mixed(sky(scene, normalized(Vec3<double>{way.x + 1e-10, 0, way.z})), light,
                                    std::exp(-std::pow(scene.fog.x * length(way), 2))) *
                              double{scene.eye.w};
    // The Khronos PBR Neutral tone mapper.
    constexpr double kStart = 0.8 - 0.04, kRoom = 1 - kStart;
    const double least = std::min({seen.x, seen.y, seen.z});
    const Vec3<double> color = seen - all(least < 0.08 ? least - 6.25 * least * least : 0.04);
    const double peak = std::max({color.x, color.y, color.z});
    if (peak < kStart) return color;
    const double lower_peak = 1 - kRoom * kRoom / (peak + kRoom - kStart);
    return mixed(color * (lower_peak / peak), all(lower_peak), 1 - 1 / (0.15 * (peak - lower_peak) + 1));
}

}  // namespace throng
