// What a shader's SPIR-V says of itself: its bindings, push constants and local size.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

enum class BindingKind {
    kStorage,  // storage buffer
    kTexels,   // uniform texel buffer: usamplerBuffer
    kUniform,  // uniform buffer
    kImage,    // with its sampler
};

struct BindingInfo {
    uint32_t binding = 0;
    BindingKind kind = BindingKind::kStorage;
    uint32_t set = 0;
};

struct SpirvInfo {
    std::vector<BindingInfo> bindings;  // ascending by set, then binding
    uint32_t push_constant_bytes = 0;
    uint32_t local_size_x = 1;               // where it is not a specialization constant
    bool local_size_is_specialized = false;  // by constant_id 0
};

// Throws kInvalidArgument if this is not a SPIR-V module, or uses what throng's shaders do not.
SpirvInfo read_spirv(std::span<const uint32_t> words);

}  // namespace throng
