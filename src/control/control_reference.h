// The definition of the control stage.
#pragma once

#include "control/control_io.h"

#include <throng/playback.h>

#include <span>

namespace throng {

// Looping: t - floor(t / D) * D; else clamped to [0, D].
double local_time_reference(double time_s, double duration_s, bool loop);

// value = (1 - fraction) * row `earlier` + fraction * row `later`.
struct RowCursor {
    uint32_t earlier = 0, later = 0;
    double fraction = 0;
};
RowCursor find_rows_reference(std::span<const float> times_s, double time_s);

// The cursor as kernels read it, for a character of `joint_count` joints; its fraction is rounded to float.
io::ClipCursor cursor_reference(const ClipPlayback& playback, std::span<const Clip> clips,
                                std::span<const float> times_s, uint32_t joint_count);

}  // namespace throng
