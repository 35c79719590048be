#include <throng/commands.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

namespace throng {
namespace {

static_assert(sizeof(InstanceCommand) == 64 && sizeof(CommandHead) == sizeof(InstanceCommand));

uint32_t bits(double number) { return std::bit_cast<uint32_t>(static_cast<float>(number)); }

// Clip, loop, time, speed.
void put_clip(std::span<uint32_t, 4> data, const ClipPlayback& clip) {
    data[0] = clip.clip;
    data[1] = clip.loop ? 1 : 0;
    data[2] = bits(clip.time_s);
    data[3] = bits(clip.speed);
}

InstanceCommand placed(uint32_t instance, CommandKind kind, const Affine& world_from_model) {
    InstanceCommand command{.instance = instance, .kind = kind};
    static_assert(sizeof command.data == sizeof world_from_model);
    std::memcpy(command.data.data(), &world_from_model, sizeof command.data);
    return command;
}

}  // namespace

InstanceCommand InstanceCommand::spawn(uint32_t instance, const Affine& world_from_model) {
    return placed(instance, CommandKind::kSpawn, world_from_model);
}

InstanceCommand InstanceCommand::despawn(uint32_t instance) {
    return {.instance = instance, .kind = CommandKind::kDespawn};
}

InstanceCommand InstanceCommand::set_placement(uint32_t instance, const Affine& world_from_model) {
    return placed(instance, CommandKind::kPlace, world_from_model);
}

InstanceCommand InstanceCommand::set_playback(uint32_t instance, const Playback& playback) {
    InstanceCommand command{.instance = instance, .kind = CommandKind::kPlayback};
    const std::span data(command.data);
    put_clip(data.subspan<0, 4>(), playback.first);
    put_clip(data.subspan<4, 4>(), playback.second);
    data[8] = bits(playback.weight);
    return command;
}

InstanceCommand InstanceCommand::play(uint32_t instance, LayerIndex layer, const LayerPlayback& playback) {
    InstanceCommand command{.instance = instance, .kind = CommandKind::kPlay, .target = layer};
    const std::span data(command.data);
    put_clip(data.subspan<0, 4>(), playback.clip);
    data[4] = bits(playback.fade_s);
    data[5] = playback.fade == FadeKind::kInertial ? 1 : 0;
    return command;
}

InstanceCommand InstanceCommand::set_layer(uint32_t instance, LayerIndex layer, const LayerBlend& blend) {
    return {.instance = instance,
            .kind = CommandKind::kBlendLayer,
            .target = layer,
            .data = {bits(blend.weight), blend.mode == LayerMode::kAdditive ? 1u : 0u, blend.mask, bits(blend.fade_s)}};
}

InstanceCommand InstanceCommand::set_parameter(uint32_t instance, ParameterIndex parameter, float value) {
    return {.instance = instance, .kind = CommandKind::kSetParameter, .target = parameter, .data = {bits(value)}};
}

InstanceCommand InstanceCommand::set_look(uint32_t instance, const InstanceLook& look) {
    const auto [red, green, blue] = look.tint;
    return {
        .instance = instance, .kind = CommandKind::kSetLook, .data = {bits(red), bits(green), bits(blue), look.outfit}};
}

}  // namespace throng
