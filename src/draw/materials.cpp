#include "draw/materials.h"

#include <array>

namespace throng {

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
                               const MaterialSampling& sampling, TextureAccount& account)
    : materials_(group, [&](const AssetImage& image, bool is_color) {
          return make_texture(uploads, image, is_color, account);
      }) {
    for (const TexturedMaterial<Image>& material : materials_.all()) {
        std::array<VkDescriptorImageInfo, kMaterialTextures.size()> images{};
        for (size_t t = 0; t < images.size(); ++t) {
            const Image& shown = material.textures[t] ? *material.textures[t] : sampling.white;
            images[t] = {sampling.sampler.get(), shown.view(), kTexture.layout};
        }
        bindings_.emplace_back(uploads.gpu(), group.name, set, BufferTable(), images);
    }
}

}  // namespace throng
