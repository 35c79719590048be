#include "control/layer_commands.h"

#include "base/enumeration.h"
#include "base/failure.h"
#include "control/playback.h"
#include "controller/controller_arrays.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

const LayerKind& kind_of(std::span<const LayerKind> kinds, uint32_t layer, const ErrorPlace& place) {
    if (layer >= kinds.size())
        refuse(place, numbered("layer", layer), " is out of range: the controller has ", kinds.size());
    return kinds[layer];
}

void check_layer(std::span<const LayerKind> kinds, uint32_t layer, const ErrorPlace& place) {
    if (kind_of(kinds, layer, place).state_count > 0)
        refuse(place,
               "layer " + std::to_string(layer) + " has states: set the controller's parameters, or call set_state()");
}

float rate_of(float fade_s, const ErrorPlace& place) {
    if (!(fade_s >= 0 && std::isfinite(fade_s))) refuse(place, "the fade must be finite, and not negative");
    return fade_s > 0 ? std::min(1 / std::min(fade_s, io::kLongestFade_s), 1e6f) : 0;
}

}  // namespace

std::vector<LayerKind> layer_kinds(const Controller& controller) {
    std::vector<LayerKind> kinds;
    for (const ControllerLayer& layer : controller.layers)
        kinds.push_back({static_cast<uint32_t>(layer.states.size()), layer.inertial_plays});
    return kinds;
}

bool has_inertia(const Controller& controller) {
    return std::ranges::any_of(controller.layers, [](const ControllerLayer& layer) {
        return layer.inertial_plays ||
               std::ranges::any_of(layer.transitions, [](const ControllerTransition& transition) {
                   return transition.fade == FadeKind::kInertial;
               });
    });
}

io::ControlCommand play_command(std::span<const LayerKind> kinds, std::span<const float> clip_durations_s,
                                uint32_t layer, const LayerPlayback& playback, const ErrorPlace& place) {
    const auto clip_count = static_cast<uint32_t>(clip_durations_s.size());
    const ClipPlayback& clip = playback.clip;
    check_layer(kinds, layer, place);
    check_clip(clip, clip_count, place);
    if (!is_known(playback.fade, FadeKind::kInertial)) refuse(place, "the fade is neither of FadeKind");
    const bool is_inertial = playback.fade == FadeKind::kInertial;
    if (is_inertial && !kinds[layer].inertial_plays)
        refuse(place, "layer " + std::to_string(layer) +
                          " does not allow FadeKind::kInertial: set ControllerLayer::inertial_plays");
    const bool rests = clip.clip == kNone;
    return {.instance = 0,
            .kind = is_inertial ? io::kCommandPlayInertial : io::kCommandPlay,
            .target = layer,
            .motion = rests ? clip_count : clip.clip.number,
            .phase = rests ? 0 : phase_at(clip.time_s, clip_durations_s[clip.clip], clip.loop),
            .loop = clip.loop ? 1u : 0u,
            .value = clip.speed,
            .fade_rate = rate_of(playback.fade_s, place)};
}

io::ControlCommand state_command(std::span<const LayerKind> kinds, uint32_t layer, const PlayedMotion& state,
                                 float fade_s, const ErrorPlace& place) {
    const uint32_t state_count = kind_of(kinds, layer, place).state_count;
    if (state_count == 0) refuse(place, "layer " + std::to_string(layer) + " has no states: call play()");
    if (state.motion >= state_count)
        refuse(place, numbered("state", state.motion), " is out of range: the layer has ", state_count);
    if (!(state.phase >= 0 && state.phase <= 1)) refuse(place, "the phase must lie within 0..1");
    return {.instance = 0,
            .kind = io::kCommandState,
            .target = layer,
            .motion = state.motion,
            .phase = static_cast<uint32_t>(std::min(state.phase * 0x1p32, 0x1p32 - 1)),
            .loop = std::min(state.loops, io::kMaxLoops),
            .value = 0,
            .fade_rate = rate_of(fade_s, place)};
}

io::ControlCommand layer_command(std::span<const LayerKind> kinds, uint32_t mask_count, uint32_t layer,
                                 const LayerBlend& blend, const ErrorPlace& place) {
    check_layer(kinds, layer, place);
    if (!(blend.weight >= 0 && blend.weight <= 1)) refuse(place, "weight must lie within 0..1");
    if (!is_known(blend.mode, LayerMode::kAdditive)) refuse(place, "the mode is neither of LayerMode");
    if (blend.mask != kNone && blend.mask >= mask_count)
        refuse(place, numbered("mask", blend.mask), " is out of range: the controller has ", mask_count);
    return {.instance = 0,
            .kind = io::kCommandLayer,
            .target = layer,
            .motion = blend.mask,
            .phase = blend.mode == LayerMode::kAdditive ? io::kModeAdditive : io::kModeOverride,
            .loop = 0,
            .value = blend.weight,
            .fade_rate = rate_of(blend.fade_s, place)};
}

void check_parameter(uint32_t parameter_count, uint32_t parameter, float value, const ErrorPlace& place) {
    if (parameter >= parameter_count)
        refuse(place, numbered("parameter", parameter), " is out of range: the controller has ", parameter_count);
    if (!std::isfinite(value)) refuse(place, "the value must be finite");
}

void append_played(std::vector<PlayedMotion>& motions, const io::LayerState& layer, const LayerKind& kind,
                   uint32_t clip_count) {
    for (uint32_t k = 0; k < layer.play_count; ++k) {
        const io::LayerPlay& play = layer.plays[k];
        const bool has_states = kind.state_count > 0, rests = !has_states && play.motion == clip_count;
        motions.push_back({.motion = rests ? kNone : play.motion,
                           .phase = static_cast<float>(play.phase * 0x1p-32),
                           .loops = play.loops,
                           .fade = k + 1 == layer.play_count ? 1 : play.fade,
                           .speed = has_states ? 1 : play.speed,
                           .loop = has_states || play.loop != 0});
    }
}

}  // namespace throng
