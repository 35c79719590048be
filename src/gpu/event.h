// Tells the CPU that the device has reached a point in its commands.
#pragma once

#include "gpu/owned.h"

#include <algorithm>
#include <functional>
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

// Reusable events. None is destroyed before the pool: the commands that set an event may still be running when it is
// found set.
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

// Whether a slot can be used again: the commands that use it have run, or never will, because others that were recorded
// later have run. A slot has the number of its commands, in the order of recording (0: none), and an event `done`.
template <class Slots, class Slot, class Number>
bool is_free(const Slots& slots, const Slot& slot, const Number& number) {
    const uint64_t of_slot = std::invoke(number, slot);
    return of_slot == 0 || slot.done.is_set() || std::ranges::any_of(slots, [&](const Slot& other) {
               return std::invoke(number, other) > of_slot && other.done.is_set();
           });
}

}  // namespace throng
