// EXT_meshopt_compression and KHR_meshopt_compression. They differ by what the latter adds, version 1 of the codec of
// attributes and the filter COLOR, which are read under either name.
// Source: "EXT_meshopt_compression" and "KHR_meshopt_compression", glTF extensions by Arseny Kapoulkine and others,
// decoded by his meshoptimizer; what our packages' version of it (0.18) lacks, by meshopt_attributes and meshopt_color.
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
