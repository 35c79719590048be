#include "draw/light_reference.h"

#include "gpu/glsl.h"

namespace throng {
namespace io {
namespace {

// The shaders' own text.
struct LightText {
    using Real = double;
    using vec3 = Vector3<Real>;
    using vec4 = Vector4<Real>;

    const DrawScene& scene;

    template <class V>
    static vec3 xyz(const V& v) {
        return {v.x, v.y, v.z};
    }
    static Vec3<double> of(const vec3& v) { return {v.x, v.y, v.z}; }

#include "draw/light_model.glsl"
};

}  // namespace
}  // namespace io

Vec3<double> reflected_light_reference(const io::DrawScene& scene, const LitSurface& surface, double sun) {
    io::LightText text{scene};
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
    io::LightText text{scene};
    return text.of(text.tone_mapped(text.through_fog(text.xyz(light), text.xyz(place))));
}

}  // namespace throng
