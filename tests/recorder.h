// Command buffers that a test records itself.
#pragma once

#include "gpu/gpu.h"
#include "gpu/vulkan.h"
#include "tests/kernel_runner.h"

namespace throng::test {

// Records command buffers, which may be submitted or not.
class Recorder {
public:
    Recorder() {
        VkCommandPoolCreateInfo create{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
        create.queueFamilyIndex = gpu_->queue_family;
        check(gpu_->vk.vkCreateCommandPool(gpu_->device, &create, nullptr, &pool_), "vkCreateCommandPool");
    }
    ~Recorder() {
        gpu_->vk.vkQueueWaitIdle(gpu_->queue);
        gpu_->vk.vkDestroyCommandPool(gpu_->device, pool_, nullptr);
    }
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    template <class Body>
    VkCommandBuffer record(const Body& body) {
        VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        allocate.commandPool = pool_;
        allocate.commandBufferCount = 1;
        VkCommandBuffer commands = VK_NULL_HANDLE;
        check(gpu_->vk.vkAllocateCommandBuffers(gpu_->device, &allocate, &commands), "vkAllocateCommandBuffers");
        const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
        check(gpu_->vk.vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
        body(commands);
        check(gpu_->vk.vkEndCommandBuffer(commands), "vkEndCommandBuffer");
        return commands;
    }
    void submit(VkCommandBuffer commands) {
        VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &commands;
        check(gpu_->vk.vkQueueSubmit(gpu_->queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
    }

private:
    std::shared_ptr<Gpu> gpu_ = test_gpu();
    VkCommandPool pool_ = VK_NULL_HANDLE;
};

}  // namespace throng::test
