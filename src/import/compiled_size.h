// The size of meshes in a compiled character. A mesh counts once for each node that shows it.
#pragma once

#include <throng/asset.h>

#include <cstdint>
#include <string>

namespace throng {

struct CompiledSize {
    uint64_t section_count = 0;  // primitives that have triangles
    uint64_t size_bytes = 0;     // of vertices with their influences, of indices, and of the sections' names
};
CompiledSize compiled_size(const Asset& asset);

// The name of the sections of a mesh where a node shows it: the node's, or else the mesh's.
const std::string& section_name(const Asset& asset, const AssetMeshInstance& instance);

}  // namespace throng
