// Pools of descriptor sets, and the sets in them.
#pragma once

#include "gpu/owned.h"

#include <initializer_list>

namespace throng {

// With room for this many sets, which have these descriptors between them.
OwnedPool make_descriptor_pool(const std::shared_ptr<Gpu>& gpu, uint32_t set_count,
                               std::initializer_list<VkDescriptorPoolSize> sizes);
// Lives as long as the pool.
VkDescriptorSet allocate_set(const Gpu& gpu, const OwnedPool& pool, VkDescriptorSetLayout layout);
// An image and its sampler.
void write_image(const Gpu& gpu, VkDescriptorSet set, uint32_t binding, const VkDescriptorImageInfo& image);

}  // namespace throng
