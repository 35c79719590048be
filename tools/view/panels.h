// What is drawn over the crowd, by Dear ImGui.
#pragma once

#include "tools/view/state.h"

#include <imgui.h>

namespace throng::view {

// Left, at the bottom, and, where a character is selected, right.
void draw_settings(State& state, Scene& scene, const Measured& measured);
void draw_graph(const Measured& measured);
void draw_inspector(State& state, Scene& scene, const Measured& measured);
// Over the picture: the selected character's box, keys, what has been said.
void draw_selection(const State& state, const Scene& scene);
void draw_keys(State& state);
void draw_message(State& state);

inline constexpr float kPanelGap = 10;  // pixels of large ones, as all lengths below
inline constexpr float kSettingsWidth = 290, kInspectorWidth = 290, kGraphHeight = 150;

// Pixels of the display.
inline float scaled(float length) { return length * ImGui::GetFontSize() / 15; }

// A panel that stays where it is put.
inline constexpr ImGuiWindowFlags kFixedPanel = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                                ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                                ImGuiWindowFlags_NoSavedSettings |
                                                ImGuiWindowFlags_NoBringToFrontOnFocus;

// Starts a row of a panel: its name in front, the next item in what is left.
void begin_row(const char* name);
// A box to choose a clip in, by its number. Says whether it was changed.
bool choose_clip(const char* id, const Character& character, uint32_t& clip);
// A row with a controller's parameter. Says whether it was changed; a trigger's value is 1 then.
bool parameter_row(const Controller& controller, uint32_t parameter, float& value);

}  // namespace throng::view
