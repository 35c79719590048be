// AMD's driver without its hardware: it compiles for the machine that it is told of.
#pragma once

#include "gpu/gpu.h"

#include <string>

namespace throng::bench {

// For a family that RADV_FORCE_FAMILY knows (bench/isa/machines.h). Looks for the driver where the Vulkan loader does,
// unless VK_DRIVER_FILES or VK_ICD_FILENAMES say where it is. Throws kNoDevice where it is not installed. The
// environment is changed while the device is made: other threads must not read it then.
std::shared_ptr<Gpu> open_compiler(const std::string& family);

}  // namespace throng::bench
