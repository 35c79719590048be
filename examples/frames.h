// The application's own frames: two command buffers used in turns, each with a fence.
#pragma once

#include "open_vulkan.h"

inline VkCommandBuffer begun(VkCommandBuffer commands) {
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(commands, &info), "vkBeginCommandBuffer");
    return commands;
}

// A command buffer that another thread records, with its own pool.
class OwnCommands {
public:
    explicit OwnCommands(const throng::AdoptedDevice& vulkan) : device_(vulkan.device) {
        const VkCommandPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                             .queueFamilyIndex = vulkan.queue_family};
        check(vkCreateCommandPool(device_, &create, nullptr, &pool_), "vkCreateCommandPool");
        const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                   .commandPool = pool_,
                                                   .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                   .commandBufferCount = 1};
        check(vkAllocateCommandBuffers(device_, &allocate, &commands_), "vkAllocateCommandBuffers");
    }
    ~OwnCommands() { vkDestroyCommandPool(device_, pool_, nullptr); }
    OwnCommands(const OwnCommands&) = delete;

    VkCommandBuffer begin() { return begun(commands_); }
    VkCommandBuffer end() {
        check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
        return commands_;
    }

private:
    VkDevice device_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

class Frames {
public:
    static constexpr uint32_t kInFlight = 2;

    Frames(const throng::AdoptedDevice& vulkan, Cleanup& cleanup) : device_(vulkan.device), queue_(vulkan.queue) {
        const Context context{vulkan.physical_device, vulkan.device, cleanup};
        pool_ = make(context, "vkCreateCommandPool", vkCreateCommandPool, vkDestroyCommandPool,
                     {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                      .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                      .queueFamilyIndex = vulkan.queue_family});
        const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                   .commandPool = pool_,
                                                   .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                   .commandBufferCount = kInFlight};
        check(vkAllocateCommandBuffers(device_, &allocate, commands_.data()), "vkAllocateCommandBuffers");
        for (VkFence& fence : fences_)
            fence = make(context, "vkCreateFence", vkCreateFence, vkDestroyFence,
                         {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .flags = VK_FENCE_CREATE_SIGNALED_BIT});
    }

    // Waits until the frame that last used this command buffer has finished.
    VkCommandBuffer begin() {
        check(vkWaitForFences(device_, 1, &fences_[turn_], VK_TRUE, UINT64_MAX), "vkWaitForFences");
        return begun(commands_[turn_]);
    }
    // Ends the commands without submitting them, as when a window has been minimised. The next begin() uses the same
    // command buffer.
    void drop() { check(vkEndCommandBuffer(commands_[turn_]), "vkEndCommandBuffer"); }
    // Submits this frame's commands, after `others` if there are any.
    void submit(VkCommandBuffer others = VK_NULL_HANDLE) {
        check(vkEndCommandBuffer(commands_[turn_]), "vkEndCommandBuffer");
        check(vkResetFences(device_, 1, &fences_[turn_]), "vkResetFences");
        const std::array all{others, commands_[turn_]};
        const VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                .commandBufferCount = others ? 2u : 1u,
                                .pCommandBuffers = others ? all.data() : all.data() + 1};
        check(vkQueueSubmit(queue_, 1, &info, fences_[turn_]), "vkQueueSubmit");
        turn_ = (turn_ + 1) % kInFlight;
    }
    // Waits for all frames.
    void finish() {
        check(vkWaitForFences(device_, kInFlight, fences_.data(), VK_TRUE, UINT64_MAX), "vkWaitForFences");
    }

private:
    VkDevice device_;
    VkQueue queue_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    std::array<VkCommandBuffer, kInFlight> commands_{};
    std::array<VkFence, kInFlight> fences_{};
    uint32_t turn_ = 0;
};
