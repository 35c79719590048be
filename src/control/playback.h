// What a Playback must satisfy, for the GPU and for the reference alike.
#pragma once

#include "base/error_place.h"

#include <throng/playback.h>

namespace throng {

// Throw kInvalidArgument with `place` where a clip is out of range, a number not finite, or the weight outside 0..1.
void check_clip(const ClipPlayback& playback, uint32_t clip_count, const ErrorPlace& place);
void check_playback(const Playback& playback, uint32_t clip_count, const ErrorPlace& place);

}  // namespace throng
