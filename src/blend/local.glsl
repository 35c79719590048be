// Poses -> the buffer of local transforms. The includer declares `local`, rows of four floats, and the constant
// kSimilarity.
#include "blend/blend.glsl"

// Three rows of an Affine, or two of a Similarity.
void store_local(uint index, JointPose pose) {
    if (kSimilarity) {
        const Similarity similarity = similarity_parent_from_joint(pose);
        local[2 * index] = similarity.rotation;
        local[2 * index + 1] = similarity.translation_scale;
    } else {
        const Affine affine = parent_from_joint(pose);
        local[3 * index] = affine.row0;
        local[3 * index + 1] = affine.row1;
        local[3 * index + 2] = affine.row2;
    }
}
