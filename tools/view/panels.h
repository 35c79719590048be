// What is drawn over the crowd, by Dear ImGui.
#pragma once

#include "tools/view/state.h"

#include <imgui.h>

namespace throng::view {

// At the left, at the bottom, and at the right (only while a character is selected).
void draw_settings(State& state, Scene& scene, const Measured& measured);
void draw_graph(const Measured& measured);
void draw_inspector(State& state, Scene& scene, const Measured& measured);
// The part of the picture that the first two leave free; the full width, or height, if that would be less than a third.
PicturePart part_without_panels();
// Over the picture: the selected character's box, the keys, progress and the last message.
void draw_selection(const State& state, const Scene& scene);
void draw_keys(State& state);
void draw_messages(State& state);

inline constexpr float kPanelGap = 10;  // for scaled(), as all lengths below
inline constexpr float kSettingsWidth = 290, kInspectorWidth = 290, kGraphHeight = 150;

// A length in pixels of the display.
inline float scaled(float length) { return length * ImGui::GetFontSize() / 15; }

// A panel that stays where it is put.
inline constexpr ImGuiWindowFlags kFixedPanel = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                                ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                                ImGuiWindowFlags_NoSavedSettings |
                                                ImGuiWindowFlags_NoBringToFrontOnFocus;
// Begins a fixed panel at the upper left, or right, as high as its rows.
void begin_side_panel(const char* name, float width, bool at_right);
// At the end of the panel's current row.
bool corner_button(const char* name, float panel_width);

// A row starts with its name; begin_row() leaves the rest of the row to the next item. The functions that edit a value
// return whether they changed it. Items of one panel need different names, or an ImGui::PushID() around them.
void begin_row(const char* name);
bool slider_row(const char* name, float& value, float least, float most, const char* format,
                ImGuiSliderFlags flags = ImGuiSliderFlags_None);
// How much of each of two clips is played.
bool blend_row(float& weight_of_first);
bool clip_row(const char* name, const Character& character, ClipIndex& clip);
// Edits a controller's parameter; a trigger's value is 1 when it is changed.
bool parameter_row(const Controller& controller, uint32_t parameter, float& value);

}  // namespace throng::view
