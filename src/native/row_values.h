// The values that rows are made of: a character's joints at all rows of all clips, in the spaces that they are brought
// into.
#pragma once

#include "native/row_cursors.h"

#include <array>
#include <span>
#include <vector>

namespace throng::native {

using Four = std::array<double, 4>;

inline constexpr double kMaxWord = 32767;  // the largest word of 16 bits

// A joint's values in all rows of all clips: rotations; translations, with the scale if it is uniform; three scales.
struct JointValues {
    std::vector<Four> rotation, motion, scales;
};

struct RowRange {
    Four middle{}, half{};
    Four largest_step{};  // from one row to the next
};

class RowValues {
public:
    // Keeps references.
    RowValues(const Character& character, bool uniform_scale, std::vector<ClipRowCursors> cursors);

    size_t row_count() const { return row_count_; }
    const std::vector<ClipRowCursors>& cursors() const { return cursors_; }
    uint32_t first_row(size_t clip) const { return first_rows_[clip]; }

    JointValues of(const RowJoint& joint) const;
    RowRange range_of(std::span<const Four> rows) const;

private:
    const Character& character_;
    bool uniform_scale_ = false;  // one scale a joint: the mean of x, y and z, which are nearly the same
    std::vector<ClipRowCursors> cursors_;
    std::vector<uint32_t> first_rows_;  // [clip_count + 1]
    size_t row_count_ = 0;
};

}  // namespace throng::native
