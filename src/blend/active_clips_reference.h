// The definition of poses made of layers of active clips.
#pragma once

#include <throng/transform.h>

#include <span>
#include <vector>

namespace throng {

// One clip as part of a joint's pose.
struct ReferenceActiveClip {
    Trs<double> pose;
    Trs<double> first;  // in the clip's first row; of additive layers only
    double weight = 1;  // those of a layer sum to 1
};

struct ReferenceLayer {
    bool is_additive = false;
    double weight = 1;  // at this joint: the layer's times the mask's. The lowest layer counts as 1.
    std::vector<ReferenceActiveClip> active_clips;
    bool in_model_space = false;  // override layers: rotations are blended in model space
};

// The difference that takes `from` to `to`, in the parent's space: the shorter rotation, the translation, and the ratio
// of each scale (1 if there is none).
Trs<double> pose_difference_reference(const Trs<double>& to, const Trs<double>& from);

// parent_from_joint of a joint, from its layers, the lowest first. An override layer is the weighted sum of its active
// clips, blended over what lies below; an additive one the weighted sum of their differences from their first rows,
// applied to it. If its rotations cancel each other, the layer turns as its last active clip does.
Trs<double> active_clips_reference(std::span<const ReferenceLayer> layers);

// Rotations of model_from_joint, ignoring scales: below a layer, in the layer's own pose, and after blending both.
struct ReferenceRotations {
    Quaternion<double> below, layer, blended;
};

struct ReferenceJoint {
    Trs<double> pose;                           // parent_from_joint
    std::vector<ReferenceRotations> rotations;  // [layer], of those in model space
};

// The same if layers blend rotations in model space; `parent` is what this returned for the parent, null for a root. At
// a joint where such a layer has weight, the resulting model rotation is the blend of both model rotations; where it
// has none, the local rotation below the layer stays.
ReferenceJoint joint_reference(std::span<const ReferenceLayer> layers, const ReferenceJoint* parent);

}  // namespace throng
