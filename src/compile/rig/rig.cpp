#include "compile/rig/rig.h"

#include "base/failure.h"
#include "compile/limits.h"

#include <algorithm>
#include <optional>

namespace throng {
namespace {

// What the choice of joints needs to know of each node.
struct NodeFacts {
    std::vector<bool> animated, skin_joint;

    explicit NodeFacts(const Asset& asset) : animated(asset.nodes.size()), skin_joint(asset.nodes.size()) {
        for (const AssetClip& clip : asset.clips)
            for (const AssetTrack& track : clip.tracks) animated[track.node] = true;
        for (const AssetSkin& skin : asset.skins)
            for (uint32_t joint : skin.joints) skin_joint[joint] = true;
    }
    bool moves(uint32_t node) const { return animated[node] || skin_joint[node]; }
};

// Whether a mesh is drawn, and whether a primitive of it that is drawn has no influences, and so stays rigid even at
// nodes with a skin.
struct MeshFacts {
    bool drawn = false, partly_rigid = false;

    explicit MeshFacts(const AssetMesh& mesh) {
        for (const AssetPrimitive& primitive : mesh.primitives) {
            if (!is_drawn(primitive)) continue;
            drawn = true;
            partly_rigid = partly_rigid || primitive.influence_count == 0;
        }
    }
    bool is_rigid(uint32_t skin) const { return skin == kNone ? drawn : partly_rigid; }
};

// Nodes that must be joints: those of skins, and for each rigid mesh the nearest node at or above it that moves (else
// its root).
std::vector<bool> needed_joints(const Asset& asset, const NodeFacts& facts) {
    std::vector<uint32_t> nearest(asset.nodes.size());
    for (const uint32_t node : parents_first(asset)) {
        const uint32_t parent = asset.nodes[node].parent;
        nearest[node] = facts.moves(node) || parent == kNone ? node : nearest[parent];
    }
    const std::vector<MeshFacts> of_meshes(asset.meshes.begin(), asset.meshes.end());
    std::vector<bool> needed = facts.skin_joint;
    for (const auto& [node, mesh, skin, weights] : asset.mesh_instances)
        if (of_meshes[mesh].is_rigid(skin)) needed[nearest[node]] = true;
    return needed;
}

std::optional<Similarity> as_similarity(const Trs<double>& trs) {
    if (trs.scale.x != trs.scale.y || trs.scale.x != trs.scale.z) return std::nullopt;
    return Similarity{trs.rotation, trs.translation, trs.scale.x};
}

}  // namespace

void measure_rig(Rig& rig) {
    std::vector<uint32_t> depth(rig.joint_count());
    std::vector<bool> has_child(rig.joint_count());
    double depth_sum = 0;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        const uint32_t parent = rig.parents[joint];
        depth[joint] = parent == kNone ? 1 : depth[parent] + 1;
        if (parent != kNone) has_child[parent] = true;
        depth_sum += depth[joint];
        rig.level_count = std::max(rig.level_count, depth[joint]);
    }
    rig.mean_depth = depth_sum / rig.joint_count();
    rig.leaf_count = static_cast<uint32_t>(std::count(has_child.begin(), has_child.end(), false));
}

Vec3<double> Similarity::vector(const Vec3<double>& v) const {
    const Vec3<double> axis{rotation.x, rotation.y, rotation.z};
    const Vec3<double> t = cross(axis, v) * 2.0;
    return (v + t * rotation.w + cross(axis, t)) * scale;
}

RigMap build_rig(const Asset& asset) {
    const auto node_count = static_cast<uint32_t>(asset.nodes.size());
    const NodeFacts facts(asset);
    const std::vector<bool> needed = needed_joints(asset, facts);

    std::vector<bool> kept = needed;  // the loop below adds all nodes above them
    for (uint32_t node = 0; node < node_count; ++node) {
        if (!needed[node]) continue;
        for (uint32_t up = asset.nodes[node].parent; up != kNone && !kept[up]; up = asset.nodes[up].parent)
            kept[up] = true;
    }
    std::vector<std::vector<uint32_t>> children(node_count);
    std::vector<uint32_t> roots;
    for (uint32_t node = 0; node < node_count; ++node) {
        if (!kept[node]) continue;
        const uint32_t parent = asset.nodes[node].parent;
        (parent == kNone ? roots : children[parent]).push_back(node);
    }
    if (roots.empty())
        throw Failure(ErrorCode::kUnsupported, asset.name, "no skin and no triangles: there is nothing to draw",
                      asset.clips.empty() ? ""
                                          : ", only animation; add_clips() and 'throng compile CHARACTER --clips FILE' "
                                            "add it to a character");

    RigMap map;
    map.joint_of_node.assign(node_count, kNone);
    struct Visit {
        uint32_t node, parent_joint;
        Similarity prefix;
    };
    std::vector<Visit> stack;
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, kNone, {}});
    while (!stack.empty()) {
        Visit visit = stack.back();
        stack.pop_back();
        const AssetNode& node = asset.nodes[visit.node];
        const std::optional<Similarity> similarity = as_similarity(node.parent_from_node);
        uint32_t joint = visit.parent_joint;
        Similarity prefix;
        if (!needed[visit.node] && !facts.animated[visit.node] && similarity) {
            prefix = visit.prefix * *similarity;
            ++map.folded_node_count;
        } else {
            if (map.rig.parents.size() == kJointLimit)
                throw Failure(ErrorCode::kLimit, asset.name, "needs more joints than the limit of ", kJointLimit);
            joint = map.rig.joint_count();
            map.joint_of_node[visit.node] = joint;
            map.rig.names.push_back(node.name);
            map.rig.parents.push_back(visit.parent_joint);
            map.rig.nodes.push_back(visit.node);
            map.rig.rest.push_back((visit.prefix * node.parent_from_node).as<float>());
            map.parent_from_prefix.push_back(visit.prefix);
        }
        const auto& below = children[visit.node];
        for (auto child = below.rbegin(); child != below.rend(); ++child) stack.push_back({*child, joint, prefix});
    }
    measure_rig(map.rig);
    return map;
}

std::vector<uint32_t> parents_first(const Asset& asset) {
    std::vector<std::vector<uint32_t>> children(asset.nodes.size());
    std::vector<uint32_t> order;
    for (uint32_t node = 0; node < asset.nodes.size(); ++node) {
        const uint32_t parent = asset.nodes[node].parent;
        (parent == kNone ? order : children[parent]).push_back(node);
    }
    for (size_t i = 0; i < order.size(); ++i)
        for (const uint32_t child : children[order[i]]) order.push_back(child);
    return order;
}

std::vector<RigidAnchor> rigid_anchors(const Asset& asset, const RigMap& map) {
    std::vector<RigidAnchor> anchors(asset.nodes.size());
    for (const uint32_t node : parents_first(asset)) {
        const uint32_t parent = asset.nodes[node].parent;
        if (map.joint_of_node[node] != kNone)
            anchors[node].joint = map.joint_of_node[node];
        else if (parent != kNone)
            anchors[node] = {anchors[parent].joint,
                             anchors[parent].joint_from_mesh * to_affine(asset.nodes[node].parent_from_node)};
    }
    return anchors;
}

}  // namespace throng
