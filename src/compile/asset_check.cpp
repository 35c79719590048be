#include "compile/asset_check.h"

#include "base/failure.h"
#include "base/finite.h"
#include "base/text.h"
#include "compile/limits.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace throng {
namespace {

class Checker {
public:
    explicit Checker(const Asset& asset) : asset_(asset) {}

    void run_on_rig() {
        each(asset_.nodes, "nodes", [&](const AssetNode& node) { check(node); });
        check_ancestors();
        each(asset_.skins, "skins", [&](const AssetSkin& skin) { check(skin); });
        each(asset_.meshes, "meshes", [&](const AssetMesh& mesh) {
            require_size_or_none(mesh.target_names, mesh.weights.size(), "target_names");
        });
        each(asset_.mesh_instances, "mesh_instances", [&](const AssetMeshInstance& instance) {
            require_index(instance.node, asset_.nodes.size(), "node", "nodes");
            require_index(instance.mesh, asset_.meshes.size(), "mesh", "meshes");
            require_size_or_none(instance.weights, asset_.meshes[instance.mesh].weights.size(), "weights");
        });
        require(std::ranges::is_sorted(asset_.mesh_instances, {}, &AssetMeshInstance::node),
                "mesh_instances must be ordered by node");
    }

    void run() {
        run_on_rig();
        each(asset_.materials, "materials", [&](const AssetMaterial& material) { check(material); });
        each(asset_.meshes, "meshes", [&](const AssetMesh& mesh) { check(mesh); });
        each(asset_.mesh_instances, "mesh_instances", [&](const AssetMeshInstance& instance) { check(instance); });
        each(asset_.clips, "clips", [&](const AssetClip& clip) { check(clip); });
    }

private:
    // Calls check_one(item) for each item; a failure in it names the item's place.
    template <class Items, class Check>
    void each(const Items& items, const char* name, const Check& check_one) {
        for (size_t i = 0; i < items.size(); ++i) {
            const size_t before = place_.size();
            place_ += joined(place_.empty() ? "" : ".", name, "[", i, "]");
            check_one(items[i]);
            place_.resize(before);
        }
    }

    template <class... Parts>
    void require(bool holds, const Parts&... message) const {
        if (holds) return;
        const std::string of_file = asset_.name.empty() || place_.empty() ? asset_.name : asset_.name + ": ";
        throw Failure(ErrorCode::kInvalidArgument, of_file + place_, message...);
    }
    void require_index(uint32_t index, size_t count, const char* what, const char* of) const {
        require(index < count, what, " is ", index, ", but there are ", count, " ", of);
    }
    void require_optional(uint32_t index, size_t count, const char* what, const char* of) const {
        if (index != kNone) require_index(index, count, what, of);
    }
    void require_size(const auto& items, uint64_t count, const char* what) const {
        require(items.size() == count, what, " has ", items.size(), " elements; ", count, " are needed");
    }
    void require_size_or_none(const auto& items, uint64_t count, const char* what) const {
        if (!items.empty()) require_size(items, count, what);
    }

    void check(const AssetNode& node) const {
        require_optional(node.parent, asset_.nodes.size(), "parent", "nodes");
        const auto& [rotation, translation, scale] = node.parent_from_node;
        const std::array q{rotation.x, rotation.y, rotation.z, rotation.w};
        require(all_finite(q) && all_finite(translation) && all_finite(scale), "parent_from_node is not finite");
        const double squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        require(std::abs(squared - 1) < 1e-3, "the rotation of parent_from_node is not of length 1");
    }

    // Follows each node's parents up to a root, or to a node that is already known to lead to one.
    void check_ancestors() {
        std::vector<uint32_t> seen_from(asset_.nodes.size(), kNone);
        for (uint32_t start = 0; start < asset_.nodes.size(); ++start)
            for (uint32_t node = start; node != kNone && seen_from[node] != start; node = asset_.nodes[node].parent) {
                if (seen_from[node] != kNone) break;
                seen_from[node] = start;
                const uint32_t parent = asset_.nodes[node].parent;
                require(parent == kNone || seen_from[parent] != start, "nodes[", node, "] is an ancestor of itself");
            }
    }

    void check(const AssetSkin& skin) const {
        require(!skin.joints.empty(), "joints is empty");
        for (const uint32_t joint : skin.joints) require_index(joint, asset_.nodes.size(), "a joint", "nodes");
        require_size(skin.inverse_binds, skin.joints.size(), "inverse_binds");
        for (const Affine& bind : skin.inverse_binds)
            for (const auto& row : bind.row) require(all_finite(row), "inverse_binds is not finite");
    }

    void check(const AssetMaterial& material) const {
        visit_images(
            [&](auto member) { require_optional(material.*member, asset_.images.size(), "an image", "images"); });
        require(all_finite(material.base_color) && all_finite(material.emissive) &&
                    all_finite(std::array{material.alpha_cutoff, material.metallic, material.roughness,
                                          material.normal_scale, material.occlusion_strength}),
                "a factor is not finite");
        require(has_known_values(material), "alpha_mode, filter, wrap_u or wrap_v has an unknown value");
    }

    void check(const AssetMesh& mesh) {
        followed_counts_.push_back(0);
        require(all_finite(mesh.weights), "weights are not finite");
        each(mesh.primitives, "primitives",
             [&](const AssetPrimitive& primitive) { check(primitive, mesh.weights.size()); });
    }

