// The rows of a character as GPUs read them: lane beside lane, and no floats. The same values as the native engine's
// (rows.h), in the same spaces; where 16 bits would be seen, a column of its own has the next 16.
#pragma once

#include "native/row_spaces.h"

#include <throng/character.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace throng {

struct GpuRows {
    uint32_t column_count = 0;
    std::vector<std::array<uint32_t, 2>> rows;    // kRowsBuffer
    std::vector<std::array<uint32_t, 4>> joints;  // kRowJointsBuffer
    std::vector<uint32_t> places;                 // kRowPlacesBuffer
    uint32_t motion_count = 0, fine_rotation_count = 0, fine_motion_count = 0;
};

// `joints` of RowSpaces::of_joints, in the order of columns; they have uniform scales. None where the rows would exceed
// so many bytes.
std::optional<GpuRows> make_gpu_rows(const Character& character, std::span<const native::RowJoint> joints,
                                     uint64_t most_bytes);

}  // namespace throng
