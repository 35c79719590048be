// Which nodes become joints, in which order, and how a node's own transform becomes its joint's.
#pragma once

#include <throng/character.h>

#include <vector>

namespace throng {

// Rotation, uniform scale and translation: what a folded static node leaves to its children. Unlike a general matrix it
// maps every interpolation of a child's TRS (lerp, slerp, cubic) onto the same interpolation of the mapped keys, so
// folding is exact.
struct Similarity {
    Quaternion<double> rotation;
    Vec3<double> translation;
    double scale = 1;

    Vec3<double> vector(const Vec3<double>& v) const;
    Vec3<double> point(const Vec3<double>& p) const { return vector(p) + translation; }
    Similarity operator*(const Similarity& b) const {
        return {normalized(rotation * b.rotation), point(b.translation), scale * b.scale};
    }
    Trs<double> operator*(const Trs<double>& t) const {
        return {rotation * t.rotation, point(t.translation), t.scale * scale};
    }
};

struct RigMap {
    Rig rig;
    std::vector<uint32_t> joint_of_node;         // [node_count], kNone where the node is no joint
    std::vector<Similarity> parent_from_prefix;  // [joint_count], the folded nodes between a joint and its parent
    uint32_t folded_node_count = 0;
};

// Whether a primitive has triangles.
inline bool is_drawn(const AssetPrimitive& primitive) { return !primitive.indices.empty(); }

// Throws kUnsupported where the asset has no skin and draws nothing, kLimit beyond 65,535 joints.
RigMap build_rig(const Asset& asset);

// All nodes, parents before their children.
std::vector<uint32_t> parents_first(const Asset& asset);

// Fills level_count, mean_depth and leaf_count from `parents`.
void measure_rig(Rig& rig);

// A rigid mesh's place: the joint it hangs on and joint_from_mesh.
struct RigidAnchor {
    uint32_t joint = kNone;
    AffineT<double> joint_from_mesh;
};
// [node_count]; the joint is kNone if neither the node nor one above it is a joint. Such nodes draw no mesh.
std::vector<RigidAnchor> rigid_anchors(const Asset& asset, const RigMap& map);

}  // namespace throng
