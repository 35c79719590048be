#define VOLK_IMPLEMENTATION
#include "gpu/vulkan.h"

#include "base/failure.h"

namespace throng {
namespace {

std::string result_name(VkResult result) {
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of host memory";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of device memory";
        case VK_ERROR_TOO_MANY_OBJECTS: return "too many objects, or allocations (maxMemoryAllocationCount)";
        case VK_ERROR_INITIALIZATION_FAILED: return "initialization failed";
        case VK_ERROR_DEVICE_LOST: return "device lost";
        case VK_ERROR_LAYER_NOT_PRESENT: return "layer not present";
        case VK_ERROR_EXTENSION_NOT_PRESENT: return "extension not present";
        case VK_ERROR_FEATURE_NOT_PRESENT: return "feature not present";
        case VK_ERROR_INCOMPATIBLE_DRIVER: return "incompatible driver";
        case VK_TIMEOUT: return "timeout";
        case VK_NOT_READY: return "not ready";
        default: return "VkResult " + std::to_string(result);
    }
}

}  // namespace

void check(VkResult result, const char* call) {
    if (result == VK_SUCCESS) return;
    const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
                        result == VK_ERROR_TOO_MANY_OBJECTS;
    const ErrorCode code = memory                           ? ErrorCode::kOutOfMemory
                           : result == VK_ERROR_DEVICE_LOST ? ErrorCode::kDeviceLost
                                                            : ErrorCode::kVulkan;
    throw Failure(code, {}, std::string(call) + ": " + result_name(result));
}

}  // namespace throng
