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
    bool in_model_space = false;  // of an override: its rotations are blended as they stand in the model
};

// What leads from `from` to `to`, in the space of the parent: the shorter rotation, the way, the ratio of each scale (1
// where there is none).
Trs<double> pose_difference_reference(const Trs<double>& to, const Trs<double>& from);

// parent_from_joint of a joint, from its layers, the lowest first. An override layer is the weighted sum of its active
// clips, blended over what lies below; an additive one the weighted sum of their differences from their first rows,
// applied to it. Where rotations cancel each other, the layer turns as its last active clip does.
Trs<double> active_clips_reference(std::span<const ReferenceLayer> layers);

// Rotations of model_from_joint, scales ignored: of what lies below a layer, of the layer's own pose, and of what comes
// of both.
struct ReferenceRotations {
    Quaternion<double> below, layer, blended;
};

struct ReferenceJoint {
    Trs<double> pose;                           // parent_from_joint
    std::vector<ReferenceRotations> rotations;  // [layer], of those in model space
};

// The same where layers blend rotations in model space; `parent` is what this returned for the parent, null for a root.
// At a joint where such a layer has weight, what comes of it points, in the model, where the blend of both model
// rotations does; without weight the local rotation of what lies below stays.
ReferenceJoint joint_reference(std::span<const ReferenceLayer> layers, const ReferenceJoint* parent);

}  // namespace throng
