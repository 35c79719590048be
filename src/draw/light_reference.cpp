#include "draw/light_reference.h"

#include "gpu/glsl.h"

namespace throng {
namespace io {
namespace {

// The shaders' own source, compiled as C++.
struct LightText {
    using Real = double;
    using Whole = int;
    using Mask = bool;
    using vec2 = Vector2<Real>;
    using vec3 = Vector3<Real>;
    using vec4 = Vector4<Real>;

    const DrawScene& scene;
    const MapHeights& height_at;

    template <class V>
    static vec3 xyz(const V& v) {
        return {v.x, v.y, v.z};
    }
    static Vec3<double> of(const vec3& v) { return {v.x, v.y, v.z}; }
    vec4 heights_at(int column, int row) const {
        const auto at = [&](int i) {
            return height_at(clamp(column + i, 0, static_cast<int>(scene.shadow.x) - 1), row);
        };
        return {at(0), at(1), at(2), at(3)};
    }
    static bool has_heights(int, int) { return true; }

#include "draw/ground_model.glsl"
#include "draw/light_model.glsl"
#include "draw/material_model.glsl"
#include "draw/sun_model.glsl"
};

LightText text_of(const DrawScene& scene, const MapHeights& heights = nullptr) { return {scene, heights}; }

}  // namespace
}  // namespace io

Vec3<double> reflected_light_reference(const io::DrawScene& scene, const LitSurface& surface, double sun) {
    io::LightText text = io::text_of(scene);
    const Vec3<double> to_eye = normalized(Vec3<double>{scene.eye.x, scene.eye.y, scene.eye.z} - surface.place);
    return text.of(text.reflected_light({.albedo = text.xyz(surface.albedo),
                                         .metallic = surface.metallic,
                                         .roughness = surface.roughness,
                                         .normal = text.xyz(surface.normal),
                                         .occlusion = surface.occlusion,
                                         .emissive = text.xyz(surface.emissive)},
                                        text.xyz(to_eye), sun));
}

Vec3<double> pictured_reference(const io::DrawScene& scene, const Vec3<double>& place, const Vec3<double>& light) {
    io::LightText text = io::text_of(scene);
    return text.of(text.tone_mapped(text.through_fog(text.xyz(light), text.xyz(place))));
}

double sun_reference(const io::DrawScene& scene, const MapHeights& heights, const Vec3<double>& place,
                     const Vec3<double>& normal) {
    io::LightText text = io::text_of(scene, heights);
    return text.sun_at(text.xyz(place), text.xyz(normal));
}

Vec3<double> background_reference(const io::DrawScene& scene, const MapHeights& heights, const Vec3<double>& ray,
                                  const Vec3<double>& beside, const Vec3<double>& below) {
    io::LightText text = io::text_of(scene, heights);
    const auto position = [&](const Vec3<double>& of) { return text.ground_position(text.ground_point(text.xyz(of))); };
    using io::abs;
    const io::LightText::vec2 at = position(ray);
    return text.of(text.background(text.xyz(ray), abs(position(beside) - at) + abs(position(below) - at)));
}

Vec3<double> character_reference(const io::DrawScene& scene, const MapHeights& heights, const LitSurface& surface,
                                 bool is_front, const MapsReference& maps) {
    io::LightText text = io::text_of(scene, heights);
    const auto vec2 = [](const std::array<double, 2>& v) { return io::LightText::vec2(v[0], v[1]); };
    const io::LightText::vec3 world = text.xyz(surface.place), normal = text.xyz(surface.normal);
    const io::LightText::Surface plain = text.plain_surface(text.xyz(surface.albedo), surface.metallic,
                                                            surface.roughness, text.xyz(surface.emissive), world,
                                                            normal, surface.size);
    const io::LightText::MapTexels texels{maps.metallic, maps.roughness, text.xyz(maps.normal), maps.occlusion,
                                          text.xyz(maps.emissive)};
    const io::LightText::PixelSteps steps{text.xyz(maps.place_x), text.xyz(maps.place_y), vec2(maps.texcoord_x),
                                          vec2(maps.texcoord_y)};
    return text.of(
        text.pictured_surface(text.mapped_surface(plain, texels, maps.normal_scale, maps.occlusion_strength, steps),
                              world, normal, is_front));
}

}  // namespace throng
