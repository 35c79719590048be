// The application's own instance, device and queue, with what throng::AdoptedDevice asks for.
#pragma once

#include "offscreen.h"

#include <throng/device.h>

#include <array>

inline throng::AdoptedDevice open_vulkan(Cleanup& cleanup, const char* name) {
    throng::AdoptedDevice out;
    const VkApplicationInfo application{
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = name, .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo instance_info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                             .pApplicationInfo = &application};
    check(vkCreateInstance(&instance_info, nullptr, &out.instance), "vkCreateInstance");
    cleanup.add([instance = out.instance] { vkDestroyInstance(instance, nullptr); });
    uint32_t count = 1;
    if (vkEnumeratePhysicalDevices(out.instance, &count, &out.physical_device) < VK_SUCCESS || count == 0)
        check(VK_ERROR_INITIALIZATION_FAILED, "finding a device");
    std::array<VkQueueFamilyProperties, 16> families{};
    count = families.size();
    vkGetPhysicalDeviceQueueFamilyProperties(out.physical_device, &count, families.data());
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    while (out.queue_family + 1 < count && (families[out.queue_family].queueFlags & kNeeded) != kNeeded)
        ++out.queue_family;
    VkPhysicalDeviceVulkan13Features available{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceFeatures2 asked{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &available};
    vkGetPhysicalDeviceFeatures2(out.physical_device, &asked);
    out.subgroup_size_control = available.subgroupSizeControl == VK_TRUE;
    out.compute_full_subgroups = available.computeFullSubgroups == VK_TRUE;
    VkPhysicalDeviceVulkan13Features features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                              .subgroupSizeControl = available.subgroupSizeControl,
                                              .computeFullSubgroups = available.computeFullSubgroups,
                                              .synchronization2 = VK_TRUE,
                                              .dynamicRendering = VK_TRUE,
                                              .maintenance4 = VK_TRUE};
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = out.queue_family,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    const VkDeviceCreateInfo device_info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                         .pNext = &features,
                                         .queueCreateInfoCount = 1,
                                         .pQueueCreateInfos = &queue};
    check(vkCreateDevice(out.physical_device, &device_info, nullptr, &out.device), "vkCreateDevice");
    cleanup.add([device = out.device] { vkDestroyDevice(device, nullptr); });
    vkGetDeviceQueue(out.device, out.queue_family, 0, &out.queue);
    return out;
}
