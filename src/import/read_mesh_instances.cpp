#include "base/count.h"
#include "import/readers.h"

#include <set>

namespace throng::gltf {
namespace {

enum : uint8_t { kUnknown, kInside, kOutside };

// Which nodes the default scene reaches: those that it names and all below them.
std::vector<uint8_t> nodes_of_scene(Reading& reading, const Asset& asset) {
    const JsonView scenes = reading.root.optional_array("scenes");
    const uint32_t scene_index = reading.root.optional_index("scene", scenes.size(), "scenes");
    std::vector<uint8_t> state(asset.nodes.size(), scenes.size() == 0 ? kInside : kUnknown);
    if (scenes.size() == 0) return state;
    const JsonView roots = scenes[scene_index == kNone ? 0 : scene_index].optional_array("nodes");
    for (const JsonView root : roots) {
        const uint32_t node = root.as_index(asset.nodes.size(), "nodes");
        if (asset.nodes[node].parent != kNone) reading.warnings.add(root.place(), "is not a root");
        state[node] = kInside;
    }
    // Goes up to the first node that is known, or to the root: each node is passed once. No recursion: chains can be
    // deep.
    std::vector<uint32_t> way;
    for (uint32_t start = 0; start < asset.nodes.size(); ++start) {
        way.clear();
        uint32_t node = start;
        for (; node != kNone && state[node] == kUnknown; node = asset.nodes[node].parent) way.push_back(node);
        const uint8_t found = node == kNone ? uint8_t(kOutside) : state[node];
        for (const uint32_t passed : way) state[passed] = found;
    }
    return state;
}

// Joints of weight 0 are not looked at: they are 0, or the first of a vertex without weight (compile/mesh/mesh.cpp).
void check_influences(const JsonView& meshes, const Asset& asset, const AssetMeshInstance& instance) {
    const size_t joint_count = asset.skins[instance.skin].joints.size();
    const auto& primitives = asset.meshes[instance.mesh].primitives;
    for (size_t p = 0; p < primitives.size(); ++p) {
        const auto& joints = primitives[p].influence_joints;
        const auto& weights = primitives[p].influence_weights;
        size_t influence = 0;
        while (influence < joints.size() && (joints[influence] < joint_count || weights[influence] == 0)) ++influence;
        if (influence == joints.size()) continue;
        const size_t vertex = influence / primitives[p].influence_count;
        const size_t set = influence % primitives[p].influence_count / 4;
        throw Failure(ErrorCode::kInvalidFile,
                      joined(meshes[instance.mesh].place(), ".primitives[", p, "].attributes.JOINTS_", set), "vertex ",
                      vertex, " follows joint ", joints[influence], ", but skins[", instance.skin, "] has ",
                      joint_count);
    }
}

}  // namespace

void read_mesh_instances(Reading& reading, Asset& asset) {
    const JsonView nodes = reading.root.optional_array("nodes");
    const std::vector<uint8_t> in_scene = nodes_of_scene(reading, asset);
    const JsonView meshes = reading.root.optional_array("meshes");
    std::set<std::pair<uint32_t, uint32_t>> checked;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        const JsonView json = nodes[i];
        AssetMeshInstance instance{.node = i,
                                   .mesh = json.optional_index("mesh", asset.meshes.size(), "meshes"),
                                   .skin = json.optional_index("skin", asset.skins.size(), "skins")};
        if (instance.mesh == kNone || in_scene[i] != kInside) continue;
        if (instance.skin != kNone && checked.emplace(instance.mesh, instance.skin).second)
            check_influences(meshes, asset, instance);
        instance.weights = read_morph_weights(reading, json, count_of(asset.meshes[instance.mesh].weights));
        asset.mesh_instances.push_back(std::move(instance));
    }
}

}  // namespace throng::gltf
