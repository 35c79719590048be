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

// [clip_count + 1]; the last is the rest pose. Nothing if there would be more than `most_rows` in all, which are
// counted before they are listed: a file of a few megabytes can ask for gigabytes.
std::optional<std::vector<ClipRowCursors>> row_cursors(const Character& character, std::span<const RowJoint> joints,
                                                       uint64_t most_rows);

}  // namespace throng::native
