#include "tools/view/panels.h"

#include <algorithm>

namespace throng::view {
namespace {

// Returns whether it was changed.
bool clip_rows(const char* title, const Character& character, ClipPlayback& playing) {
    ImGui::PushID(title);
    bool changed = clip_row(title, character, playing.clip);
    if (playing.clip != kNone) {
        const float duration_s = character.clips[playing.clip].duration_s;
        float time_s = std::min(static_cast<float>(playing.time_s), duration_s);
        if (slider_row("time", time_s, 0, duration_s, "%.2f s")) {
            playing.time_s = double{time_s};
            changed = true;
        }
        changed |= slider_row("speed", playing.speed, -2, 2, "%.2f");
    }
    ImGui::PopID();
    ImGui::Spacing();
    return changed;
}

void clips(Scene& scene, uint32_t instance, const Character& character) {
    Playback playback = scene.playback_of(instance);
    bool changed = clip_rows("first", character, playback.first);
    changed |= clip_rows("second", character, playback.second);
    changed |= blend_row(playback.weight);
    if (changed) scene.set_playback_of(instance, playback);
}

const char* name_of(const Character& character, const ControllerLayer& layer, uint32_t motion) {
    if (motion == kNone) return "rest pose";
    return layer.states.empty() ? character.clips[motion].name.c_str() : layer.states[motion].name.c_str();
}

// A bar for how far the leading state is in its cycle; beneath it the states that fade out.
void layer_rows(const Character& character, const ControllerLayer& layer, std::span<const PlayedMotion> played) {
    begin_row(layer.name.c_str());
    if (played.empty()) return ImGui::TextDisabled("nothing");
    ImGui::ProgressBar(played.front().phase, {-1, 0}, name_of(character, layer, played.front().motion));
    for (size_t k = 1; k < played.size(); ++k) {
        begin_row("");
        ImGui::TextDisabled("from %s, %.0f %%", name_of(character, layer, played[k].motion),
                            100 * double{played[k - 1].fade});
    }
}

// Shows what the device had in the last frame, and sends parameters that are changed.
void controller_rows(Scene& scene, uint32_t instance, const Character& character, const Controller& controller,
                     const WatchedInstance& watched) {
    for (uint32_t p = 0; p < controller.parameters.size(); ++p) {
        float value = watched.parameters[p];
        if (parameter_row(controller, p, value)) scene.set_parameter_of(instance, p, value);
    }
    ImGui::Spacing();
    for (size_t layer = 0; layer < controller.layers.size(); ++layer)
        layer_rows(character, controller.layers[layer], watched.layers[layer]);
}

}  // namespace

void draw_inspector(State& state, Scene& scene, const Measured& measured) {
    const uint32_t instance = *state.selected;
    const uint32_t group = scene.group_of(instance);
    const Character& character = scene.cast().characters[group];
    begin_side_panel("inspector", kInspectorWidth, true);
    ImGui::Text("Character %u", instance);
    ImGui::SameLine();
    ImGui::TextDisabled("%s", character.name.c_str());
    if (corner_button("x", kInspectorWidth)) state.selected.reset();
    ImGui::Separator();
    begin_row("joints");
    ImGui::Text("%u in %u levels", character.rig.joint_count(), character.rig.level_count);
    const Affine& world_from_model = scene.box_of(instance).world_from_model;
    begin_row("position");
    ImGui::Text("%.2f, %.2f, %.2f", double{world_from_model.row[0][3]}, double{world_from_model.row[1][3]},
                double{world_from_model.row[2][3]});
    ImGui::Spacing();
    if (const Controller* controller = scene.controller_of(group)) {
        // Not known yet in the first frame
        if (const WatchedInstance* watched = measured.watched(); watched && watched->instance.instance == instance)
            controller_rows(scene, instance, character, *controller, *watched);
    } else if (!character.clips.empty()) {
        clips(scene, instance, character);
    }
    ImGui::End();
}

}  // namespace throng::view
