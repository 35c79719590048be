// Vulkan through volk: no link-time loader, and one function table per device, so that several devices live side by
// side.
#pragma once

#include <volk.h>

#include <string>

namespace throng {

// Throws Failure(kVulkan, kOutOfMemory or kDeviceLost) naming the call and its result.
void check(VkResult result, const char* call);

}  // namespace throng
