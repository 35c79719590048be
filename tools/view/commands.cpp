#include "tools/view/commands.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace throng::view {
namespace {

// Steps through round numbers: 1, 2, 5, 10, 20, 50 …
void change_count(State& state, bool up) {
    std::vector<uint32_t> steps;
    for (uint32_t decade = 1; decade <= kMaxCharacters; decade *= 10)
        for (const uint32_t step : {decade, 2 * decade, 5 * decade})
            if (step <= kMaxCharacters) steps.push_back(step);
    uint32_t& count = state.wanted.count;
    const auto at_least = std::ranges::lower_bound(steps, count), above = std::ranges::upper_bound(steps, count);
    if (up && above != steps.end()) count = *above;
    if (!up && at_least != steps.begin()) count = *(at_least - 1);
}

void step_back(State& state) {
    if (state.shows_keys)
        state.shows_keys = false;
    else if (state.selected)
        state.selected.reset();
    else
        state.message.clear();
}

constexpr std::array kCommands{
    Command{{"?", "show these keys"}, '?', 0, [](State& s) { s.shows_keys = !s.shows_keys; }},
    Command{{"space", "pause, continue"}, 0, GLFW_KEY_SPACE, [](State& s) { s.paused = !s.paused; }},
    Command{{".", "advance one frame"}, '.', 0, [](State& s) { s.paused = s.steps = true; }},
    Command{{"+", "more characters"}, '+', 0, [](State& s) { change_count(s, true); }},
    Command{{"-", "fewer characters"}, '-', 0, [](State& s) { change_count(s, false); }},
    Command{{"l", "culling and levels of detail"}, 'l', 0, [](State& s) { s.wanted.culls = !s.wanted.culls; }},
    Command{{"o", "occlusion culling"}, 'o', 0, [](State& s) { s.drawing.occlusion = !s.drawing.occlusion; }},
    Command{{"u", "small ones less often"}, 'u', 0, [](State& s) { s.wanted.skips_updates = !s.wanted.skips_updates; }},
    Command{{"k", "skeletons"}, 'k', 0, [](State& s) { s.drawing.skeletons = !s.drawing.skeletons; }},
    Command{{"b", "boxes that culling tests"}, 'b', 0, [](State& s) { s.drawing.bounds = !s.drawing.bounds; }},
    Command{{"h", "shadows"}, 'h', 0, [](State& s) { s.drawing.shadows = !s.drawing.shadows; }},
    Command{{"g", "fog"}, 'g', 0, [](State& s) { s.drawing.fog = !s.drawing.fog; }},
    Command{{"r", "see the whole crowd"}, 'r', 0, [](State& s) { s.see_whole_crowd(); }},
    Command{{"f", "fly, or orbit"}, 'f', 0, [](State& s) { s.flies = !s.flies; }},
    Command{{"tab", "panels"}, 0, GLFW_KEY_TAB, [](State& s) { s.shows_panels = !s.shows_panels; }},
    Command{{"p, F12", "screenshot"}, 'p', GLFW_KEY_F12, [](State& s) { s.takes_screenshot = true; }},
    Command{{"escape", "close, deselect"}, 0, GLFW_KEY_ESCAPE, step_back},
    Command{{"ctrl+q", "quit"}, 0, GLFW_KEY_Q, [](State& s) { s.closes = true; }, true},
};

constexpr std::array kGestures{
    Gesture{"drag", "orbit; when flying, look around"},
    Gesture{"right drag, or shift + drag", "pan"},
    Gesture{"wheel", "closer, farther"},
    Gesture{"click", "inspect a character"},
    Gesture{"w a s d q e; shift", "fly; faster"},
    Gesture{"drop .glb, .gltf, .throng", "show these characters"},
    Gesture{"drop a .json", "use this controller or these looks"},
};

void fly_by_keys(State& state) {
    const ImGuiIO& io = ImGui::GetIO();
    const auto axis = [](int more, int less) {
        return static_cast<float>(ImGui::IsKeyDown(more)) - static_cast<float>(ImGui::IsKeyDown(less));
    };
    const float step = io.DeltaTime * (io.KeyShift ? 1.2f : 0.3f);  // fractions of the distance to the crowd, a second
    const float right = axis(GLFW_KEY_D, GLFW_KEY_A), up = axis(GLFW_KEY_E, GLFW_KEY_Q),
                forward = axis(GLFW_KEY_W, GLFW_KEY_S);
    if (right == 0 && up == 0 && forward == 0) return;
    state.camera = kByHand;
    state.orbit.fly(right * step, up * step, forward * step);
}

bool is_for(const KeyPress& press, const Command& command) {
    if (press.character != 0) return press.character == command.character;
    return press.key != 0 && press.key == command.key && press.with_ctrl == command.with_ctrl;
}

void take_keys(State& state, std::span<const KeyPress> pressed) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return;
    if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) return;  // a list has them
    for (const KeyPress& press : pressed)
        for (const Command& command : kCommands)
            if (is_for(press, command)) command.run(state);
    if (!io.KeyCtrl) fly_by_keys(state);
}

void take_drags(State& state) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool begins = std::ranges::any_of(io.MouseClicked, [](bool is_clicked) { return is_clicked; });
    const float scale = begins ? 0 : 1 / io.DisplaySize.y;  // movement before the button went down does not count
    const float x = io.MouseDelta.x * scale, y = io.MouseDelta.y * scale;  // picture heights
    const bool pans = ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsMouseDown(ImGuiMouseButton_Middle) ||
                      (ImGui::IsMouseDown(ImGuiMouseButton_Left) && io.KeyShift);
    constexpr float kTurn_rad = 3.5f, kLook_rad = 1.2f;  // by a drag over the height of the picture
    const bool turns = !pans && ImGui::IsMouseDown(ImGuiMouseButton_Left);
    if (((pans || turns) && (x != 0 || y != 0)) || io.MouseWheel != 0) state.camera = kByHand;
    if (pans)
        state.orbit.pan(-x / state.free_part.height(), y / state.free_part.height());
    else if (turns && state.flies)
        state.orbit.look(-x * kLook_rad, y * kLook_rad);
    else if (turns)
        state.orbit.turn(-x * kTurn_rad, y * kTurn_rad);
    if (io.MouseWheel != 0) state.orbit.zoom(std::pow(0.88f, std::clamp(io.MouseWheel, -10.0f, 10.0f)));
}

}  // namespace

std::span<const Command> commands() { return kCommands; }
std::span<const Gesture> gestures() { return kGestures; }

std::optional<Click> take_commands(State& state, std::span<const KeyPress> pressed) {
    take_keys(state, pressed);
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantCaptureMouse) return std::nullopt;
    take_drags(state);
    constexpr float kStill = 4;  // pixels: a hand trembles
    if (!ImGui::IsMouseReleased(ImGuiMouseButton_Left) ||
        io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] > kStill * kStill)
        return std::nullopt;
    return Click{io.MousePos.x / io.DisplaySize.x, io.MousePos.y / io.DisplaySize.y};
}

}  // namespace throng::view
