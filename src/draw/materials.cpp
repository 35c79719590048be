#include "draw/materials.h"

namespace throng {

MaterialSampling::MaterialSampling(const std::shared_ptr<Gpu>& gpu) : white(make_white_texture(gpu)) {
    VkSamplerCreateInfo create{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    create.magFilter = create.minFilter = VK_FILTER_LINEAR;
    create.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    create.addressModeU = create.addressModeV = create.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    create.maxLod = VK_LOD_CLAMP_NONE;
    sampler = OwnedSampler(gpu, gpu->vk.vkCreateSampler, create, "vkCreateSampler");
}

GroupMaterials::GroupMaterials(const std::shared_ptr<Gpu>& gpu, const Group& group, VkDescriptorSetLayout layout, const MaterialSampling& sampling,
                               std::vector<std::string>& warnings)
    : textures_(group.images.size()) {
    for (const MeshSection& section : group.sections) {
        if (section.material >= group.materials.size() || section.index_count == 0) continue;
        const uint32_t image = group.materials[section.material].image;
        if (image < textures_.size() && !textures_[image].handle()) textures_[image] = make_texture(gpu, group.images[image], warnings);
    }

    const auto count = static_cast<uint32_t>(group.materials.size() + 1);
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count};
    VkDescriptorPoolCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    create.maxSets = count;
    create.poolSizeCount = 1;
    create.pPoolSizes = &size;
    pool_ = OwnedPool(gpu, gpu->vk.vkCreateDescriptorPool, create, "vkCreateDescriptorPool");

    const auto add = [&](DrawMaterial material, VkImageView view) {
        VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
        allocate.descriptorPool = pool_.get();
        allocate.descriptorSetCount = 1;
        allocate.pSetLayouts = &layout;
        check(gpu->vk.vkAllocateDescriptorSets(gpu->device, &allocate, &material.set), "vkAllocateDescriptorSets");
        const VkDescriptorImageInfo image{sampling.sampler.get(), view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = material.set;
        write.descriptorCount = 1;
        write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        write.pImageInfo = &image;
        gpu->vk.vkUpdateDescriptorSets(gpu->device, 1, &write, 0, nullptr);
        materials_.push_back(material);
    };
    constexpr float kBlendCutoff = 0.5f;
    for (const AssetMaterial& material : group.materials) {
        const bool has_texture = material.image < textures_.size() && textures_[material.image].handle();
        add({.base_color = material.base_color,
             .alpha_cutoff = material.alpha_mode == AlphaMode::kMask ? material.alpha_cutoff : material.alpha_mode == AlphaMode::kBlend ? kBlendCutoff : 0,
             .masked = material.alpha_mode != AlphaMode::kOpaque,
             .double_sided = material.double_sided},
            has_texture ? textures_[material.image].view() : sampling.white.view());
    }
    add({}, sampling.white.view());
}

}  // namespace throng
