// Blends two poses of a joint, and converts a pose to a matrix.
#ifndef THRONG_BLEND_GLSL
#define THRONG_BLEND_GLSL
#include "blend/blend_io.h"
#include "gpu/similarity.glsl"

// weight * a + (1 - weight) * b, along the shorter arc and normalised.
vec4 blend_rotation(vec4 a, vec4 b, float weight) {
    const float side = dot(a, b) < 0 ? -1 : 1;
    const vec4 rotation = mix(b * side, a, weight);
    return rotation * inversesqrt(dot(rotation, rotation));
}

JointPose blend_joint(JointPose a, JointPose b, float weight) {
    return JointPose(blend_rotation(a.rotation, b.rotation, weight), mix(b.translation, a.translation, weight),
                     mix(b.scale, a.scale, weight));
}

Affine parent_from_joint(JointPose pose) {
    return affine_from_trs(pose.rotation, pose.translation.xyz, pose.scale.xyz);
}

// The similarity of a pose whose scale is uniform.
Similarity similarity_parent_from_joint(JointPose pose) {
    return Similarity(pose.rotation, vec4(pose.translation.xyz, pose.scale.x));
}

#endif
