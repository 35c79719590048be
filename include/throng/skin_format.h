// How skin matrices are stored, and blended.
#pragma once

#include <cstdint>

namespace throng {

// How OutputBlock::skin stores a skin matrix.
enum class SkinFormat {
    kAffine,  // 48 bytes: three rows of four floats
    // 24 bytes: three rows of four half floats; each is off by at most 2^-10 of its value or 2^-24, whichever is
    // larger; values beyond 65,504 become either that or infinite
    kHalfAffine,
    // 32 bytes: rotation (unit quaternion x, y, z, w), then translation and uniform scale; within 1e-5 of the
    // character's size. For characters whose scales and inverse binds are uniform
    kSimilarity,
};
// Bytes of one matrix.
uint32_t skin_format_bytes(SkinFormat format);

// How throng skins vertices: in Crowd::read_positions(), OutputBlock::skinned and Renderer. docs/skinning.md
// compares them.
enum class SkinBlend {
    kLinear,  // the weighted sum of the skin matrices: any character; joints that bend or twist far lose volume
    // Rotations and translations as dual quaternions, which keep the volume (L. Kavan et al., Geometric Skinning with
    // Approximate Dual Quaternion Blending, 2008), scales linearly. For characters whose scales and inverse binds are
    // uniform
    kDualQuaternion,
};

}  // namespace throng
