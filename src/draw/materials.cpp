#include "draw/materials.h"

#include <array>

namespace throng {
namespace {

struct MaterialTexture {
    uint32_t AssetMaterial::*image;
    VkFormat format;
};
// By their bindings.
constexpr std::array<MaterialTexture, 5> kTextures{{{&AssetMaterial::image, kColorTexture},
                                                    {&AssetMaterial::metallic_roughness_image, kNumberTexture},
                                                    {&AssetMaterial::normal_image, kNumberTexture},
                                                    {&AssetMaterial::occlusion_image, kNumberTexture},
                                                    {&AssetMaterial::emissive_image, kColorTexture}}};

float cutoff_of(const AssetMaterial& material) {
    constexpr float kBlendCutoff = 0.5f;
    switch (material.alpha_mode) {
        case AlphaMode::kMask: return material.alpha_cutoff;
        case AlphaMode::kBlend: return kBlendCutoff;
        case AlphaMode::kOpaque: break;
    }
    return 0;
}

}  // namespace

MaterialSampling::MaterialSampling(const std::shared_ptr<Gpu>& gpu) : white(make_white_texture(gpu)) {
    const VkSamplerCreateInfo create{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                     .magFilter = VK_FILTER_LINEAR,
                                     .minFilter = VK_FILTER_LINEAR,
                                     .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                     .addressModeU = VK_SAMPLER_ADDRESS_MODE_REPEAT,
                                     .addressModeV = VK_SAMPLER_ADDRESS_MODE_REPEAT,
                                     .maxLod = VK_LOD_CLAMP_NONE};
    sampler = OwnedSampler(gpu, gpu->vk.vkCreateSampler, create, "vkCreateSampler");
}

GroupMaterials::GroupMaterials(Uploads& uploads, const Group& group, const ShaderLayout::Set& set,
                               const MaterialSampling& sampling, TextureAccount& account) {
    std::vector<bool> used(group.materials.size());
    for (const MeshSection& section : group.sections)
        if (section.material < used.size() && section.index_count > 0) used[section.material] = true;
    const auto texture = [&](uint32_t image, VkFormat format) -> const Image& {
        if (image >= group.images.size()) return sampling.white;
        const std::pair key(image, format);
        auto found = textures_.find(key);
        if (found == textures_.end())
            found = textures_.emplace(key, make_texture(uploads, group.images[image], format, account)).first;
        return found->second ? *found->second : sampling.white;
    };
    for (size_t i = 0; i <= group.materials.size(); ++i) {
        const bool is_default = i == group.materials.size();
        DrawMaterial& material = materials_.emplace_back();
        if (!is_default) material.factors = group.materials[i];
        std::array<VkDescriptorImageInfo, kTextures.size()> images{};
        for (size_t t = 0; t < images.size(); ++t) {
            uint32_t& image = material.factors.*kTextures[t].image;
            const Image& shown = texture(!is_default && used[i] ? image : kNone, kTextures[t].format);
            if (kTextures[t].image == &AssetMaterial::normal_image && &shown == &sampling.white)
                image = kNone;  // white would tilt normals
            material.has_maps = material.has_maps || (t > 0 && image != kNone);
            images[t] = {sampling.sampler.get(), shown.view(), kTexture.layout};
        }
        material.masked = material.factors.alpha_mode != AlphaMode::kOpaque;
        material.alpha_cutoff = cutoff_of(material.factors);
        material.textures = Bindings(uploads.gpu(), group.name, set, {}, images);
    }
}

}  // namespace throng
