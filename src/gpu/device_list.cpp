#include "gpu/device_list.h"

#include "base/text.h"
#include "base/failure.h"
#include "gpu/native.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace throng {
namespace {

const char* type_name(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual";
        case VK_PHYSICAL_DEVICE_TYPE_CPU: return "cpu";
        default: return "other";
    }
}

// Lower is better.
int preference(const DeviceInfo& info) {
    constexpr std::array order{"discrete", "integrated", "virtual", "other", "cpu", kNativeType};
    return static_cast<int>(std::find(order.begin(), order.end(), info.type) - order.begin());
}

}  // namespace

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    return families;
}

std::optional<uint32_t> find_family(VkPhysicalDevice physical) {
    const std::vector<VkQueueFamilyProperties> families = queue_families(physical);
    for (const VkQueueFlags wanted :
         {VkQueueFlags{VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT}, VkQueueFlags{VK_QUEUE_COMPUTE_BIT}})
        for (uint32_t index = 0; index < families.size(); ++index)
            if ((families[index].queueFlags & wanted) == wanted) return index;
    return std::nullopt;
}

DeviceInfo describe(VkPhysicalDevice physical, uint32_t index) {
    VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
    VkPhysicalDeviceVulkan12Properties v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES, &v11};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v12};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    const auto& p = properties.properties;
    const bool is_null = v12.driverID == VK_DRIVER_ID_MESA_RADV &&
                         std::string_view(p.deviceName).starts_with("Null hardware");
    return {.index = index,
            .name = p.deviceName,
            .type = type_name(p.deviceType),
            .driver = std::string(v12.driverName) + (v12.driverInfo[0] ? " " : "") + v12.driverInfo,
            .api_version = p.apiVersion,
            .subgroup_size = v11.subgroupSize,
            .shared_memory_bytes = p.limits.maxComputeSharedMemorySize,
            .storage_buffer_range_bytes = p.limits.maxStorageBufferRange,
            .usable = !is_null && p.apiVersion >= kApiVersion && find_family(physical).has_value(),
            .compiles_only = is_null};
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
    uint32_t count = 0;
    const VkResult counted = vkEnumeratePhysicalDevices(instance, &count, nullptr);
    // The loader's answer where drivers are installed and none of them has hardware
    if (counted == VK_ERROR_INITIALIZATION_FAILED) return {};
    check(counted, "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> devices(count);
    check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
    devices.resize(count);
    return devices;
}

std::vector<DeviceInfo> describe_all(const std::vector<VkPhysicalDevice>& devices) {
    std::vector<DeviceInfo> infos;
    for (VkPhysicalDevice physical : devices) infos.push_back(describe(physical, static_cast<uint32_t>(infos.size())));
    infos.push_back(NativeDevice::info(static_cast<uint32_t>(infos.size())));
    return infos;
}

std::string unusable_reason(const DeviceInfo& info) {
    if (info.compiles_only) return "it only compiles, for hardware that this machine lacks, and can run nothing";
    return info.usable ? std::string() : "it lacks Vulkan 1.3 or a compute queue, and throng needs both";
}

bool is_native_name(const std::string& select) { return ascii_lower(select) == kNativeType; }

bool is_selected(const DeviceInfo& info, const std::string& select) {
    if (select.empty()) return true;
    uint32_t index = 0;
    const auto [end, parse] = std::from_chars(select.data(), select.data() + select.size(), index);
    if (parse == std::errc{} && end == select.data() + select.size()) return info.index == index;
    if (ascii_lower(select) == "cpu") return info.type == "cpu";
    // Only by its whole name: it contains the processor's name, which may also be part of a GPU's
    if (info.type == kNativeType) return is_native_name(select) || select == info.name;
    return ascii_lower(info.name).find(ascii_lower(select)) != std::string::npos;
}

DeviceInfo select_device(const std::vector<DeviceInfo>& infos, const std::string& select) {
    std::string names;
    for (const auto& info : infos)
        names += (names.empty() ? "" : ", ") + std::to_string(info.index) + " (" + info.name + ")";
    const auto refuse = [&](const std::string& why) -> Failure {
        return Failure(ErrorCode::kNoDevice, "device '" + select + "'", why + "; the devices are: " + names);
    };

    std::vector<DeviceInfo> candidates;
    std::ranges::copy_if(infos, std::back_inserter(candidates),
                         [&](const DeviceInfo& info) { return is_selected(info, select); });
    if (candidates.empty()) throw refuse("no such device");
    const std::string unusable = unusable_reason(candidates.front());
    std::erase_if(candidates, [](const DeviceInfo& info) { return !info.usable; });
    if (candidates.empty()) throw refuse(unusable);
    return *std::min_element(candidates.begin(), candidates.end(),
                             [](const auto& a, const auto& b) { return preference(a) < preference(b); });
}

}  // namespace throng
