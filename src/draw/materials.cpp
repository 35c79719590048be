#include "draw/materials.h"

#include <array>

namespace throng {

MaterialSampling::MaterialSampling(const std::shared_ptr<Gpu>& gpu) {
    // By TextureFilter and TextureWrap
    constexpr std::array kMagnified{VK_FILTER_LINEAR, VK_FILTER_NEAREST};
    constexpr std::array kOutside{VK_SAMPLER_ADDRESS_MODE_REPEAT, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                  VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT};
    for (size_t filter = 0; filter < kFilters; ++filter)
        for (size_t u = 0; u < kWraps; ++u)
            for (size_t v = 0; v < kWraps; ++v) {
                const VkSamplerCreateInfo create{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                                 .magFilter = kMagnified[filter],
                                                 .minFilter = VK_FILTER_LINEAR,
                                                 .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                                 .addressModeU = kOutside[u],
                                                 .addressModeV = kOutside[v],
                                                 .maxLod = VK_LOD_CLAMP_NONE};
                samplers_[filter][u][v] = OwnedSampler(gpu, gpu->vk.vkCreateSampler, create, "vkCreateSampler");
            }
}

VkSampler MaterialSampling::sampler_of(const AssetMaterial& material) const {
    return samplers_[static_cast<size_t>(material.filter)][static_cast<size_t>(material.wrap_u)]
                    [static_cast<size_t>(material.wrap_v)]
                        .get();
}

GroupMaterials::GroupMaterials(Uploads& uploads, const Group& group, const ShaderLayout::Set& set,
                               const MaterialSampling& sampling, TextureAccount& account)
    : materials_(group, [&](const AssetImage& image,
                            bool is_color) { return make_texture(uploads, image, is_color, account); }),
      white_(make_white_texture(uploads, account.textures)) {
    for (const TexturedMaterial<Image>& material : materials_.all()) {
        std::array<VkDescriptorImageInfo, kMaterialTextures.size()> images{};
        for (size_t t = 0; t < images.size(); ++t) {
            const Image& shown = material.textures[t] ? *material.textures[t] : *white_;
            images[t] = {sampling.sampler_of(material.factors), shown.view(), kTexture.layout};
        }
        bindings_.emplace_back(uploads.gpu(), group.name, set, BufferTable(), images);
    }
}

}  // namespace throng
