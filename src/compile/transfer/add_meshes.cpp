// Meshes of another file, for a rig whose joints have the same names.
#include <throng/asset.h>

#include "base/count.h"
#include "base/failure.h"
#include "base/finite.h"
#include "base/text.h"
#include "compile/asset_check.h"
#include "compile/transfer/names.h"
#include "compile/transfer/rig_transfer.h"
#include "import/compiled_size.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <unordered_set>
#include <vector>

namespace throng {
namespace {

// The joints of an asset and the nodes above them, without clips and meshes. Other nodes have no names here: one that
// is called the same in another file ("grip", "Object_7", or a mesh "Hair") is another thing.
Asset rig_of(const Asset& asset) {
    const std::vector<bool> is_joint = joints_of(asset);
    std::vector<bool> is_of_rig = is_joint;
    for (uint32_t node = 0; node < asset.nodes.size(); ++node) {
        if (!is_joint[node]) continue;
        for (uint32_t above = asset.nodes[node].parent; above != kNone && !is_of_rig[above];
             above = asset.nodes[above].parent)
            is_of_rig[above] = true;
    }
    Asset rig{.name = asset.name, .nodes = asset.nodes, .skins = asset.skins};
    for (uint32_t node = 0; node < rig.nodes.size(); ++node)
        if (!is_of_rig[node]) rig.nodes[node].name.clear();
    return rig;
}

// Collects what the meshes of `from` need, numbered as behind that of `to`.
class MeshAdder {
public:
    MeshAdder(const Asset& from, const Asset& to)
        : from_(from),
          to_(to),
          rig_(rig_of(to)),
          is_joint_(joints_of(to)),
          fit_(rig_, from, is_joint_),
          size_ratio_(fit_.is_same_skeleton() ? 1 : 1 / fit_.size_ratio()),
          old_frames_(rest_frames(from)),
          frames_(rest_frames(to)),
          nodes_(from.nodes.size(), kNone),
          skins_(from.skins.size(), kNone) {
        for (const AssetMeshInstance& instance : to.mesh_instances) section_names_.insert(section_name(to, instance));
        add_materials();
        for (const AssetMesh& mesh : from.meshes) add_mesh(mesh);
        for (const AssetMeshInstance& instance : from.mesh_instances) add_instance(instance);
    }

    // Whether meshes follow any joint that `to` has.
    bool follows() const { return follows_; }
    // Names of joints that `to` lacks.
    const NameList& added_joints() const { return added_joints_; }
    size_t joint_count() const { return joints_.size(); }

    // Reserves first, so that nothing fails half-way after that.
    void commit(Asset& to, std::vector<std::string> warnings) {
        const auto each = [&](const auto& apply) {
            apply(to.nodes, added_.nodes);
            apply(to.skins, added_.skins);
            apply(to.meshes, added_.meshes);
            apply(to.mesh_instances, added_.mesh_instances);
            apply(to.materials, added_.materials);
            apply(to.images, added_.images);
            apply(to.warnings, warnings);
        };
        each([](auto& all, const auto& more) { all.reserve(all.size() + more.size()); });
        each([](auto& all, auto& more) { std::ranges::move(more, std::back_inserter(all)); });
    }

private:
    // Equal images, such as the palette of colours that the files of one artist share, are taken once.
    uint32_t image_of(uint32_t image) {
        if (image == kNone) return kNone;
        const auto found = images_.find(image);
        if (found != images_.end()) return found->second;
        const AssetImage& wanted = from_.images[image];
        const auto same = std::ranges::find(to_.images, wanted.encoded, &AssetImage::encoded);
        uint32_t number = static_cast<uint32_t>(same - to_.images.begin());
        if (same == to_.images.end() || wanted.encoded.empty()) {
            number = count_of(to_.images) + count_of(added_.images);
            added_.images.push_back(wanted);
        }
        images_.emplace(image, number);
        return number;
    }

    void add_materials() {
        for (AssetMaterial material : from_.materials) {
            visit_images([&](auto member) { material.*member = image_of(material.*member); });
            added_.materials.push_back(std::move(material));
        }
    }

    void add_mesh(const AssetMesh& mesh) {
        added_.meshes.push_back(mesh);
        for (AssetPrimitive& primitive : added_.meshes.back().primitives)
            if (primitive.material != kNone) primitive.material += count_of(to_.materials);
    }

    // Each gets a node of its own, whose number is above those of earlier ones.
    void add_instance(const AssetMeshInstance& instance) {
        const AssetNode& old = from_.nodes[instance.node];
        // A joint goes on moving its mesh, which gets a node below it. So does a node that stands for another already.
        const bool is_joint = !from_.skins.empty() && fit_.is_joint(instance.node);
        const bool is_known = fit_.source(instance.node) != kNone || nodes_[instance.node] != kNone;
        const bool is_below = is_joint || is_known;
        const uint32_t parent = node_of(is_below ? instance.node : old.parent);
        AssetMeshInstance added = instance;
        added.node = is_below ? add_node(instance.node, parent, {}, {})
                              : add_node(old.parent, parent, {}, old.parent_from_node);
        if (!is_below) nodes_[instance.node] = added.node;
        const std::string& name = section_name(from_, instance);
        const auto [renamed, is_new] = new_names_.try_emplace(name);  // meshes that share a name keep sharing one
        if (is_new) renamed->second = section_names_.add(name, name.empty(), stem_of(from_.name, "mesh"));
        added_.nodes.back().name = renamed->second;
        added.mesh += count_of(to_.meshes);
        if (instance.skin != kNone)
            added.skin = skin_of(instance.skin);
        else
            follows_ = follows_ || hangs_on_joint(parent);
        added_.mesh_instances.push_back(std::move(added));
    }

