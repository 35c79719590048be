// The devices of this machine, and which of them is meant. Callers hold the lock of volk's instance-level functions.
#pragma once

#include "gpu/vulkan.h"

#include <throng/device.h>

#include <optional>

namespace throng {

inline constexpr uint32_t kApiVersion = VK_API_VERSION_1_3;  // the least that throng works on
inline constexpr const char* kNativeType = "native";         // DeviceInfo::type of the native device, and its name

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice physical);
// The first family with compute, and with graphics too where the device has one such.
std::optional<uint32_t> find_family(VkPhysicalDevice physical);

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance);
DeviceInfo describe(VkPhysicalDevice physical, uint32_t index);
// With the native device, which is the last.
std::vector<DeviceInfo> describe_all(const std::vector<VkPhysicalDevice>& devices);

// Why nothing can run on it; empty where it can.
std::string unusable_reason(const DeviceInfo& info);
// Whether DeviceSettings::select names the native device and no other.
bool is_native_name(const std::string& select);
// Whether it means this device, maybe among others.
bool is_selected(const DeviceInfo& info, const std::string& select);
// The best of those that it means. Throws kNoDevice, and names all there are.
DeviceInfo select_device(const std::vector<DeviceInfo>& infos, const std::string& select);

}  // namespace throng
