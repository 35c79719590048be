#include "base/count.h"
#include "import/compiled_size.h"
#include "import/readers.h"

namespace throng::gltf {
namespace {

enum : uint8_t { kUnknown, kShown, kHidden };

bool is_hidden(const JsonView& node) {
    const auto visibility = node.extension("KHR_node_visibility");
    return visibility && !visibility->optional_bool("visible", true);
}

// Which nodes are shown: the nodes of the default scene and all below them, except hidden nodes and all below those. If
// there are no scenes, all roots are shown.
std::vector<uint8_t> shown_nodes(Reading& reading, const Asset& asset) {
    const JsonView scenes = reading.root.optional_array("scenes"), nodes = reading.root.optional_array("nodes");
    const uint32_t scene_index = reading.root.optional_index("scene", scenes.size(), "scenes");
    std::vector<uint8_t> state(asset.nodes.size(), kUnknown);
    if (scenes.size() > 0)
        for (const JsonView root : scenes[scene_index == kNone ? 0 : scene_index].optional_array("nodes")) {
            const uint32_t node = root.as_index(asset.nodes.size(), "nodes");
            if (asset.nodes[node].parent != kNone) reading.warnings.add(root.place(), "is not a root node");
            state[node] = kShown;
        }
    for (uint32_t node = 0; node < asset.nodes.size(); ++node)
        if (is_hidden(nodes[node])) state[node] = kHidden;
    // Goes up to the first node whose state is known, or to the root, so each node is passed once. Not recursive, since
    // chains can be deep.
    std::vector<uint32_t> way;
    for (uint32_t start = 0; start < asset.nodes.size(); ++start) {
        way.clear();
        uint32_t node = start;
        for (; node != kNone && state[node] == kUnknown; node = asset.nodes[node].parent) way.push_back(node);
        const uint8_t found = node != kNone ? state[node] : scenes.size() > 0 ? uint8_t(kHidden) : uint8_t(kShown);
        for (const uint32_t passed : way) state[passed] = found;
    }
    return state;
}

// Joints of weight 0 do not count: read_primitive() has set them to 0, except for the first joint of a vertex without
// weight, which compile/mesh/mesh.cpp handles.
void check_joints(const NeededJoints& needed, const Asset& asset, uint32_t skin) {
    const size_t joint_count = asset.skins[skin].joints.size();
    if (needed.count > joint_count)
        throw Failure(ErrorCode::kInvalidFile, needed.place, "vertex ", needed.vertex, " follows joint ",
                      needed.count - 1, ", but skins[", skin, "] has ", joint_count, " joints");
}

}  // namespace

void read_mesh_instances(Reading& reading, std::span<const NeededJoints> of_meshes, Asset& asset) {
    const JsonView nodes = reading.root.optional_array("nodes");
    const std::vector<uint8_t> state = shown_nodes(reading, asset);
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        reading.budget.poll_at(i);
        const JsonView json = nodes[i];
        AssetMeshInstance instance{.node = i,
                                   .mesh = json.optional_index("mesh", asset.meshes.size(), "meshes"),
                                   .skin = json.optional_index("skin", asset.skins.size(), "skins")};
        if (instance.mesh == kNone || state[i] != kShown) continue;
        if (instance.skin != kNone) check_joints(of_meshes[instance.mesh], asset, instance.skin);
        instance.weights = read_morph_weights(reading, json, count_of(asset.meshes[instance.mesh].weights));
        asset.mesh_instances.push_back(std::move(instance));
    }
    reading.budget.require_room_for_compiled(compiled_size(asset).size_bytes);
}

}  // namespace throng::gltf
