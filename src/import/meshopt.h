// EXT_meshopt_compression, and KHR_meshopt_compression as far as it is the same: without its newer codec of attributes
// and its filter of colours, which the meshoptimizer of our packages (0.18) does not have.
// Source: "EXT_meshopt_compression", glTF extension by Arseny Kapoulkine, decoded by his meshoptimizer.
#pragma once

#include "import/limits.h"
#include "json/json_view.h"

#include <memory>
#include <span>
#include <vector>

namespace throng::gltf {

// Decompresses a buffer view: `json` is its extension object, `compressed` the bytes that it names. What is returned is
// charged for as long as somebody holds it.
std::shared_ptr<const std::vector<std::byte>> decode_meshopt(const JsonView& json,
                                                             std::span<const std::byte> compressed, Budget& budget);

}  // namespace throng::gltf
