// The devices of this machine, and which of them DeviceSettings::select means. Callers hold the lock of volk's
// instance-level functions.
#pragma once

#include "gpu/vulkan.h"

#include <throng/device.h>

#include <optional>

namespace throng {

inline constexpr uint32_t kApiVersion = VK_API_VERSION_1_3;  // the least that throng works on
inline constexpr const char* kNativeType = "native";         // DeviceInfo::type of the native device, and its name

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice physical);
// The first family with compute and graphics or, if there is none, the first with compute.
std::optional<uint32_t> find_family(VkPhysicalDevice physical);

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance);
DeviceInfo describe(VkPhysicalDevice physical, uint32_t index);
// All devices; the native device is the last.
std::vector<DeviceInfo> describe_all(const std::vector<VkPhysicalDevice>& devices);

// Why nothing can run on the device; empty if it is usable.
std::string unusable_reason(const DeviceInfo& info);
// Whether DeviceSettings::select names the native device and no other.
bool is_native_name(const std::string& select);
// Whether `select` means this device, perhaps among others.
bool is_selected(const DeviceInfo& info, const std::string& select);
// The best device that `select` means. If there is none, throws kNoDevice and names all devices.
DeviceInfo select_device(const std::vector<DeviceInfo>& infos, const std::string& select);

}  // namespace throng
