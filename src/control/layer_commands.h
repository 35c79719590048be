// What Crowd asks of layers, checked, as commands of the GPU; the instance is left to the caller.
#pragma once

#include "control/controller_io.h"

#include <throng/crowd.h>

namespace throng {

// All throw kInvalidArgument with `place`. has_states[layer_count]: such layers are driven by their controller alone.
io::ControlCommand play_command(const std::vector<bool>& has_states, std::span<const float> clip_durations_s, uint32_t layer, const LayerPlayback& playback, const std::string& place);
io::ControlCommand layer_command(const std::vector<bool>& has_states, uint32_t mask_count, uint32_t layer, const LayerBlend& blend, const std::string& place);
void check_parameters(uint32_t parameter_count, uint32_t first, std::span<const float> values, const std::string& place);

}  // namespace throng
