// The window's instance, surface, device and queue, which throng adopts.
#pragma once

#include "tools/view/vulkan.h"
#include "tools/view/window.h"

#include <throng/device.h>

#include <string>

namespace throng::view {

// Throws a CommandError if there is no such device, or none that can show pictures in the window.
class Context {
public:
    // `select` as in DeviceSettings.
    Context(const Window& window, const std::string& select);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    VkInstance instance() const { return adopted_.instance; }
    VkPhysicalDevice physical_device() const { return adopted_.physical_device; }
    VkDevice device() const { return adopted_.device; }
    VkQueue queue() const { return adopted_.queue; }
    uint32_t queue_family() const { return adopted_.queue_family; }
    VkSurfaceKHR surface() const { return surface_; }
    const AdoptedDevice& adopted() const { return adopted_; }

private:
    void create_instance();
    void find_device(const std::string& select);
    void find_queue_family();
    void create_device();
    void destroy();

    AdoptedDevice adopted_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    std::string device_name_;
};

}  // namespace throng::view
