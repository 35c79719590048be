#include "draw/scene.h"

#include "draw/pipeline.h"
#include "draw/shadow_map.h"

#include <algorithm>

namespace throng {
namespace {

constexpr Access kSceneRead{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                            VK_ACCESS_2_UNIFORM_READ_BIT};

io::vec4 to_vec4(const Vec3<float>& v, float w = 0) { return {v.x, v.y, v.z, w}; }

}  // namespace

io::DrawScene make_scene(const CrowdBounds& crowds, const Camera& camera, const VkExtent2D& picture, uint32_t map_size,
                         const DrawOptions& options) {
    const auto width = static_cast<float>(picture.width), height = static_cast<float>(picture.height);
    const View view = make_view(camera, width / height);
    const Bounds& bounds = crowds.rest;
    const Vec3<float> centre = (bounds.min + bounds.max) * 0.5f, to_sun = direction_to_sun(options);
    const float farthest = std::max(length(camera.eye - centre) + length(bounds.max - bounds.min) / 2, 1e-6f);
    const ShadowFit shadow = fit_shadow(camera, view, crowds.posed, to_sun, map_size);

    io::DrawScene scene{};
    const auto set_rows = [](auto& rows, const auto& from) {
        std::ranges::transform(from, rows, [](const auto& row) { return io::vec4{row[0], row[1], row[2], row[3]}; });
    };
    set_rows(scene.clip_from_world, view.clip_from_world);
    set_rows(scene.map_from_world, shadow.map_from_world);
    scene.eye = to_vec4(camera.eye, options.exposure);
    scene.forward = to_vec4(view.forward);
    scene.right = to_vec4(view.right * view.half_width);
    scene.down = to_vec4(view.up * -view.half_height);
    scene.to_sun = to_vec4(to_sun);
    scene.ground = {centre.x, crowds.ground, centre.z, crowds.size};
    constexpr float kFog = 0.1f;  // the part of the farthest character's light that fog replaces
    scene.fog = {options.fog ? std::sqrt(-std::log(1 - kFog)) / farthest : 0, 0, 0, 0};
    scene.picture = {width, height, 0, 0};
    scene.shadow = {static_cast<float>(map_size), shadow.texel, options.shadows ? 1.0f : 0.0f, 0};
    scene.map_grid = {shadow.grid[0], shadow.grid[1], 0, 0};
    // A clear day, from a low red sun to a high one. The ground reflects the light of sun and sky that reaches it, less
    // what the characters on it block.
    const float day = std::clamp((to_sun.y - kLowestSun) / 0.55f, 0.0f, 1.0f);
    const auto by_day = [&](const Vec3<float>& low, const Vec3<float>& high) { return low + (high - low) * day; };
    const Vec3<float> sun_light = by_day({1.3f, 0.7f, 0.36f}, {1.25f, 1.12f, 0.93f}),
                      sky_light = by_day({0.28f, 0.3f, 0.4f}, {0.34f, 0.42f, 0.55f}), albedo{0.31f, 0.29f, 0.235f};
    const Vec3<float> arrives = sun_light * to_sun.y + sky_light;
    constexpr float kOpen = 0.6f;
    scene.sun_light = to_vec4(sun_light);
    scene.sky_light = to_vec4(sky_light);
    scene.bounce_light = to_vec4(Vec3<float>{arrives.x * albedo.x, arrives.y * albedo.y, arrives.z * albedo.z} * kOpen);
    scene.horizon = to_vec4(by_day({0.86f, 0.66f, 0.5f}, {0.62f, 0.74f, 0.88f}));
    scene.zenith = to_vec4(by_day({0.16f, 0.25f, 0.48f}, {0.13f, 0.32f, 0.68f}));
    scene.ground_albedo = to_vec4(albedo);
    return scene;
}

SceneBinding::SceneBinding(const std::shared_ptr<Gpu>& gpu, const ShaderLayout& layout, const DepthPass& shadow_map)
    : gpu_(gpu), buffer_(gpu, "scene", sizeof(io::DrawScene), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT) {
    const VkDescriptorImageInfo shadows = shadow_map.texture();
    bindings_ = Bindings(gpu, "scene", layout.set(kSceneSet), {{io::kSceneBuffer, buffer_}}, {&shadows, 1});
}

void SceneBinding::record(VkCommandBuffer commands, const io::DrawScene& scene) const {
    memory_barrier(*gpu_, commands, kSceneRead, kTransferWrite);
    record_update(*gpu_, commands, buffer_, 0, std::span(&scene, 1));
    memory_barrier(*gpu_, commands, kTransferWrite, kSceneRead);
}

}  // namespace throng
