#include "tools/view/context.h"

#include "tools/cli/command.h"
#include "tools/view/same_device.h"

#include <optional>
#include <string>
#include <vector>

namespace throng::view {

using tools::CommandError;

Context::Context(const Window& window, const std::string& select) {
    if (!glfwVulkanSupported())
        throw CommandError(
            "no Vulkan driver can show pictures in a window (mesa-vulkan-drivers has a software one that can)");
    try {
        create_instance();
        check(glfwCreateWindowSurface(instance(), window.handle(), nullptr, &surface_), "glfwCreateWindowSurface");
        find_device(select);
        find_queue_family();
        create_device();
    } catch (...) {
        destroy();
        throw;
    }
}

Context::~Context() { destroy(); }

void Context::destroy() {
    if (device()) vkDestroyDevice(device(), nullptr);
    if (surface_) vkDestroySurfaceKHR(instance(), surface_, nullptr);
    if (instance()) vkDestroyInstance(instance(), nullptr);
}

void Context::create_instance() {
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "throng view",
                                        .apiVersion = VK_API_VERSION_1_3};
    VkInstanceCreateInfo create{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    create.ppEnabledExtensionNames = glfwGetRequiredInstanceExtensions(&create.enabledExtensionCount);
    check(vkCreateInstance(&create, nullptr, &adopted_.instance), "vkCreateInstance");
}

// Finds the device that every command would choose for this selection. Looks it up by name, since an instance with a
// surface may list devices in another order.
void Context::find_device(const std::string& select) {
    const DeviceInfo chosen = tools::open_device(select).info();
    device_name_ = chosen.name;
    std::vector<std::string> names, names_here;
    for (const DeviceInfo& info : tools::unwrap(Device::list())) names.push_back(info.name);
    const auto devices = list_of<VkPhysicalDevice>("vkEnumeratePhysicalDevices", vkEnumeratePhysicalDevices,
                                                   instance());
    for (const VkPhysicalDevice device : devices) {
        VkPhysicalDeviceProperties properties{};
        vkGetPhysicalDeviceProperties(device, &properties);
        names_here.push_back(properties.deviceName);
    }
    // The native device has a number of its own, which in Vulkan's list would be the first device's
    const std::optional<size_t> found = chosen.type == "native" ? std::nullopt
                                                                : same_device(names, chosen.index, names_here);
    if (!found)
        throw CommandError("device " + device_name_ +
                           " cannot show pictures in a window: choose another with --device");
    adopted_.physical_device = devices[*found];
}

void Context::find_queue_family() {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device(), &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device(), &count, families.data());
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t family = 0; family < count; ++family) {
        VkBool32 presents = VK_FALSE;
        check(vkGetPhysicalDeviceSurfaceSupportKHR(physical_device(), family, surface_, &presents),
              "vkGetPhysicalDeviceSurfaceSupportKHR");
        if (!presents || (families[family].queueFlags & kNeeded) != kNeeded) continue;
        adopted_.queue_family = family;
        return;
    }
    throw CommandError("device " + device_name_ +
                       " cannot show pictures in a window of this display: choose another with --device");
}

void Context::create_device() {
    VkPhysicalDeviceFeatures available{};
    vkGetPhysicalDeviceFeatures(physical_device(), &available);
    VkPhysicalDeviceVulkan13Features features13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                                .synchronization2 = VK_TRUE,
                                                .dynamicRendering = VK_TRUE,
                                                .maintenance4 = VK_TRUE};
    const VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                             .pNext = &features13,
                                             .features = {.shaderInt64 = available.shaderInt64}};
    adopted_.shader_int64 = available.shaderInt64 == VK_TRUE;
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue_create{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                               .queueFamilyIndex = queue_family(),
                                               .queueCount = 1,
                                               .pQueuePriorities = &priority};
    const char* extension = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    const VkDeviceCreateInfo create{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                    .pNext = &features,
                                    .queueCreateInfoCount = 1,
                                    .pQueueCreateInfos = &queue_create,
                                    .enabledExtensionCount = 1,
                                    .ppEnabledExtensionNames = &extension};
    const VkResult result = vkCreateDevice(physical_device(), &create, nullptr, &adopted_.device);
    if (result == VK_ERROR_EXTENSION_NOT_PRESENT)
        throw CommandError("device " + device_name_ +
                           " cannot show pictures in a window: choose another with --device");
    check(result, "vkCreateDevice");
    vkGetDeviceQueue(device(), queue_family(), 0, &adopted_.queue);
}

}  // namespace throng::view
