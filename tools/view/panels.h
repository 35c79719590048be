// What is drawn over the crowd, by Dear ImGui.
#pragma once

#include "tools/view/state.h"

#include <imgui.h>

namespace throng::view {

// Left, at the bottom, and, where a character is selected, right.
void draw_settings(State& state, Scene& scene, const Measured& measured);
void draw_graph(const Measured& measured);
void draw_inspector(State& state, Scene& scene, const Measured& measured);
// What the first two leave free of the picture; all of its width, or height, where that would be less than a third.
PicturePart part_without_panels();
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
// Begins one at the upper left, or right, as high as its rows.
void begin_side_panel(const char* name, float width, bool at_right);
// At the end of the panel's current row.
bool corner_button(const char* name, float panel_width);

// A row has its name in front; begin_row() leaves the next item what is left. Those that change a value say whether
// they did. Items of one panel have different names, or stand within an ImGui::PushID().
void begin_row(const char* name);
bool slider_row(const char* name, float& value, float least, float most, const char* format,
                ImGuiSliderFlags flags = ImGuiSliderFlags_None);
// How much of each of two clips.
bool blend_row(float& weight_of_first);
bool clip_row(const char* name, const Character& character, uint32_t& clip);
// With a controller's parameter; a trigger's value is 1 when it is changed.
bool parameter_row(const Controller& controller, uint32_t parameter, float& value);

}  // namespace throng::view
