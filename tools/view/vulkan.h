// The Vulkan calls that the window needs besides throng. They link the system's loader, as Debian's build of Dear ImGui
// does. Every failure throws a CommandError.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace throng::view {

// Throws, naming the call and its result.
void check(VkResult result, const char* call);

// All that `function`, named `call` in messages, lists for these arguments.
template <class T, class Function, class... Arguments>
std::vector<T> list_of(const char* call, Function function, Arguments... arguments) {
    uint32_t count = 0;
    check(function(arguments..., &count, nullptr), call);
    std::vector<T> all(count);
    check(function(arguments..., &count, all.data()), call);
    return all;
}

// A handle that is destroyed with its owner; movable.
template <class Handle, auto Destroy>
class Owned {
public:
    Owned() = default;
    // `create` is the call, named `call` in messages, that takes device, info, allocator and handle.
    template <class Info>
    Owned(VkDevice device, VkResult (*create)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*),
          const Info& info, const char* call)
        : device_(device) {
        check(create(device, &info, nullptr, &handle_), call);
    }
    ~Owned() {
        if (handle_) Destroy(device_, handle_, nullptr);
    }
    Owned(Owned&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, {})) {}
    Owned& operator=(Owned&& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(handle_, other.handle_);
        return *this;
    }

    Handle get() const { return handle_; }

private:
    VkDevice device_ = VK_NULL_HANDLE;
    Handle handle_ = VK_NULL_HANDLE;
};

using OwnedImage = Owned<VkImage, vkDestroyImage>;
using OwnedImageView = Owned<VkImageView, vkDestroyImageView>;
using OwnedMemory = Owned<VkDeviceMemory, vkFreeMemory>;
using OwnedBuffer = Owned<VkBuffer, vkDestroyBuffer>;
using OwnedRenderPass = Owned<VkRenderPass, vkDestroyRenderPass>;
using OwnedFramebuffer = Owned<VkFramebuffer, vkDestroyFramebuffer>;
using OwnedSemaphore = Owned<VkSemaphore, vkDestroySemaphore>;
using OwnedFence = Owned<VkFence, vkDestroyFence>;
using OwnedCommandPool = Owned<VkCommandPool, vkDestroyCommandPool>;
using OwnedDescriptorPool = Owned<VkDescriptorPool, vkDestroyDescriptorPool>;
using OwnedSwapchain = Owned<VkSwapchainKHR, vkDestroySwapchainKHR>;

// Allocates device memory that meets `needs`, of a type with `properties`.
OwnedMemory allocate_memory(VkPhysicalDevice physical_device, VkDevice device, const VkMemoryRequirements& needs,
                            VkMemoryPropertyFlags properties);

// A buffer that the device copies to and the host then reads.
class HostBuffer {
public:
    HostBuffer() = default;
    HostBuffer(VkPhysicalDevice physical_device, VkDevice device, VkDeviceSize size_bytes);

    VkBuffer get() const { return buffer_.get(); }
    // Record it after the copies.
    void record_end(VkCommandBuffer commands) const;
    // What has been copied to it, once the commands have run.
    std::vector<uint8_t> read() const;

private:
    VkDevice device_ = VK_NULL_HANDLE;
    VkDeviceSize size_bytes_ = 0;
    OwnedMemory memory_;
    OwnedBuffer buffer_;
};

// What an image was last used for, and is used for next.
struct ImageUse {
    VkPipelineStageFlags2 stage = VK_PIPELINE_STAGE_2_NONE;
    VkAccessFlags2 access = VK_ACCESS_2_NONE;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
};
inline constexpr ImageUse kCopiedTo{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                    VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
void transition(VkCommandBuffer commands, VkImage image, const ImageUse& before, const ImageUse& after);

}  // namespace throng::view
