#include "crowd/state_checks.h"

#include "crowd/look_stage.h"
#include "crowd/state_archive.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace throng {
namespace {

uint32_t clip_count_of(const Group& group) { return static_cast<uint32_t>(group.clip_durations_s.size()); }

template <class T>
std::vector<T> copied(std::span<const std::byte> contents) {
    std::vector<T> all(contents.size() / sizeof(T));
    if (!all.empty()) std::memcpy(all.data(), contents.data(), all.size() * sizeof(T));
    return all;
}

void check_clip_play(const io::ClipPlay& play, uint32_t clip_count) {
    StateArchive::require(play.clip <= clip_count, "a playback has a clip that the character does not have");
    StateArchive::require(std::isfinite(play.time_s) && std::isfinite(play.speed),
                          "a playback has a time or speed that is not finite");
}

void check_layer(const io::LayerState& layer, const LayerKind& kind, uint32_t mask_count, uint32_t clip_count) {
    const uint32_t motion_count = kind.state_count > 0 ? kind.state_count : clip_count + 1;  // also the rest pose
    StateArchive::require(layer.play_count <= io::kStackSize, "a layer plays too many motions at once");
    for (uint32_t i = 0; i < layer.play_count; ++i)
        StateArchive::require(layer.plays[i].motion < motion_count && layer.plays[i].loops <= io::kMaxLoops,
                              "a layer plays a state or clip that does not exist, or too many loops of it");
    StateArchive::require(layer.mode <= io::kModeAdditive, "a layer has an unknown mode");
    StateArchive::require(layer.mask == kNone || layer.mask < mask_count, "a layer has a mask that does not exist");
}

void check_layer_command(const io::ControlCommand& command, const GroupController& controller, uint32_t clip_count) {
    const bool is_of_state = command.kind == io::kCommandState;
    const bool is_inertial = command.kind == io::kCommandPlayInertial;
    const bool is_of_clip = command.kind == io::kCommandPlay || is_inertial;
    constexpr std::string_view kWrongLayer = "a command is for a layer that does not exist or does not take it";
    StateArchive::require(command.target < controller.layer_count, kWrongLayer);
    const LayerKind& layer = controller.layer_kinds[command.target];
    StateArchive::require((layer.state_count > 0) == is_of_state && (layer.inertial_plays || !is_inertial),
                          kWrongLayer);
    StateArchive::require(is_of_state  ? command.motion < layer.state_count && command.loop <= io::kMaxLoops
                          : is_of_clip ? command.motion <= clip_count
                                       : (command.motion == kNone || command.motion < controller.mask_count) &&
                                             command.phase <= io::kModeAdditive,
                          "a command has a clip, state, mask or mode that does not exist, or too many loops");
}

}  // namespace

void check_playbacks(std::span<const io::InstancePlayback> playbacks, const Group& group) {
    for (const io::InstancePlayback& playback : playbacks) {
        check_clip_play(playback.first, clip_count_of(group));
        check_clip_play(playback.second, clip_count_of(group));
        StateArchive::require(playback.weight >= 0 && playback.weight <= 1, "a playback has a weight outside 0..1");
    }
}

void check_layers(std::span<const io::LayerState> layers, const GroupController& controller, uint32_t clip_count) {
    for (size_t i = 0; i < layers.size(); ++i)
        check_layer(layers[i], controller.layer_kinds[i % controller.layer_count], controller.mask_count, clip_count);
}

void check_commands(std::span<const io::ControlCommand> commands, uint32_t instance_count, const Group& group) {
    for (const io::ControlCommand& command : commands) {
        StateArchive::require(command.kind <= io::kCommandState && command.instance < instance_count,
                              "a command is unknown, or is for an instance that does not exist");
        if (command.kind == io::kCommandParameter)
            StateArchive::require(command.target < group.controller->parameter_count,
                                  "a command is for a parameter that does not exist");
        else if (command.kind == io::kCommandBegin)  // only these groups have what an instance begins with
            StateArchive::require(group.varies, "an instance is spawned in a group without CrowdGroup::capacity");
        else
            check_layer_command(command, *group.controller, clip_count_of(group));
    }
}

void check_looks(std::span<const InstanceLook> looks, uint32_t outfit_count) {
    for (const InstanceLook& look : looks)
        StateArchive::require(look.outfit < std::max(outfit_count, 1u) && is_color(look.tint),
                              "an instance has an outfit that the group does not have, or a tint out of range");
}

void check_cull_states(std::span<const uint32_t> states, const Group& group) {
    const auto set_count = static_cast<uint32_t>(std::max<size_t>(group.fused.size(), 1));
    StateArchive::require(
        std::ranges::all_of(states, [&](uint32_t state) { return state >> io::kStateSetShift < set_count; }),
        "an instance has a set of joints that does not exist");
}

void check_contents(uint32_t buffer, std::span<const std::byte> contents, const Group& group) {
    if (buffer == io::kPlaybacksBuffer) check_playbacks(copied<io::InstancePlayback>(contents), group);
    if (buffer == io::kLayersBuffer)
        check_layers(copied<io::LayerState>(contents), *group.controller, clip_count_of(group));
    if (buffer == io::kInstanceLooksBuffer) check_looks(copied<InstanceLook>(contents), group.outfit_count);
    if (buffer == io::kStatesBuffer) check_cull_states(copied<uint32_t>(contents), group);
}

}  // namespace throng
