#include "tools/view/panels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng::view {
namespace {

// Colours of the stages in their order: by hue, in steps that the colour-blind can tell apart too (after Okabe and Ito,
// 2008).
constexpr auto kColors = std::to_array<ImU32>(
    {IM_COL32(90, 90, 90, 255), IM_COL32(204, 121, 167, 255), IM_COL32(230, 159, 0, 255), IM_COL32(140, 100, 60, 255),
     IM_COL32(0, 158, 115, 255), IM_COL32(86, 180, 233, 255), IM_COL32(170, 170, 80, 255), IM_COL32(213, 94, 0, 255),
     IM_COL32(240, 228, 66, 255), IM_COL32(0, 114, 178, 255), IM_COL32(136, 34, 85, 255), IM_COL32(51, 187, 166, 255),
     IM_COL32(102, 51, 204, 255), IM_COL32(153, 221, 255, 255)});
constexpr ImU32 kColorOfDrawing = IM_COL32(118, 128, 146, 255);

// Stages that a later library adds begin with the first colour again.
ImU32 color_of(size_t timed) { return timed < kStageLimit ? kColors[timed % kColors.size()] : kColorOfDrawing; }

// The next larger of 1, 2, 5 times a power of ten.
float round_up(float ms) {
    const float decade = std::pow(10.0f, std::floor(std::log10(std::max(ms, 1e-3f))));
    for (const float step : {1.0f, 2.0f, 5.0f})
        if (ms <= step * decade) return step * decade;
    return 10 * decade;
}

float sum(const FrameTimes& times) {
    float total = 0;
    for (const float time : times) total += time;
    return total;
}

// Stages stacked on each other, the latest frame at the right.
void draw_bars(const History& history, ImVec2 from, ImVec2 to) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    float most = 0.01f;
    for (size_t frame = 0; frame < history.size(); ++frame) most = std::max(most, sum(history.ago(frame)));
    const float top = round_up(most), width = (to.x - from.x) / History::kFrames, height = to.y - from.y;
    for (size_t frame = 0; frame < history.size(); ++frame) {
        const float right = to.x - static_cast<float>(frame) * width;
        float y = to.y;
        for (size_t i = 0; i < kTimedCount; ++i) {
            const float above = y - history.ago(frame)[i] / top * height;
            if (y - above > 0.05f) list.AddRectFilled({right - width, above}, {right, y}, color_of(i));
            y = above;
        }
    }
    for (const float part : {0.0f, 0.5f, 1.0f}) {
        const float y = to.y - part * height;
        std::array<char, 24> text{};
        std::snprintf(text.data(), text.size(), part == 1 ? "%.4g ms" : "%.4g", double{part * top});
        list.AddLine({from.x, y}, {to.x, y}, IM_COL32(255, 255, 255, 40));
        list.AddText({to.x + scaled(6), y - ImGui::GetFontSize() / 2}, ImGui::GetColorU32(ImGuiCol_TextDisabled),
                     text.data());
    }
}

void draw_legend(const char* processor, const FrameTimes& mean) {
    const float side = ImGui::GetFontSize() * 0.6f;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ImGui::TextDisabled("%s", processor);
    ImGui::SameLine();
    ImGui::Text("%.2f ms", double{sum(mean)});
    for (size_t i = 0; i < kTimedCount; ++i) {
        if (mean[i] <= 0) continue;  // this crowd does not have the stage
        std::array<char, 48> text{};
        std::snprintf(text.data(), text.size(), "%s %.2f", timed_name(i), double{mean[i]});
        ImGui::SameLine(0, scaled(14));
        if (ImGui::GetContentRegionAvail().x < side + scaled(5) + ImGui::CalcTextSize(text.data()).x) ImGui::NewLine();
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float down = (ImGui::GetFontSize() - side) / 2;
        list.AddRectFilled({at.x, at.y + down}, {at.x + side, at.y + down + side}, color_of(i), 2);
        ImGui::SetCursorScreenPos({at.x + side + scaled(5), at.y});
        ImGui::TextUnformatted(text.data());
    }
}

}  // namespace

size_t stage_color_count() { return kColors.size(); }

void draw_graph(const Measured& measured) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float gap = scaled(kPanelGap), left = scaled(kSettingsWidth) + 2 * gap, height = scaled(kGraphHeight);
    ImGui::SetNextWindowPos({left, display.y - gap - height});
    ImGui::SetNextWindowSize({display.x - left - gap, height});
    ImGui::Begin("graph", nullptr, kFixedPanel | ImGuiWindowFlags_NoScrollbar);
    draw_legend(measured.is_software ? "CPU" : "GPU", measured.history.mean());
    const ImVec2 from = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
    draw_bars(measured.history, {from.x, from.y + scaled(8)},
              {from.x + room.x - scaled(58), from.y + room.y - scaled(4)});
    ImGui::End();
}

}  // namespace throng::view
