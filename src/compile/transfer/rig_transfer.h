// Converts local transforms of one file's nodes to those of another file's nodes with the same names.
#pragma once

#include "compile/transfer/animated_nodes.h"

#include <throng/asset.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace throng {

// model_from_node, with a scale that is the same along all axes, or nearly so.
struct NodeFrame {
    Quaternion<double> rotation{};
    Vec3<double> origin{};
    double scale = 1;

    NodeFrame child(const Trs<double>& parent_from_node) const;
};

// [node], in the rest pose.
std::vector<NodeFrame> rest_frames(const Asset& asset);

// [node]: whether it is a joint of a skin; where there is no skin, all are.
std::vector<bool> joints_of(const Asset& asset);

// How a local transform of a node of `from` changes for a node of `to`: a rotation becomes turn * rotation, a
// translation base + turn * scale * (translation - old_rest).
struct NodeChange {
    bool is_turned = false;     // else `turn` is the identity, and rotations stay as they are, bit for bit
    Quaternion<double> turn{};  // new_parent_from_old_parent
    double scale = 1;           // ratio of units; times that of sizes, unless it is a bone of the same length
    // If a bone keeps its own length: the rest pose's translation in `from`, and in `to`. For a root, or a joint below
    // a root that `from` lacks: 0, and the offset from the new parent to the place of the old one. Else 0.
    Vec3<double> old_rest{}, base{};

    Quaternion<double> rotation(const Quaternion<double>& old) const { return turn * old; }
    Vec3<double> translation(const Vec3<double>& old) const { return base + vector(old - old_rest); }
    // The same without the offsets, for vectors such as tangents of splines.
    Vec3<double> vector(const Vec3<double>& old) const;
    bool keeps_translations() const {
        return !is_turned && scale == 1 && old_rest == Vec3<double>() && base == Vec3<double>();
    }
};

// Joints get the model-space rotations that they have in `from`, whatever nodes are above the rig or between a joint
// and its parent. The exception: if `to` lacks such a node and clips rotate it, only its rest rotation counts. Bones of
// another length keep their own length; other translations are scaled by the ratio of mean bone lengths.
class RigTransfer {
public:
    // `comes_first`: the nodes of `from` that are matched before others of the same name; by default those that move.
    RigTransfer(const Asset& from, const Asset& to, std::optional<std::vector<bool>> comes_first = {});

    // The node of `from` that a node of `to` moves like, or kNone.
    uint32_t source(uint32_t node) const { return sources_[node]; }
    // The nodes of `to` that move like this node of `from`.
    const std::vector<uint32_t>& targets(uint32_t source) const { return targets_[source]; }
    const NodeChange& change(uint32_t node) const { return changes_[node]; }
    // What the clips of `from` do to a node of `from`.
    const AnimatedNode& animated(uint32_t source) const { return animated_[source]; }
    bool is_joint(uint32_t node) const { return is_joint_[node]; }
    // The mean length of bones in `to` over that in `from`; 1 where all are as long.
    double size_ratio() const { return size_ratio_; }
    // Whether nearly all bones are as long in both.
    bool is_same_skeleton() const { return is_same_skeleton_; }
    // Whether the node takes over a track. `holds_rest`: the track never leaves the rest pose of `from`. Exporters
    // write such tracks for the node that holds a rig ("Armature"). In `to` this node may be rotated and scaled in
    // another way, so it keeps its own rest pose.
    bool takes(uint32_t node, bool holds_rest) const { return is_joint_[node] || !holds_rest; }

private:
    bool is_bone(uint32_t node) const;
    double old_length(uint32_t source) const;
    double new_length(uint32_t node) const;
    bool is_as_long(uint32_t node) const;
    void compare_bones();
    Vec3<double> offset_of_parent(const NodeFrame& old_parent, const NodeFrame& parent) const;
    NodeChange change_of(uint32_t node, const NodeFrame& parent) const;
    Trs<double> rest_of(uint32_t node) const;

    const Asset &from_, &to_;
    std::vector<AnimatedNode> animated_;  // [node of `from`]
    std::vector<bool> is_joint_;          // [node of `to`]
    std::vector<uint32_t> sources_;       // [node of `to`]
    std::vector<std::vector<uint32_t>> targets_;
    std::vector<NodeFrame> old_frames_;  // [node of `from`] in its rest pose
    std::vector<NodeFrame> frames_;      // [node of `to`] in its rest pose; later, posed by the rest pose of `from`
    std::vector<NodeChange> changes_;
    bool is_same_skeleton_ = true;
    double size_ratio_ = 1;
};

}  // namespace throng
