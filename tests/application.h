// An application that brings its own device.
#pragma once

#include "gpu/gpu.h"
#include "gpu/vulkan.h"
#include "tests/test_device.h"

#include <throng/device.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace throng::test {

// The Vulkan objects that an application creates itself.
struct Application {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queue_family = 0;
    std::vector<VkQueueFamilyProperties> families;

    explicit Application(uint32_t api_version = VK_API_VERSION_1_3) {
        EXPECT_EQ(volkInitialize(), VK_SUCCESS);
        VkApplicationInfo info{VK_STRUCTURE_TYPE_APPLICATION_INFO};
        info.apiVersion = api_version;
        VkInstanceCreateInfo instance_create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        instance_create.pApplicationInfo = &info;
        EXPECT_EQ(vkCreateInstance(&instance_create, nullptr, &instance), VK_SUCCESS);
        volkLoadInstanceOnly(instance);
        uint32_t count = 0;
        vkEnumeratePhysicalDevices(instance, &count, nullptr);
        std::vector<VkPhysicalDevice> devices(count);
        vkEnumeratePhysicalDevices(instance, &count, devices.data());
        for (VkPhysicalDevice candidate : devices) {
            VkPhysicalDeviceProperties properties{};
            vkGetPhysicalDeviceProperties(candidate, &properties);
            if (test_device().info().name == properties.deviceName) physical_device = candidate;
        }
        vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, nullptr);
        families.resize(count);
        vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, families.data());
        queue_family = test_device().gpu()->queue_family;
        VkPhysicalDeviceVulkan13Features features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
        features.synchronization2 = features.maintenance4 = VK_TRUE;
        features.subgroupSizeControl = test_device().gpu()->can_choose_subgroup;
        features.computeFullSubgroups = test_device().gpu()->has_full_subgroups;
        const std::array<float, 2> priorities{1, 1};
        std::vector<VkDeviceQueueCreateInfo> queues;
        for (uint32_t family = 0; family < families.size(); ++family) {
            VkDeviceQueueCreateInfo& wanted = queues.emplace_back();
            wanted = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
            wanted.queueFamilyIndex = family;
            wanted.queueCount = queue_count_of(family);
            wanted.pQueuePriorities = priorities.data();
        }
        VkDeviceCreateInfo create{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features};
        create.queueCreateInfoCount = static_cast<uint32_t>(queues.size());
        create.pQueueCreateInfos = queues.data();
        EXPECT_EQ(vkCreateDevice(physical_device, &create, nullptr, &device), VK_SUCCESS);
        volkLoadDeviceTable(&table, device);
        table.vkGetDeviceQueue(device, queue_family, 0, &queue);
    }
    ~Application() {
        table.vkDestroyDevice(device, nullptr);
        vkDestroyInstance(instance, nullptr);
    }
    // How many queues this device has of a family: two, or one if the hardware has no more.
    uint32_t queue_count_of(uint32_t family) const { return std::min(families[family].queueCount, 2u); }
    AdoptedDevice adopted() const { return {instance, physical_device, device, queue, queue_family}; }

    VolkDeviceTable table{};
};

}  // namespace throng::test
