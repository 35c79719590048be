#include "control/playback.h"

#include "base/failure.h"

#include <cmath>

namespace throng {

void check_clip(const ClipPlayback& playback, uint32_t clip_count, const ErrorPlace& place) {
    if (playback.clip != kNone && playback.clip >= clip_count)
        throw Failure(ErrorCode::kInvalidArgument, place, "clip ", playback.clip,
                      " is out of range: the character has ", clip_count);
    if (!std::isfinite(playback.time_s) || !std::isfinite(playback.speed))
        throw Failure(ErrorCode::kInvalidArgument, place, "time and speed must be finite");
}

void check_playback(const Playback& playback, uint32_t clip_count, const ErrorPlace& place) {
    check_clip(playback.first, clip_count, place);
    check_clip(playback.second, clip_count, place);
    if (!(playback.weight >= 0 && playback.weight <= 1))
        throw Failure(ErrorCode::kInvalidArgument, place, "weight must lie within 0..1");
}

}  // namespace throng
