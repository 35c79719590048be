// One instance of a controller, evaluated by the reference, with the queries that tests need.
#pragma once

#include "control/controller_reference.h"
#include "tests/test_rig.h"

#include <cmath>
#include <cstdio>
#include <map>

namespace throng::test {

// Clips named "a", "b", "c"… with these durations.
inline Character character_of(const std::vector<float>& durations_s) {
    static std::map<size_t, Character> made;  // by the number of clips
    const auto count = static_cast<uint32_t>(durations_s.size());
    if (!made.contains(count)) made.emplace(count, make_character({.joint_count = 4, .clip_count = count}));
    Character character = made.at(count);
    for (size_t i = 0; i < durations_s.size(); ++i) {
        character.clips[i].name = std::string(1, static_cast<char>('a' + i));
        character.clips[i].duration_s = durations_s[i];
    }
    return character;
}

class Instance {
public:
    explicit Instance(Controller of, std::vector<float> durations_s = {1, 2, 4})
        : character(character_of(durations_s)), controller(std::move(of)), reference(controller, character) {}

    void set(std::string_view parameter, float value) {
        reference.apply(
            {.kind = io::kCommandParameter, .target = controller.find_parameter(parameter), .value = value});
    }
    void play(uint32_t clip, float fade_rate = 0, float speed = 1, bool loop = true, uint32_t phase = 0,
              uint32_t layer = 0) {
        reference.apply({.kind = io::kCommandPlay,
                         .target = layer,
                         .motion = clip,
                         .phase = phase,
                         .loop = loop,
                         .value = speed,
                         .fade_rate = fade_rate});
    }
    void update(float time_step_s) { last = reference.update(time_step_s); }

    // Weights per clip in the last update; index clip_count is the rest pose.
    std::vector<float> weights(uint32_t layer = 0) const {
        std::vector<float> sums(character.clips.size(), 0.0f);
        for (const ControllerActiveClip& active_clip : last.active_clips)
            if (active_clip.layer == layer) sums[active_clip.clip] += active_clip.weight;
        return sums;
    }
    // For example "step step land@0.5".
    std::string events() const {
        std::string text;
        for (const ControllerEventAt& event : last.events) {
            char at[32];
            std::snprintf(at, sizeof(at), "@%g", std::round(event.time_s * 1e6) / 1e6);
            text += (text.empty() ? "" : " ") + controller.events[event.event].name + at;
        }
        return text;
    }
    const io::LayerPlay& leading(uint32_t layer = 0) const { return reference.layers[layer].plays[0]; }
    uint32_t play_count(uint32_t layer = 0) const { return reference.layers[layer].play_count; }

    Character character;
    Controller controller;
    ControllerReference reference;
    ControllerUpdate last;
};

}  // namespace throng::test
