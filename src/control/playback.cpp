#include "control/playback.h"

#include "base/failure.h"

#include <cmath>

namespace throng {

void check_playback(const Playback& playback, uint32_t clip_count, const std::string& place) {
    const auto refuse = [&](std::string why) { return Failure(ErrorCode::kInvalidArgument, place, std::move(why)); };
    for (const ClipPlayback& slot : {playback.first, playback.second}) {
        if (slot.clip != kNone && slot.clip >= clip_count)
            throw refuse("clip " + std::to_string(slot.clip) + " of a character that has " +
                         std::to_string(clip_count));
        if (!std::isfinite(slot.time_s) || !std::isfinite(slot.speed)) throw refuse("time and speed must be finite");
    }
    if (!(playback.weight >= 0 && playback.weight <= 1)) throw refuse("weight must lie within 0..1");
}

}  // namespace throng
