// The filter of colours that KHR_meshopt_compression brought. The meshoptimizer of our packages (0.18) lacks it.
// Source: "KHR_meshopt_compression", glTF extension by Arseny Kapoulkine and others, Appendix B, filter 4.
#pragma once

#include "json/json_view.h"

#include <cstddef>
#include <span>

namespace throng::gltf {

// Turns YCoCg and alpha into RGBA, of 8 bits each where an element has 4 bytes, of 16 where it has 8. An element whose
// number of bits is not allowed fails at the place of `json`.
void decode_colors(const JsonView& json, std::span<std::byte> elements, size_t stride_bytes);

}  // namespace throng::gltf
