// Blends the pose that the application set for an instance over the animated pose, by its weight. The includer declares
// the tables `pose_overrides` (TABLE_OF_WORDS, two words an InstancePose: [instance]) and `poses` (TABLE_OF_ROWS, three
// rows a JointPose: [slot][rig_joint_count()]), and the function rig_joint_count(). Defined by blend_reference.h.
// Weight 0 yields the animated pose and weight 1 the one that was set, bit for bit.
#include "blend/blend.glsl"
#include "blend/pose_override_io.h"

JointPose overridden_pose(uint instance, uint joint, JointPose animated) {
    const float weight = uintBitsToFloat(WORD_AT(pose_overrides, 2 * instance + 1));
    if (weight <= 0) return animated;
    const uint row = 3 * (WORD_AT(pose_overrides, 2 * instance) * rig_joint_count() + joint);
    const JointPose pose = JointPose(uintBitsToFloat(ROW_AT(poses, row)), uintBitsToFloat(ROW_AT(poses, row + 1)),
                                     uintBitsToFloat(ROW_AT(poses, row + 2)));
    if (weight >= 1) return pose;
    return blend_joint(pose, animated, weight);
}
