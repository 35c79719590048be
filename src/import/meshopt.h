// EXT_meshopt_compression.
// Source: "EXT_meshopt_compression", glTF extension by Arseny Kapoulkine, decoded by his meshoptimizer.
#pragma once

#include "import/limits.h"
#include "json/json_view.h"

#include <vector>

namespace throng::gltf {

// Decompresses a buffer view: `json` is its extension object, `compressed` the bytes that it names.
std::vector<std::byte> decode_meshopt(const JsonView& json, std::span<const std::byte> compressed, Budget& budget);

}  // namespace throng::gltf
