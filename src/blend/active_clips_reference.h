// Defines the pose that layers of active clips produce.
#pragma once

#include <throng/transform.h>

#include <span>
#include <vector>

namespace throng {

// One clip as part of a joint's pose.
struct ReferenceActiveClip {
    Trs<double> pose;
    Trs<double> first;  // the pose in the clip's first row; additive layers only
    double weight = 1;  // the weights of a layer sum to 1
};

struct ReferenceLayer {
    bool is_additive = false;
    double weight = 1;  // at this joint: the layer's times the mask's. The lowest layer always has weight 1.
    std::vector<ReferenceActiveClip> active_clips;
    bool in_model_space = false;  // override layers: rotations are blended in model space
};

// The difference that takes `from` to `to`, in the parent's space: the shorter rotation, the translation, and the ratio
// of each scale (1 where `from` has a scale of about 0).
Trs<double> pose_difference_reference(const Trs<double>& to, const Trs<double>& from);

// parent_from_joint of a joint, from its layers, the lowest first. An override layer is the weighted sum of its active
// clips, blended over the layers below. An additive layer is the weighted sum of its clips' differences from their
// first rows, added to the layers below. If a layer's rotations cancel out, it takes the rotation of its last active
// clip.
Trs<double> active_clips_reference(std::span<const ReferenceLayer> layers);

// Rotations of model_from_joint, ignoring scales: of the layers below, of the layer alone, and of both blended.
struct ReferenceRotations {
    Quaternion<double> below, layer, blended;
};

struct ReferenceJoint {
    Trs<double> pose;                           // parent_from_joint
    std::vector<ReferenceRotations> rotations;  // [layer]; set only for layers in model space
};

// Like active_clips_reference(), for layers that may blend rotations in model space. `parent`: the result for the
// parent joint, null for a root. Where such a layer has weight at the joint, the resulting model rotation is the blend
// of both model rotations. Where it has none, the local rotation from below the layer is kept.
ReferenceJoint joint_reference(std::span<const ReferenceLayer> layers, const ReferenceJoint* parent);

}  // namespace throng
