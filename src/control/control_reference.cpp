#include "control/control_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {

double local_time_reference(double time_s, double duration_s, bool loop) {
    if (duration_s <= 0) return 0;
    if (!loop) return std::clamp(time_s, 0.0, duration_s);
    const double wrapped = time_s - std::floor(time_s / duration_s) * duration_s;
    return wrapped >= duration_s || wrapped < 0 ? 0 : wrapped;
}

RowCursor find_rows_reference(std::span<const float> times_s, double time_s) {
    const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    const auto last = static_cast<uint32_t>(times_s.size() - 1);
    if (next == times_s.begin()) return {0, 0, 0};
    if (next == times_s.end()) return {last, last, 0};
    const auto later = static_cast<uint32_t>(next - times_s.begin());
    const double from_s = times_s[later - 1], to_s = times_s[later];
    return {later - 1, later, (time_s - from_s) / (to_s - from_s)};
}

io::ClipCursor cursor_reference(const ClipPlayback& playback, std::span<const Clip> clips,
                                std::span<const float> times_s, uint32_t joint_count) {
    const auto rest_track = static_cast<uint32_t>(clips.size()) * joint_count;
    if (playback.clip == kNone) return {.first_track = rest_track, .earlier = 0, .later = 0, .fraction = 0};
    const Clip& clip = clips[playback.clip];
    const double time_s = local_time_reference(playback.time_s, double{clip.duration_s}, playback.loop);
    const RowCursor rows = find_rows_reference(times_s.subspan(clip.first_time, clip.row_count), time_s);
    return {.first_track = playback.clip * joint_count,
            .earlier = clip.first_row + rows.earlier * clip.row_stride,
            .later = clip.first_row + rows.later * clip.row_stride,
            .fraction = static_cast<float>(rows.fraction)};
}

}  // namespace throng
