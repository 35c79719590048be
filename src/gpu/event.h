// What tells the CPU that the device has come to a point.
#pragma once

#include "gpu/owned.h"

namespace throng {

class DeviceEvent {
public:
    DeviceEvent() = default;
    explicit DeviceEvent(std::shared_ptr<Gpu> gpu);

    bool is_set() const;
    void set();
    void reset();
    // Sets it behind all copies so far, and makes what they wrote visible to a CPU that finds it set.
    void record_set(VkCommandBuffer commands);

private:
    std::shared_ptr<Gpu> gpu_;
    OwnedEvent event_;
    bool is_set_ = false;  // on a native device
};

}  // namespace throng
