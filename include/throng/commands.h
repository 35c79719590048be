// What an application's shaders can tell instances to do, without the CPU. They write commands into a buffer
// (OutputBlock::command), and the next update obeys them, those that spawn and despawn first, then the others. If
// several set the same thing of one instance, the last one in the buffer counts. throng/commands.glsl has functions for
// such shaders.
#pragma once

#include <throng/character.h>
#include <throng/look.h>
#include <throng/playback.h>
#include <throng/transform.h>

#include <array>
#include <cstdint>

namespace throng {

enum class CommandKind : uint32_t {
    kNothing,
    kSpawn,
    kDespawn,
    kPlace,
    kPlayback,
    kPlay,
    kBlendLayer,
    kSetParameter,
    kSetLook
};

// 16 words. `data` by kind, with floats as their bits; words after those named here are ignored:
//   kSpawn, kPlace: world_from_model, three rows of four floats. kSpawn restarts an instance that is there.
//   kDespawn: nothing.
//   kPlayback: the first clip: its number (kNone: the rest pose), whether it loops (1 or 0), time in seconds and speed
//     (floats); the same four words for the second clip; weight of the first (float, 0..1).
//   kPlay: clip, loop, time and speed as in kPlayback; fade in seconds (float), 1 for FadeKind::kInertial.
//   kBlendLayer: weight (float, 0..1), 1 for LayerMode::kAdditive, mask or kNone, fade in seconds (float).
//   kSetParameter: value (float).
//   kSetLook: tint (three floats, 0..1000), outfit.
// kSpawn and kDespawn are for groups with ShaderCommands::populate, kPlayback (set_playback()) for those without a
// controller, kPlay and kBlendLayer (set_layer()) for layers without states, kSetParameter for groups with a
// controller, kSetLook for those with outfits.
struct InstanceCommand {
    uint32_t instance = 0;  // of the block
    CommandKind kind = CommandKind::kNothing;
    uint32_t target = 0;  // kPlay, kBlendLayer: layer; kSetParameter: parameter
    uint32_t unused = 0;
    std::array<uint32_t, 12> data{};

    // The commands for Crowd's calls of these names, but unchecked. For the CPU to write: into HostOutputs::command on
    // a native device, or into memory that is copied to OutputBlock::command on another.
    static InstanceCommand spawn(uint32_t instance, const Affine& world_from_model);
    static InstanceCommand despawn(uint32_t instance);
    static InstanceCommand set_placement(uint32_t instance, const Affine& world_from_model);
    static InstanceCommand set_playback(uint32_t instance, const Playback& playback);
    static InstanceCommand play(uint32_t instance, LayerIndex layer, const LayerPlayback& playback);
    static InstanceCommand set_layer(uint32_t instance, LayerIndex layer, const LayerBlend& blend);
    static InstanceCommand set_parameter(uint32_t instance, ParameterIndex parameter, float value);
    static InstanceCommand set_look(uint32_t instance, const InstanceLook& look);
};

// Precedes a block's commands, and has the size of one.
struct CommandHead {
    // The number of commands. A shader adds 1 to it atomically, and writes its command at the index that it held
    // before, if that is below OutputBlock::command_capacity. An update sets it to 0 when it has executed the commands.
    uint32_t count = 0;
    uint32_t lost = 0;  // commands that the last update did not get, because there was no room for them
    // Commands that the last update refused: of a kind that the group does not obey, for a clip, layer or instance
    // number out of range, with a number that is not finite or out of range. Commands for an instance number that is
    // free, and those that a later one replaces, do nothing and are not counted.
    uint32_t ignored = 0;
    std::array<uint32_t, 13> unused{};
};

}  // namespace throng
