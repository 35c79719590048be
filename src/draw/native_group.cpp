#include "draw/native_group.h"

#include "draw/joint_levels.h"

#include <algorithm>

namespace throng {
namespace {

static_assert(raster::Wrap(TextureWrap::kRepeat) == raster::Wrap::kRepeat &&
              raster::Wrap(TextureWrap::kClamp) == raster::Wrap::kClamp &&
              raster::Wrap(TextureWrap::kMirror) == raster::Wrap::kMirror);

raster::Material to_raster(const TexturedMaterial<raster::OwnedTexture>& material) {
    const AssetMaterial& f = material.factors;
    raster::Material to{.metallic = f.metallic,
                        .roughness = f.roughness,
                        .normal_scale = f.normal_image == kNone ? 0 : f.normal_scale,
                        .occlusion_strength = f.occlusion_image == kNone ? 0 : f.occlusion_strength,
                        .alpha_cutoff = f.alpha_cutoff,
                        .is_masked = f.alpha_mode != AlphaMode::kOpaque,
                        .is_blended = f.alpha_mode == AlphaMode::kBlend,
                        .is_double_sided = f.double_sided,
                        .has_maps = material.has_maps,
                        .sampling = {.is_nearest = f.filter == TextureFilter::kNearest,
                                     .wrap_u = static_cast<raster::Wrap>(f.wrap_u),
                                     .wrap_v = static_cast<raster::Wrap>(f.wrap_v)}};
    std::ranges::copy(f.base_color, to.base_color);
    std::ranges::copy(f.emissive, to.emissive);
    const std::array maps{&to.base_color_map, &to.metallic_roughness_map, &to.normal_map, &to.occlusion_map,
                          &to.emissive_map};
    for (size_t i = 0; i < maps.size(); ++i)
        if (material.textures[i]) *maps[i] = &material.textures[i]->texture();
    return to;
}

std::vector<raster::Material> to_raster(const TexturedMaterials<raster::OwnedTexture>& materials) {
    std::vector<raster::Material> all;
    for (const auto& material : materials.all()) all.push_back(to_raster(material));
    return all;
}

}  // namespace

TexturedMaterials<raster::OwnedTexture> native_materials(Gpu& gpu, const Group& group,
                                                         std::vector<std::string>& warnings, uint64_t& room_bytes) {
    TextureAccount account{warnings, room_bytes, gpu.values};
    return {group,
            [&](const AssetImage& image, bool is_color) { return make_native_texture(gpu, image, is_color, account); }};
}

NativeGroup::NativeGroup(const CrowdState& crowd, const Group& group, uint64_t& room_bytes)
    : joint_levels_(levels_of(group.parents)),
      textured_(native_materials(*crowd.gpu, group, warnings_, room_bytes)),
      materials_(to_raster(textured_)),
      mesh_(group, crowd.cull ? 1 + static_cast<uint32_t>(group.lods.size()) : 1) {}

}  // namespace throng