    void check(const AssetPrimitive& primitive, size_t target_count) {
        const size_t n = primitive.positions.size();
        require_optional(primitive.material, asset_.materials.size(), "material", "materials");
        require(all_finite(primitive.positions), "positions are not finite");
        require_size_or_none(primitive.normals, n, "normals");
        require_size_or_none(primitive.texcoords, n, "texcoords");
        require_size_or_none(primitive.colors, n, "colors");
        require(all_finite(primitive.normals) && all_finite(primitive.texcoords) && all_finite(primitive.colors),
                "normals, texcoords or colors are not finite");
        require(primitive.influence_count % 4 == 0, "influence_count is ", primitive.influence_count,
                ", not a multiple of 4: fill up with weights of 0");
        require_size(primitive.influence_joints, n * primitive.influence_count, "influence_joints");
        require_size(primitive.influence_weights, n * primitive.influence_count, "influence_weights");
        require(all_finite(primitive.influence_weights) &&
                    std::ranges::none_of(primitive.influence_weights, [](float weight) { return weight < 0; }),
                "influence_weights must be finite, and not negative");
        for (size_t i = 0; i < primitive.influence_joints.size(); ++i)
            if (primitive.influence_weights[i] > 0)
                followed_counts_.back() = std::max(followed_counts_.back(), primitive.influence_joints[i] + 1u);
        require(primitive.indices.size() % 3 == 0, "indices has ", primitive.indices.size(),
                " elements, which is not a multiple of 3");
        for (const uint32_t index : primitive.indices) require_index(index, n, "an index", "positions");
        if (n > 0 || !primitive.targets.empty())
            require(primitive.targets.size() == target_count, "targets has ", primitive.targets.size(), " elements; ",
                    target_count, " are needed, as many as the mesh's weights");
        each(primitive.targets, "targets", [&](const AssetMorphTarget& target) {
            require_size_or_none(target.positions, n, "positions");
            require_size_or_none(target.normals, n, "normals");
            require(all_finite(target.positions) && all_finite(target.normals), "positions or normals are not finite");
        });
    }

    void check(const AssetMeshInstance& instance) const {
        require_optional(instance.skin, asset_.skins.size(), "skin", "skins");
        require(all_finite(instance.weights), "weights are not finite");
        if (instance.skin == kNone) return;
        const uint32_t followed_count = followed_counts_[instance.mesh];
        if (followed_count > 0)
            require_index(followed_count - 1, asset_.skins[instance.skin].joints.size(), "a joint with weight",
                          "joints in its skin");
    }

    void check(const AssetClip& clip) {
        require(std::isfinite(static_cast<float>(clip.duration_s)) && clip.duration_s >= 0,
                "duration_s must be within a float's range, and not negative");
        const auto require_end = [&](const std::vector<float>& times_s) {
            require(times_s.back() <= static_cast<float>(clip.duration_s), "its last key, at ", times_s.back(),
                    " s, is after the clip's duration_s of ", clip.duration_s, " s");
        };
        std::set<std::pair<uint32_t, TrackTarget>> moved;
        each(clip.tracks, "tracks", [&](const AssetTrack& track) {
            require_index(track.node, asset_.nodes.size(), "node", "nodes");
            require(track.target <= last_of<TrackTarget>, "target has an unknown value");
            require(moved.emplace(track.node, track.target).second, "an earlier track has the same node and target");
            check_keys(track, track.target == TrackTarget::kRotation ? 4 : 3);
            require_end(track.times_s);
        });
        std::set<uint32_t> morphed;
        each(clip.morph_tracks, "morph_tracks", [&](const AssetMorphTrack& track) {
            require_index(track.node, asset_.nodes.size(), "node", "nodes");
            require(morphed.insert(track.node).second, "an earlier track has the same node");
            const auto meshes = std::ranges::equal_range(asset_.mesh_instances, track.node, {},
                                                         &AssetMeshInstance::node);
            size_t target_count = 0;  // at most one of a node's meshes should have any
            for (const AssetMeshInstance& instance : meshes)
                target_count = std::max(target_count, asset_.meshes[instance.mesh].weights.size());
            if (meshes.empty()) return;
            check_keys(track, target_count);
            require_end(track.times_s);
        });
    }

    void check_keys(const auto& track, uint64_t of_key) const {
        const std::vector<float>& times = track.times_s;
        require(!times.empty() && all_finite(times) && times.front() >= 0,
                "times_s must be finite, not negative and not empty");
        require(std::ranges::adjacent_find(times, std::greater_equal()) == times.end(), "times_s must increase");
        require(track.interpolation <= last_of<Interpolation>, "interpolation has an unknown value");
        const bool is_cubic = track.interpolation == Interpolation::kCubicSpline;
        require_size(track.values, times.size() * of_key * (is_cubic ? 3 : 1), "values");
        require(all_finite(track.values), "values are not finite");
    }

    const Asset& asset_;
    std::string place_;
    std::vector<uint32_t> followed_counts_;  // [mesh]: the largest joint index that has weight, plus 1
};

}  // namespace

void check_asset(const Asset& asset) { Checker(asset).run(); }
void check_rig(const Asset& asset) { Checker(asset).run_on_rig(); }

}  // namespace throng
