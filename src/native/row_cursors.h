// Where the rows of the native engine lie between the keys of a character.
#pragma once

#include "control/control_reference.h"
#include "native/rows.h"

namespace throng::native {

struct ClipRowCursors {
    std::vector<RowCursor> rows;  // between which keys
    std::vector<RowSpan> spans;   // [keys]; rows count from the clip's first
};

// [clip_count + 1]; the last is the rest pose.
std::vector<ClipRowCursors> row_cursors(const Character& character, std::span<const RowJoint> joints);

}  // namespace throng::native
