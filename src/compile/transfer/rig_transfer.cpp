#include "compile/transfer/rig_transfer.h"

#include "compile/rig/rig.h"
#include "compile/transfer/node_names.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr double kRounding = 1e-5;  // of rotations, and of factors near 1

Quaternion<double> conjugate(const Quaternion<double>& q) { return {-q.x, -q.y, -q.z, q.w}; }

Vec3<double> rotated(const Quaternion<double>& q, const Vec3<double>& v) {
    const Quaternion<double> out = q * Quaternion<double>{v.x, v.y, v.z, 0} * conjugate(q);
    return {out.x, out.y, out.z};
}

NodeFrame frame_of(const std::vector<NodeFrame>& frames, uint32_t node) {
    return node == kNone ? NodeFrame() : frames[node];
}

}  // namespace

std::vector<bool> joints_of(const Asset& asset) {
    std::vector<bool> is_joint(asset.nodes.size(), asset.skins.empty());
    for (const AssetSkin& skin : asset.skins)
        for (const uint32_t node : skin.joints) is_joint[node] = true;
    return is_joint;
}

std::vector<NodeFrame> rest_frames(const Asset& asset) {
    std::vector<NodeFrame> frames(asset.nodes.size());
    for (const uint32_t node : parents_first(asset))
        frames[node] = frame_of(frames, asset.nodes[node].parent).child(asset.nodes[node].parent_from_node);
    return frames;
}

NodeFrame NodeFrame::child(const Trs<double>& parent_from_node) const {
    const auto& [q, t, s] = parent_from_node;
    return {normalized(rotation * q), origin + rotated(rotation, t * scale),
            scale * std::cbrt(std::abs(s.x * s.y * s.z))};
}

Vec3<double> NodeChange::vector(const Vec3<double>& old) const { return rotated(turn, old * scale); }

RigTransfer::RigTransfer(const Asset& from, const Asset& to, std::optional<std::vector<bool>> comes_first)
    : from_(from),
      to_(to),
      animated_(animated_nodes(from)),
      is_joint_(joints_of(to)),
      targets_(from.nodes.size()),
      old_frames_(rest_frames(from)),
      frames_(rest_frames(to)),
      changes_(to.nodes.size()) {
    if (!comes_first) {
        comes_first.emplace();
        for (const AnimatedNode& node : animated_) comes_first->push_back(node.moves);
    }
    sources_ = find_sources(from, *comes_first, to, is_joint_);
    for (uint32_t node = 0; node < sources_.size(); ++node)
        if (sources_[node] != kNone) targets_[sources_[node]].push_back(node);
    compare_bones();
    for (const uint32_t node : parents_first(to)) {
        const NodeFrame parent = frame_of(frames_, to.nodes[node].parent);
        if (sources_[node] != kNone) changes_[node] = change_of(node, parent);
        frames_[node] = parent.child(rest_of(node));
    }
}

// Whether the node is a joint that hangs on a joint.
bool RigTransfer::is_bone(uint32_t node) const {
    const uint32_t parent = to_.nodes[node].parent;
    return is_joint_[node] && parent != kNone && is_joint_[parent];
}

double RigTransfer::old_length(uint32_t source) const {
    const AssetNode& node = from_.nodes[source];
    return length(node.parent_from_node.translation) * frame_of(old_frames_, node.parent).scale;
}

double RigTransfer::new_length(uint32_t node) const {
    const AssetNode& of = to_.nodes[node];
    return length(of.parent_from_node.translation) * frame_of(frames_, of.parent).scale;
}

bool RigTransfer::is_as_long(uint32_t node) const {
    constexpr double kSameLength = 0.01;  // exporters' rounding is less
    const double old_one = old_length(sources_[node]), new_one = new_length(node);
    return std::abs(old_one - new_one) <= kSameLength * std::max(old_one, new_one);
}

// Bones keep their length in nearly all clips, so a rest pose shows it even if that is some frame of a clip.
void RigTransfer::compare_bones() {
    constexpr double kMinSameShare = 0.9;  // of all bones must keep their length; joints of hips and faces move
    size_t count = 0, same_count = 0;
    double old_sum = 0, new_sum = 0;
    for (uint32_t node = 0; node < sources_.size(); ++node) {
        const uint32_t source = sources_[node];
        if (source == kNone || !is_bone(node)) continue;
        const uint32_t old_parent = from_.nodes[source].parent;
        if (old_parent == kNone || sources_[to_.nodes[node].parent] != old_parent) continue;
        ++count;
        same_count += is_as_long(node);
        old_sum += old_length(source);
        new_sum += new_length(node);
    }
    is_same_skeleton_ = static_cast<double>(same_count) >= kMinSameShare * static_cast<double>(count);
    if (same_count < count && old_sum > 0 && new_sum > 0) size_ratio_ = new_sum / old_sum;
}

// The vector from the new parent to the place of the old one, in the space of the new parent.
Vec3<double> RigTransfer::offset_of_parent(const NodeFrame& old_parent, const NodeFrame& parent) const {
    const Vec3<double> offset = old_parent.origin * size_ratio_ - parent.origin;
    const double distance = std::max(length(parent.origin), length(old_parent.origin));
    if (parent.scale == 0 || length(offset) <= kRounding * distance) return {};
    return rotated(conjugate(parent.rotation), offset) * (1 / parent.scale);
}

NodeChange RigTransfer::change_of(uint32_t node, const NodeFrame& parent) const {
    const uint32_t source = sources_[node];
    const AssetNode& old_node = from_.nodes[source];
    const NodeFrame old_parent = frame_of(old_frames_, old_node.parent);
    NodeChange change{.turn = conjugate(parent.rotation) * old_parent.rotation};
    change.is_turned = length(Vec3<double>{change.turn.x, change.turn.y, change.turn.z}) > kRounding;
    if (!change.is_turned) change.turn = {};
    const double unit = parent.scale > 0 && old_parent.scale > 0 ? old_parent.scale / parent.scale : 1;
    change.scale = unit * size_ratio_;
    if (is_bone(node)) {
        const uint32_t holder = to_.nodes[node].parent;
        const bool is_below_root = !is_bone(holder);
        if (is_as_long(node)) {
            change.scale = unit;
        } else if (!animated_[source].changes_length || !(is_same_skeleton_ || is_below_root)) {
            change.old_rest = old_node.parent_from_node.translation;
            change.base = to_.nodes[node].parent_from_node.translation;
        } else if (is_below_root && sources_[holder] == kNone) {
            change.base = offset_of_parent(old_parent, parent);  // hips below a root that `from` lacks
        }
    } else {
        change.base = offset_of_parent(old_parent, parent);
    }
    if (std::abs(change.scale - 1) < kRounding) change.scale = 1;
    return change;
}

// The local transform of the node while `from` is in its rest pose.
Trs<double> RigTransfer::rest_of(uint32_t node) const {
    Trs<double> rest = to_.nodes[node].parent_from_node;
    const uint32_t source = sources_[node];
    if (source == kNone) return rest;
    const AnimatedNode& animated = animated_[source];
    const Trs<double>& old = from_.nodes[source].parent_from_node;
    if (animated.has_rotation && takes(node, !animated.rotates)) rest.rotation = changes_[node].rotation(old.rotation);
    if (animated.has_translation && takes(node, !animated.translates))
        rest.translation = changes_[node].translation(old.translation);
    return rest;
}

}  // namespace throng
