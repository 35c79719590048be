#include "gpu/submissions.h"

#include "gpu/owned.h"

namespace throng {

// Each has its own command pool, command buffer and fence, so that threads share nothing.
struct Submissions::Submission {
    explicit Submission(const Gpu& gpu) {
        const VkCommandPoolCreateInfo pool_create{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                                  .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                                  .queueFamilyIndex = gpu.queue_family};
        pool = OwnedCommandPool(gpu.unowned(), gpu.vk.vkCreateCommandPool, pool_create, "vkCreateCommandPool");
        const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                   .commandPool = pool.get(),
                                                   .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                   .commandBufferCount = 1};
        check(gpu.vk.vkAllocateCommandBuffers(gpu.device, &allocate, &commands), "vkAllocateCommandBuffers");
        const VkFenceCreateInfo fence_create{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        finished = OwnedFence(gpu.unowned(), gpu.vk.vkCreateFence, fence_create, "vkCreateFence");
    }

    OwnedCommandPool pool;
    OwnedFence finished;
    VkCommandBuffer commands = VK_NULL_HANDLE;
};

Submissions::Submissions(const Gpu& gpu, bool keeps_idle) : gpu_(gpu), keeps_idle_(keeps_idle) {}
Submissions::~Submissions() = default;
void Submissions::clear() { idle_.clear(); }

std::unique_ptr<Submissions::Submission> Submissions::take() {
    {
        const std::lock_guard lock(mutex_);
        if (!idle_.empty()) {
            std::unique_ptr<Submission> taken = std::move(idle_.back());
            idle_.pop_back();
            return taken;
        }
    }
    return std::make_unique<Submission>(gpu_);
}

void Submissions::give_back(std::unique_ptr<Submission> submission) {
    if (!keeps_idle_) return;
    const VkFence fence = submission->finished.get();
    check(gpu_.vk.vkResetCommandPool(gpu_.device, submission->pool.get(), 0), "vkResetCommandPool");
    check(gpu_.vk.vkResetFences(gpu_.device, 1, &fence), "vkResetFences");
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(submission));
}

void Submissions::run(const std::function<void(VkCommandBuffer)>& body) {
    std::unique_ptr<Submission> submission = take();
    const VkCommandBuffer commands = submission->commands;
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(gpu_.vk.vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    body(commands);
    check(gpu_.vk.vkEndCommandBuffer(commands), "vkEndCommandBuffer");

    const VkCommandBufferSubmitInfo command_submit{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                                   .commandBuffer = commands};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &command_submit};
    const VkFence fence = submission->finished.get();
    check(gpu_.vk.vkQueueSubmit2(gpu_.queue, 1, &submit, fence), "vkQueueSubmit2");
    ++gpu_.counts.submissions;
    // No timeout: a frame of a software device may take minutes, and a driver reports a device that hangs as lost.
    check(gpu_.vk.vkWaitForFences(gpu_.device, 1, &fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    give_back(std::move(submission));
}

}  // namespace throng
