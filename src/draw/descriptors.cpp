#include "draw/descriptors.h"

namespace throng {

OwnedPool make_descriptor_pool(const std::shared_ptr<Gpu>& gpu, uint32_t set_count,
                               std::initializer_list<VkDescriptorPoolSize> sizes) {
    VkDescriptorPoolCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    create.maxSets = set_count;
    create.poolSizeCount = static_cast<uint32_t>(sizes.size());
    create.pPoolSizes = sizes.begin();
    return {gpu, gpu->vk.vkCreateDescriptorPool, create, "vkCreateDescriptorPool"};
}

VkDescriptorSet allocate_set(const Gpu& gpu, const OwnedPool& pool, VkDescriptorSetLayout layout) {
    VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    allocate.descriptorPool = pool.get();
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &layout;
    VkDescriptorSet set = VK_NULL_HANDLE;
    check(gpu.vk.vkAllocateDescriptorSets(gpu.device, &allocate, &set), "vkAllocateDescriptorSets");
    return set;
}

void write_image(const Gpu& gpu, VkDescriptorSet set, uint32_t binding, const VkDescriptorImageInfo& image) {
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.dstBinding = binding;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pImageInfo = &image;
    gpu.vk.vkUpdateDescriptorSets(gpu.device, 1, &write, 0, nullptr);
}

}  // namespace throng
