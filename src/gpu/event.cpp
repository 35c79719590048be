#include "gpu/event.h"

#include "gpu/barrier.h"

namespace throng {

DeviceEvent::DeviceEvent(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {
    if (gpu_->is_native()) return;
    const VkEventCreateInfo create{VK_STRUCTURE_TYPE_EVENT_CREATE_INFO};
    event_ = {gpu_, gpu_->vk.vkCreateEvent, create, "vkCreateEvent"};
}

bool DeviceEvent::is_set() const {
    if (gpu_->is_native()) return is_set_;
    const VkResult status = gpu_->vk.vkGetEventStatus(gpu_->device, event_.get());
    if (status < 0) check(status, "vkGetEventStatus");
    return status == VK_EVENT_SET;
}

void DeviceEvent::set() {
    if (gpu_->is_native())
        is_set_ = true;
    else
        check(gpu_->vk.vkSetEvent(gpu_->device, event_.get()), "vkSetEvent");
}

void DeviceEvent::reset() {
    if (gpu_->is_native())
        is_set_ = false;
    else
        check(gpu_->vk.vkResetEvent(gpu_->device, event_.get()), "vkResetEvent");
}

void DeviceEvent::record_set(VkCommandBuffer commands) {
    if (!commands) return set();
    // An event's own barrier works only for waits on the GPU, and must not name the CPU
    // (VUID-vkCmdSetEvent2-dstStageMask-09392). So the barrier for the CPU comes before it, and the event after both.
    memory_barrier(*gpu_, commands, kTransferWrite, {kHostRead.stage | kTransferWrite.stage, kHostRead.access});
    record_set(commands, barrier_between(kTransferWrite, {}));
}

void DeviceEvent::record_set_behind_all(VkCommandBuffer commands) {
    if (!commands) return set();
    record_set(commands, barrier_between({VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0}, {}));
}

void DeviceEvent::record_set(VkCommandBuffer commands, const VkMemoryBarrier2& barrier) {
    const VkDependencyInfo dependency = dependency_of(barrier);
    gpu_->vk.vkCmdSetEvent2(commands, event_.get(), &dependency);
}

}  // namespace throng