    // Whether a node of `to`, or an added one, is a joint of `to` or below one.
    bool hangs_on_joint(uint32_t node) const {
        while (node != kNone && node >= to_.nodes.size()) node = added_.nodes[node - to_.nodes.size()].parent;
        return node != kNone && is_joint_[node];
    }

    uint32_t skin_of(uint32_t skin) {
        if (skins_[skin] != kNone) return skins_[skin];
        AssetSkin added = from_.skins[skin];
        for (size_t i = 0; i < added.joints.size(); ++i) {
            const uint32_t old = added.joints[i];
            const bool is_there = fit_.source(old) != kNone;
            follows_ = follows_ || is_there;
            if (joints_.insert(old).second && !is_there) added_joints_.add(from_.nodes[old].name);
            added.joints[i] = node_of(old);
            const double factor = factor_of(old, added.joints[i]);
            if (factor == 1) continue;
            for (auto& row : added.inverse_binds[i].row)
                for (float& number : row) number = static_cast<float>(number * factor);
            if (!all_finite(added.inverse_binds[i])) refuse_overflow();
        }
        skins_[skin] = count_of(to_.skins) + count_of(added_.skins);
        added_.skins.push_back(std::move(added));
        return skins_[skin];
    }

    // The node that stands for one of `from`: the one of the same name or, where there is none, a new one.
    uint32_t node_of(uint32_t old) {
        if (old == kNone) return kNone;
        // From the node upwards, as deep as hierarchies may be: no recursion.
        std::vector<uint32_t> missing;
        uint32_t above = old;
        for (; above != kNone && nodes_[above] == kNone && fit_.source(above) == kNone;
             above = from_.nodes[above].parent)
            missing.push_back(above);
        uint32_t node = above == kNone ? kNone : nodes_[above] != kNone ? nodes_[above] : fit_.source(above);
        for (; !missing.empty(); missing.pop_back()) {
            const uint32_t next = missing.back();
            const AssetNode& wanted = from_.nodes[next];
            node = nodes_[next] = add_node(wanted.parent, node, wanted.name, wanted.parent_from_node);
        }
        return node;
    }

    // A node below `parent`, which stands for `old_parent`.
    uint32_t add_node(uint32_t old_parent, uint32_t parent, const std::string& name, Trs<double> parent_from_node) {
        const double factor = factor_of(old_parent, parent);
        parent_from_node.translation = parent_from_node.translation * factor;
        parent_from_node.scale = parent_from_node.scale * factor;
        if (!all_finite(parent_from_node)) refuse_overflow();
        frames_.push_back((parent == kNone ? NodeFrame() : frames_[parent]).child(parent_from_node));
        added_.nodes.push_back({.name = name, .parent = parent, .parent_from_node = parent_from_node});
        return count_of(frames_) - 1;
    }

    [[noreturn]] void refuse_overflow() const {
        refuse(from_.name, "its rig differs so much in size from that of ", to_.name, " that numbers overflow");
    }

    // How much larger numbers have to be in the space of a node than in that of the old one.
    double factor_of(uint32_t old, uint32_t node) const {
        const double before = old == kNone ? 1 : old_frames_[old].scale, now = node == kNone ? 1 : frames_[node].scale;
        const double factor = before > 0 && now > 0 ? before / now * size_ratio_ : 1;
        constexpr double kRounding = 1e-5;
        return std::abs(factor - 1) < kRounding ? 1 : factor;
    }

    const Asset &from_, &to_;
    const Asset rig_;                             // of `to`
    const std::vector<bool> is_joint_;            // [node of `to`]
    const RigTransfer fit_;                       // from nodes of rig_ to those of `from`
    const double size_ratio_;                     // of `to` to `from`
    std::vector<NodeFrame> old_frames_, frames_;  // [node of `from`]; [node of `to`, then added nodes]
    std::vector<uint32_t> nodes_, skins_;         // [node or skin of `from`]: the added one, or kNone
    std::map<uint32_t, uint32_t> images_;         // image of `from` -> image
    UniqueNames section_names_;
    std::map<std::string, std::string> new_names_;  // by the names in `from`
    std::unordered_set<uint32_t> joints_;           // of `from`, that meshes follow
    NameList added_joints_;
    bool follows_ = false;
    Asset added_;
};

}  // namespace

Result<void> add_meshes(Asset& asset, const Asset& from) {
    return as_result(
        [&] {
            check_asset(asset);
            check_asset(from);
            if (from.mesh_instances.empty()) refuse(from.name, "has no meshes to add to ", asset.name);
            MeshAdder adder(from, asset);
            if (!adder.follows())
                refuse(from.name, "its meshes follow none of the joints of ", asset.name, ", which has ",
                       some_joints(asset, joints_of(asset)), ", …: meshes are added to joints of the same names");
            std::vector<std::string> warnings = new_warnings(asset, from, [](const std::string& line) {
                return line.find(": animations[") == line.npos;  // these stay behind
            });
            if (const NameList& added = adder.added_joints(); added.count() > 0)
                warnings.push_back(joined(from.name, ": ", added.count(), " of its ", adder.joint_count(), " joints (",
                                          added.text(), ") are not in ", asset.name,
                                          " and are added: no clip moves them"));
            adder.commit(asset, std::move(warnings));
        },
        from.name);
}

}  // namespace throng
