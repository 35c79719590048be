#include "draw/materials.h"

#include "draw/descriptors.h"

namespace throng {

MaterialSampling::MaterialSampling(const std::shared_ptr<Gpu>& gpu) : white(make_white_texture(gpu)) {
    VkSamplerCreateInfo create{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    create.magFilter = create.minFilter = VK_FILTER_LINEAR;
    create.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    create.addressModeU = create.addressModeV = create.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    create.maxLod = VK_LOD_CLAMP_NONE;
    sampler = OwnedSampler(gpu, gpu->vk.vkCreateSampler, create, "vkCreateSampler");
}

GroupMaterials::GroupMaterials(Uploads& uploads, const Group& group, VkDescriptorSetLayout layout,
                               const MaterialSampling& sampling, TextureAccount& account) {
    std::vector<bool> used(group.materials.size());
    for (const MeshSection& section : group.sections)
        if (section.material < used.size() && section.index_count > 0) used[section.material] = true;

    const auto count = static_cast<uint32_t>(group.materials.size() + 1);
    pool_ = make_descriptor_pool(uploads.gpu(), count,
                                 {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count * kMaterialTextures}});

    for (size_t i = 0; i < group.materials.size(); ++i) {
        AssetMaterial material = group.materials[i];
        const auto view = [&](uint32_t image, VkFormat format) {
            return texture(uploads, group, used[i] ? image : kNone, format, sampling, account).view();
        };
        const std::array views{
            view(material.image, kColorTexture), view(material.metallic_roughness_image, kNumberTexture),
            view(material.normal_image, kNumberTexture), view(material.occlusion_image, kNumberTexture),
            view(material.emissive_image, kColorTexture)};
        if (views[2] == sampling.white.view()) material.normal_image = kNone;  // white would tilt normals
        add(uploads.gpu(), layout, sampling.sampler.get(), material, views);
    }
    std::array<VkImageView, kMaterialTextures> whites{};
    whites.fill(sampling.white.view());
    add(uploads.gpu(), layout, sampling.sampler.get(), {}, whites);
}

const Image& GroupMaterials::texture(Uploads& uploads, const Group& group, uint32_t image, VkFormat format,
                                     const MaterialSampling& sampling, TextureAccount& account) {
    if (image >= group.images.size()) return sampling.white;
    const std::pair key(image, format);
    auto found = textures_.find(key);
    if (found == textures_.end())
        found = textures_.emplace(key, make_texture(uploads, group.images[image], format, account)).first;
    return found->second ? *found->second : sampling.white;
}

void GroupMaterials::add(const std::shared_ptr<Gpu>& gpu, VkDescriptorSetLayout layout, VkSampler sampler,
                         const AssetMaterial& material, const std::array<VkImageView, kMaterialTextures>& views) {
    constexpr float kBlendCutoff = 0.5f;
    DrawMaterial& added = materials_.emplace_back(DrawMaterial{.factors = material});
    added.masked = material.alpha_mode != AlphaMode::kOpaque;
    added.alpha_cutoff = material.alpha_mode == AlphaMode::kMask    ? material.alpha_cutoff
                         : material.alpha_mode == AlphaMode::kBlend ? kBlendCutoff
                                                                    : 0;
    visit_images([&](auto member) {
        added.has_maps = added.has_maps || (member != &AssetMaterial::image && material.*member != kNone);
    });
    added.set = allocate_set(*gpu, pool_, layout);
    for (uint32_t i = 0; i < kMaterialTextures; ++i)
        write_image(*gpu, added.set, i, {sampler, views[i], VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
}

}  // namespace throng
