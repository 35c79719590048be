// Checks the numbers in a restored state that kernels use as indices. All throw kInvalidFile.
#pragma once

#include "control/control_io.h"
#include "crowd/group.h"

#include <cstddef>
#include <span>

namespace throng {

void check_playbacks(std::span<const io::InstancePlayback> playbacks, const Group& group);
void check_layers(std::span<const io::LayerState> layers, const GroupController& controller, uint32_t clip_count);
void check_commands(std::span<const io::ControlCommand> commands, uint32_t instance_count, const Group& group);
void check_looks(std::span<const InstanceLook> looks, uint32_t outfit_count);
void check_cull_states(std::span<const uint32_t> states, const Group& group);
// Checks the contents that are to go into a buffer of a batch.
void check_contents(uint32_t buffer, std::span<const std::byte> contents, const Group& group);

}  // namespace throng
