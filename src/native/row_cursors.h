// Where the rows of the native engine lie between the keys of a character.
#pragma once

#include "control/control_reference.h"
#include "native/rows.h"

#include <optional>

namespace throng::native {

struct ClipRowCursors {
    std::vector<RowCursor> rows;  // between which keys
    std::vector<RowSpan> spans;   // [keys]; rows count from the clip's first
};

// [clip_count + 1]; the last is the rest pose. Returns nothing if there would be more than `max_rows` rows in all.
// Rows are counted before they are listed, since a file of a few megabytes can ask for gigabytes.
std::optional<std::vector<ClipRowCursors>> row_cursors(const Character& character, std::span<const RowJoint> joints,
                                                       uint64_t max_rows);

}  // namespace throng::native
