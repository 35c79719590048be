// A shader of the library's own, as the build compiles it: shaders.h, which the build makes, declares one for each file
// <name>.comp, and <name>_<kind> for a .vert or .frag.
#pragma once

#include "gpu/gpu.h"

#include <span>

namespace throng {

struct Shader {
    std::span<const uint32_t> plain;     // SPIR-V
    std::span<const uint32_t> software;  // with GPU_SOFTWARE (gpu/stored.glsl, gpu/table.glsl); empty: the same

    std::span<const uint32_t> words(const Gpu& gpu) const {
        return gpu.uses_software_kernels() && !software.empty() ? software : plain;
    }
};

}  // namespace throng
