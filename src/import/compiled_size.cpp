#include "import/compiled_size.h"

#include <throng/character.h>

#include <algorithm>
#include <vector>

namespace throng {
namespace {

// Without names.
CompiledSize size_for_one_node(const AssetMesh& mesh) {
    CompiledSize size;
    for (const AssetPrimitive& primitive : mesh.primitives) {
        if (primitive.indices.empty()) continue;
        const uint64_t influence_sets = std::max(1u, primitive.influence_count / 4);
        ++size.section_count;
        size.size_bytes += primitive.positions.size() * (sizeof(Vertex) + influence_sets * sizeof(Influences)) +
                           primitive.indices.size() * sizeof(uint32_t);
    }
    return size;
}

}  // namespace

CompiledSize compiled_size(const Asset& asset) {
    std::vector<CompiledSize> of_meshes;
    for (const AssetMesh& mesh : asset.meshes) of_meshes.push_back(size_for_one_node(mesh));
    CompiledSize all;
    for (const AssetMeshInstance& instance : asset.mesh_instances) {
        const auto& [section_count, size_bytes] = of_meshes[instance.mesh];
        all.section_count += section_count;
        all.size_bytes += size_bytes + section_count * section_name(asset, instance).size();
    }
    return all;
}

const std::string& section_name(const Asset& asset, const AssetMeshInstance& instance) {
    const std::string& node_name = asset.nodes[instance.node].name;
    return node_name.empty() ? asset.meshes[instance.mesh].name : node_name;
}

}  // namespace throng
