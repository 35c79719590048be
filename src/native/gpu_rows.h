// The rows of a character as GPUs read them: 16-bit words only, and the columns of all joints side by side
// (fused/rows_io.h). They hold the same values as the rows of the native engine (rows.h), in the same spaces. If the
// error of 16 bits would be visible, another column has the next 16.
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

// `joints`: some of RowSpaces::of_joints, in the order of columns, with uniform scales. Returns nothing if the rows
// would exceed `max_bytes`.
std::optional<GpuRows> make_gpu_rows(const Character& character, std::span<const native::RowJoint> joints,
                                     uint64_t max_bytes);

}  // namespace throng
