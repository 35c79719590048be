// Tells the CPU that the device has reached a point in its commands.
#pragma once

#include "gpu/owned.h"

#include <vector>

namespace throng {

class DeviceEvent {
public:
    DeviceEvent() = default;
    explicit DeviceEvent(std::shared_ptr<Gpu> gpu);

    bool is_set() const;
    void set();
    void reset();
    // Sets it after all copies so far, and makes what they wrote visible to a CPU that finds it set.
    void record_set(VkCommandBuffer commands);
    // Sets it after all commands so far.
    void record_set_behind_all(VkCommandBuffer commands);

private:
    void record_set(VkCommandBuffer commands, const VkMemoryBarrier2& barrier);

    std::shared_ptr<Gpu> gpu_;
    OwnedEvent event_;
    bool is_set_ = false;  // on a native device
};

// Events to be used again and again. None is destroyed before the pool: the commands that set one may still be under
// way when it is found set.
class EventPool {
public:
    explicit EventPool(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

    DeviceEvent take() {
        if (free_.empty()) return DeviceEvent(gpu_);
        DeviceEvent event = std::move(free_.back());
        free_.pop_back();
        return event;
    }
    void give_back(DeviceEvent event) {
        event.reset();
        free_.push_back(std::move(event));
    }

private:
    std::shared_ptr<Gpu> gpu_;
    std::vector<DeviceEvent> free_;
};

}  // namespace throng
