// A layer whose rotations are blended in model space: docs/controller.md, step 9. Source: Unreal Engine's layered blend
// per bone, "Mesh Space Rotation Blend". Difference from it: none known; there too, joints without weight keep the
// local rotation of the layers below. The includer declares the table `parents` (TABLE_OF_WORDS, [joint], kNone: none),
// the buffer `rotations` (ModelRotations[layer in model space][joint][instance]) and `push`, and processes the joints
// of an instance in order, parents first. Defined by active_clips_reference.h.
#include "blend/blend.glsl"
#include "blend/layered_io.h"
#include "control/controller_io.h"

vec4 unit(vec4 quaternion) { return quaternion * inversesqrt(dot(quaternion, quaternion)); }

// `model_layer`: index among the instance's layers in model space that have active clips, from the lowest up.
// 0 <= weight <= 1.
JointPose apply_in_model_space(uint instance, uint joint, uint model_layer, JointPose layer, JointPose below,
                               float weight) {
    const uint first = model_layer * push.joint_count, parent = WORD_AT(parents, joint);
    const vec4 identity = vec4(0, 0, 0, 1);
    ModelRotations above = ModelRotations(identity, identity, identity);
    if (parent != kNone) above = rotations[(first + parent) * push.instance_count + instance];
    ModelRotations here;
    here.below = unit(quaternion_multiply(above.below, below.rotation));
    here.layer = unit(quaternion_multiply(above.layer, layer.rotation));
    here.blended = unit(quaternion_multiply(above.blended, below.rotation));
    JointPose pose = below;
    if (weight > 0) {
        here.blended = here.layer;
        pose = layer;
        if (weight < 1) {
            here.blended = blend_rotation(here.layer, here.below, weight);
            pose = blend_joint(layer, below, weight);
        }
        pose.rotation = unit(quaternion_multiply(vec4(-above.blended.xyz, above.blended.w), here.blended));
    }
    rotations[(first + joint) * push.instance_count + instance] = here;
    return pose;
}
