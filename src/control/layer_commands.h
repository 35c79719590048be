// Checks the calls of Crowd that concern layers and turns them into commands for the GPU (the caller fills in the
// instance). Also reports what layers play.
#pragma once

#include "base/error_place.h"
#include "control/controller_io.h"

#include <throng/feedback.h>
#include <throng/playback.h>

namespace throng {

// What can be asked of a layer. A layer that has states plays only states, a direct layer only clips.
struct LayerKind {
    uint32_t state_count = 0;     // 0: none, a direct layer
    bool inertial_plays = false;  // ControllerLayer::inertial_plays
};
std::vector<LayerKind> layer_kinds(const Controller& controller);

// Whether instances have to keep the poses that they have shown.
bool has_inertia(const Controller& controller);

// All throw kInvalidArgument with `place`. kinds[layer_count].
io::ControlCommand play_command(std::span<const LayerKind> kinds, std::span<const float> clip_durations_s,
                                uint32_t layer, const LayerPlayback& playback, const ErrorPlace& place);
io::ControlCommand state_command(std::span<const LayerKind> kinds, uint32_t layer, const PlayedMotion& state,
                                 float fade_s, const ErrorPlace& place);
io::ControlCommand layer_command(std::span<const LayerKind> kinds, uint32_t mask_count, uint32_t layer,
                                 const LayerBlend& blend, const ErrorPlace& place);
void check_parameter(uint32_t parameter_count, uint32_t parameter, float value, const ErrorPlace& place);

// What a layer plays, as WatchedInstance has it.
void append_played(std::vector<PlayedMotion>& motions, const io::LayerState& layer, const LayerKind& kind,
                   uint32_t clip_count);

}  // namespace throng
