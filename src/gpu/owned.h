// Vulkan objects that destroy themselves.
#pragma once

#include "gpu/gpu.h"

#include <utility>

namespace throng {

// Movable, not copyable. `Destroy` is the member of the device's function table that takes device, handle and
// allocator.
template <class Handle, auto Destroy>
class Owned {
public:
    Owned() = default;
    Owned(std::shared_ptr<const Gpu> gpu, Handle handle) : gpu_(std::move(gpu)), handle_(handle) {}
    // `create` is the call, named `call` in messages, that takes device, info, allocator and handle.
    template <class Info>
    Owned(std::shared_ptr<const Gpu> gpu,
          VkResult (*create)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*), const Info& info,
          const char* call)
        : gpu_(std::move(gpu)) {
        check(create(gpu_->device, &info, nullptr, &handle_), call);
    }
    ~Owned() {
        if (gpu_) ((*gpu_).vk.*Destroy)(gpu_->device, handle_, nullptr);
    }
    Owned(Owned&& other) noexcept { *this = std::move(other); }
    Owned& operator=(Owned&& other) noexcept {
        std::swap(gpu_, other.gpu_);
        std::swap(handle_, other.handle_);
        return *this;
    }

    Handle get() const { return handle_; }

private:
    std::shared_ptr<const Gpu> gpu_;
    Handle handle_ = VK_NULL_HANDLE;
};

using OwnedImage = Owned<VkImage, &VolkDeviceTable::vkDestroyImage>;
using OwnedImageView = Owned<VkImageView, &VolkDeviceTable::vkDestroyImageView>;
using OwnedBufferView = Owned<VkBufferView, &VolkDeviceTable::vkDestroyBufferView>;
using OwnedCommandPool = Owned<VkCommandPool, &VolkDeviceTable::vkDestroyCommandPool>;
using OwnedFence = Owned<VkFence, &VolkDeviceTable::vkDestroyFence>;
using OwnedMemory = Owned<VkDeviceMemory, &VolkDeviceTable::vkFreeMemory>;
using OwnedSampler = Owned<VkSampler, &VolkDeviceTable::vkDestroySampler>;
using OwnedShader = Owned<VkShaderModule, &VolkDeviceTable::vkDestroyShaderModule>;
using OwnedSetLayout = Owned<VkDescriptorSetLayout, &VolkDeviceTable::vkDestroyDescriptorSetLayout>;
using OwnedDescriptorPool = Owned<VkDescriptorPool, &VolkDeviceTable::vkDestroyDescriptorPool>;
using OwnedPipelineLayout = Owned<VkPipelineLayout, &VolkDeviceTable::vkDestroyPipelineLayout>;
using OwnedPipeline = Owned<VkPipeline, &VolkDeviceTable::vkDestroyPipeline>;
using OwnedQueryPool = Owned<VkQueryPool, &VolkDeviceTable::vkDestroyQueryPool>;
using OwnedEvent = Owned<VkEvent, &VolkDeviceTable::vkDestroyEvent>;

}  // namespace throng
