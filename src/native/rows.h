// The clips of a character as rows that are interpolated linearly: 16-bit words, or floats where the error of words
// would be visible. Independent of the instruction set; kernel_data.h describes the order of words.
#pragma once

#include "native/aligned.h"
#include "native/kernel_data.h"
#include "native/similarity.h"

#include <throng/character.h>

#include <span>
#include <vector>

namespace throng::native {

// A joint whose transforms are brought into other spaces: parent_space * parent_from_joint * inverse(joint_space).
struct RowJoint {
    uint32_t joint = 0;
    Similarity parent_space{}, joint_space{};
    double reach = 0;  // how far from it anything that moves with it may lie, model space
};

// The constant values of a joint, and the places of the rows that it has.
struct JointLayout {
    Vec3<double> centre{};                          // of parent_space * parent_from_joint
    Vec3<double> scale{1, 1, 1};                    // if uniform: one scale of these spaces, three times
    uint32_t motion = kNoIndex, scales = kNoIndex;  // if it moves: its place among those that do
};

// There is a row for each of the character's rows of keys, so that a cursor (control_io.h) finds its place. There are
// more rows between two keys if an arc differs from its chord, and an extra row ends a span of keys in which a track
// steps.
struct Rows {
    AlignedBytes bytes;  // [row_count][row_bytes]
    size_t row_bytes = 0;
    size_t row_count = 0;
    std::vector<RowSpan> spans;        // of all clips and the rest pose
    std::vector<RowClip> clips;        // [clip_count + 1]
    std::vector<RowBlock> blocks;      // of rotations, of motions, of three scales
    AlignedBytes ranges;               // floats: [block][8][16]
    std::vector<JointLayout> layouts;  // [joint]
    uint32_t motion_count = 0, scales_count = 0;

    // A block has 16 places. Those of rotations come first.
    static uint32_t rounded_up(size_t count) {
        return static_cast<uint32_t>((count + kBlockJoints - 1) / kBlockJoints * kBlockJoints);
    }
    uint32_t first_motion() const { return rounded_up(layouts.size()); }
    uint32_t first_scales() const { return first_motion() + rounded_up(motion_count); }
    uint32_t place_count() const { return first_scales() + rounded_up(scales_count); }
    uint64_t size_bytes() const;
};

// What a rotation, a translation and a scale become in these spaces.
std::array<double, 4> rotation_row(const RowJoint& joint, const Quaternion<double>& rotation);
std::array<double, 4> motion_row(const RowJoint& joint, const Trs<double>& parent_from_joint, bool uniform_scale);

struct RowSettings {
    bool uniform_scale = false;  // one scale a joint: the mean of x, y and z, which are nearly the same
    bool all_move = false;       // as if no joint stood still
};
// Throws kLimit if the clips have more rows of keys than make_rows() may make for this number of joints; it never makes
// fewer. Call it before anything loops over all rows: in a character made by hand, any number of them can lie at one
// place.
void check_key_rows(const Character& character, size_t joint_count);
// Makes rows of the joints given, in their order. Throws kLimit.
Rows make_rows(const Character& character, std::span<const RowJoint> joints, const RowSettings& settings);

}  // namespace throng::native
