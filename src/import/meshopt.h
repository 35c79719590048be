// EXT_meshopt_compression, and KHR_meshopt_compression where it is the same: without its newer attribute codec and its
// colour filter, which the meshoptimizer of our packages (0.18) does not have.
// Source: "EXT_meshopt_compression", glTF extension by Arseny Kapoulkine, decoded by his meshoptimizer.
#pragma once

#include "import/limits.h"
#include "json/json_view.h"

#include <memory>
#include <span>
#include <vector>

namespace throng::gltf {

// Decompresses a buffer view: `json` is its extension object, `compressed` the bytes that it names. The result is
// charged until the last copy of the pointer is gone.
std::shared_ptr<const std::vector<std::byte>> decode_meshopt(const JsonView& json,
                                                             std::span<const std::byte> compressed, Budget& budget);

}  // namespace throng::gltf
