#include "tools/view/commands.h"
#include "tools/view/panels.h"

#include <array>

namespace throng::view {
namespace {

// Begins a window over everything, whose `pivot` (0..1 of its size) is at `at`.
void begin_notice(const char* id, ImVec2 at, ImVec2 pivot) {
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
    ImGui::Begin(id, nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
}

}  // namespace

void draw_selection(const State& state, const Scene& scene) {
    const PlacedBox box = scene.box_of(*state.selected);
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const Projection projection(state.picture_camera, display.x / display.y);
    std::array<Vec3<float>, 8> corners;  // bits 0, 1, 2 of c: whether corner c is at the maximum along x, y, z
    for (size_t c = 0; c < corners.size(); ++c)
        corners[c] = projection.project(transform_point(
            box.world_from_model,
            {c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y, c & 4 ? box.max.z : box.min.z}));
    for (size_t c = 0; c < corners.size(); ++c)
        for (const size_t axis : {size_t{1}, size_t{2}, size_t{4}}) {
            const Vec3<float>&a = corners[c], &b = corners[c | axis];
            if ((c & axis) || a.z <= 0 || b.z <= 0) continue;
            ImGui::GetBackgroundDrawList()->AddLine({a.x * display.x, a.y * display.y},
                                                    {b.x * display.x, b.y * display.y}, IM_COL32(120, 205, 255, 255),
                                                    scaled(2));
        }
}

void draw_keys(State& state) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    begin_notice("keys", {display.x / 2, display.y / 2}, {0.5f, 0.5f});
    if (ImGui::BeginTable("keys", 4, ImGuiTableFlags_SizingFixedFit)) {
        const auto cells = [](const Gesture& gesture) {
            ImGui::TableNextColumn();
            ImGui::TextColored(ImGui::GetStyle().Colors[ImGuiCol_CheckMark], "%s   ", gesture.how);
            ImGui::TableNextColumn();
            ImGui::Text("%s      ", gesture.does);
        };
        const auto left = commands();
        const auto right = gestures();
        for (size_t row = 0; row < std::max(left.size(), right.size()); ++row) {
            ImGui::TableNextRow();
            cells(row < left.size() ? left[row].gesture : Gesture{"", ""});
            cells(row < right.size() ? right[row] : Gesture{"", ""});
        }
        ImGui::EndTable();
    }
    if (ImGui::IsWindowHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) state.shows_keys = false;
    ImGui::End();
}

void draw_messages(State& state) {
    constexpr float kShown_s = 8;
    state.message_age_s += ImGui::GetIO().DeltaTime;
    const bool says = !state.message.empty() && state.message_age_s <= kShown_s;
    if (!says && state.progress.empty()) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float gap = scaled(kPanelGap);
    begin_notice("message", {display.x / 2, gap}, {0.5f, 0});
    ImGui::PushTextWrapPos(display.x * 0.5f);
    if (!state.progress.empty()) ImGui::TextUnformatted(state.progress.c_str());
    if (says && state.message_is_error)
        ImGui::TextColored({1, 0.55f, 0.45f, 1}, "%s", state.message.c_str());
    else if (says)
        ImGui::TextUnformatted(state.message.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
}

}  // namespace throng::view
