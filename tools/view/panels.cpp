#include "tools/view/panels.h"

#include "tools/cli/options.h"
#include "tools/cli/path_name.h"
#include "tools/view/commands.h"
#include "tools/view/window.h"

#include <algorithm>
#include <array>
#include <cinttypes>

namespace throng::view {
namespace {

// One choice of a row, and its tooltip, or null for none.
struct Choice {
    const char* name;
    const char* tip = nullptr;
};
// In the order of their enumerations.
constexpr std::array kFormations{Choice{"grid", "row by row"}, Choice{"disc", "a sunflower's seeds, facing outwards"},
                                 Choice{"path", "a parade along a closed curve"},
                                 Choice{"random", "anywhere, but apart"}};
constexpr std::array kPaths{Choice{"auto", "native on software devices, else fused where it applies"},
                            Choice{"fused", "sample, blend, scan and bind in one pass"},
                            Choice{"staged", "one pass after another"},
                            Choice{"native", "by this machine's processor, on software devices"},
                            Choice{"device", "by the device, fused where it applies"}};
constexpr std::array kFormats{Choice{"affine, 48 bytes", "three rows of four floats"},
                              Choice{"half, 24 bytes", "three rows of four half floats"},
                              Choice{"similarity, 32 bytes", "rotation, translation and one scale"}};
constexpr std::array kBlends{Choice{"linear", "weighted sums of skin matrices"},
                             Choice{"dual quaternion", "twisting joints keep their girth"}};

std::string id_of(const char* name) { return std::string("##") + name; }

// A tooltip for the last item.
void tip(const char* text) {
    if (text && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

void check_row(const char* name, bool& value, const char* explained = nullptr) {
    ImGui::Checkbox(name, &value);
    tip(explained);
}

// A combo box. `chosen` is an index; if it is none of the choices, `shown` says what is set instead.
bool combo_row(const char* name, std::span<const Choice> choices, size_t& chosen, const char* shown = "") {
    begin_row(name);
    const size_t before = chosen;
    if (!ImGui::BeginCombo(id_of(name).c_str(), chosen < choices.size() ? choices[chosen].name : shown)) return false;
    if (ImGui::IsKeyPressed(GLFW_KEY_ESCAPE)) ImGui::CloseCurrentPopup();
    for (size_t i = 0; i < choices.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));  // names may repeat
        if (ImGui::Selectable(choices[i].name, i == before)) chosen = i;
        tip(choices[i].tip);
        ImGui::PopID();
    }
    ImGui::EndCombo();
    return chosen != before;
}

template <class Enum>
void choose_row(const char* name, std::span<const Choice> choices, Enum& value) {
    auto chosen = static_cast<size_t>(value);
    if (combo_row(name, choices, chosen)) value = static_cast<Enum>(chosen);
}

void name_row(const char* row, std::span<const Choice> choices, std::string& name) {
    const auto found = std::ranges::find(choices, name, [](const Choice& choice) { return std::string(choice.name); });
    auto chosen = static_cast<size_t>(found - choices.begin());
    if (combo_row(row, choices, chosen, name.c_str())) name = choices[chosen].name;
}

void scan_row(std::string& scan) {
    const std::vector<ScanMethodInfo> methods = scan_methods();
    std::vector<Choice> choices{{"auto"}};
    for (const ScanMethodInfo& method : methods)
        if (method.in_crowds) choices.push_back({method.name.c_str(), method.summary.c_str()});
    name_row("scan", choices, scan);
}

// Takes effect when the slider is released, since a change is costly.
void slide_count(State& state) {
    if (!state.sliding_count) state.sliding_count = static_cast<int>(state.wanted.count);
    ImGui::SliderInt("##count", &*state.sliding_count, 1, static_cast<int>(kMaxCharacters), "%d",
                     ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemDeactivatedAfterEdit()) state.wanted.count = static_cast<uint32_t>(*state.sliding_count);
    if (!ImGui::IsItemActive()) state.sliding_count.reset();
}

// Takes effect when the field is left, not with each digit: a seed makes a new crowd.
void type_seed(State& state) {
    if (!state.typed_seed) state.typed_seed = state.wanted.seed;
    ImGui::InputScalar("##seed", ImGuiDataType_U64, &*state.typed_seed);
    if (ImGui::IsItemDeactivatedAfterEdit()) state.wanted.seed = *state.typed_seed;
    if (!ImGui::IsItemActive()) state.typed_seed.reset();
}

void crowd_section(State& state) {
    begin_row("number");
    slide_count(state);
    begin_row("seed");
    type_seed(state);
    choose_row("placement", kFormations, state.wanted.formation);
}

void clips_of(Scene& scene, uint32_t group) {
    const Character& character = scene.cast().characters[group];
    GroupPlayback playback = scene.group_playback(group);
    ImGui::Checkbox("own clips for each", &playback.own);
    if (!playback.own) {
        clip_row("first", character, playback.first);
        clip_row("second", character, playback.second);
        blend_row(playback.weight);
    }
    if (playback != scene.group_playback(group)) scene.set_group_playback(group, playback);
}

void parameters_of(Scene& scene, uint32_t group) {
    const Controller& controller = *scene.controller_of(group);
    for (uint32_t p = 0; p < controller.parameters.size(); ++p) {
        float value = scene.parameters(group)[p];
        if (!parameter_row(controller, p, value)) continue;
        scene.set_directs(false);
        scene.set_parameter(group, p, value);
    }
}

void animation_section(State& state, Scene& scene) {
    if (ImGui::Button(state.paused ? "continue" : "pause", {scaled(80), 0})) state.paused = !state.paused;
    ImGui::SameLine();
    if (ImGui::Button("one frame")) state.paused = state.steps = true;
    slider_row("speed", state.time_factor, 0, 3, "%.2f");
    const std::vector<Character>& characters = scene.cast().characters;
    const bool has_controllers = std::ranges::any_of(scene.cast().controllers,
                                                     [](const auto& controller) { return controller.has_value(); });
    if (bool directs = scene.directs(); has_controllers && ImGui::Checkbox("random parameters now and then", &directs))
        scene.set_directs(directs);
    for (uint32_t group = 0; group < characters.size(); ++group) {
        ImGui::PushID(static_cast<int>(group));
        ImGui::Spacing();
        ImGui::TextDisabled("%s", characters[group].name.c_str());
        if (scene.controller_of(group))
            parameters_of(scene, group);
        else if (!characters[group].clips.empty())
            clips_of(scene, group);
        ImGui::PopID();
    }
}

void update_section(State& state, Scene& scene) {
    scan_row(state.wanted.scan);
    const auto path = scene.crowd().path(0);
    begin_row("");
    ImGui::TextDisabled("%s, %s", path->scan.method.c_str(), tools::path_name(*path).c_str());
    tip((path->scan.reason + "\n" + path->reason).c_str());
    choose_row("path", kPaths, state.wanted.path);
    choose_row("output", kFormats, state.wanted.format);
    choose_row("skinning", kBlends, state.wanted.blend);
    check_row("skin vertices once a frame", state.wanted.skins_once, "in compute, for the shadows and the picture");
    check_row("culling and levels of detail", state.wanted.culls, "only what is seen, only as fine as it is seen");
    if (!state.wanted.culls) return;
    slider_row("detail", state.drawing.lod_pixels, 0.25f, 16, "off by %.2f pixels", ImGuiSliderFlags_Logarithmic);
    check_row("occlusion culling", state.drawing.occlusion,
              "leaves out characters hidden behind others, by the depths of the last frame; pays where large ones hide "
              "many. Native updates do without");
    check_row("update small ones less often", state.wanted.skips_updates,
              "animated in every 2nd, 4th or 8th frame; in between, matrices go on evenly");
    if (!state.wanted.skips_updates) return;
    slider_row("smaller than", state.drawing.full_rate_pixels, 0, 1000, "%.0f pixels");
    slider_row("budget", state.drawing.budget_ms, 0, 100,
               state.drawing.budget_ms > 0 ? "at most %.1f ms" : "as long as it takes", ImGuiSliderFlags_Logarithmic);
}

void picture_section(State& state) {
    constexpr std::array kCameras{Choice{kByHand}, Choice{"orbit"}, Choice{"flyover"}, Choice{"low"}, Choice{"follow"}};
    name_row("camera", kCameras, state.camera);
    check_row("skeletons", state.drawing.skeletons, "a colour for each level");
    ImGui::SameLine(scaled(130));
    check_row("boxes", state.drawing.bounds);
    check_row("shadows", state.drawing.shadows);
    ImGui::SameLine(scaled(130));
    check_row("fog", state.drawing.fog);
    slider_row("exposure", state.drawing.exposure, 0.25f, 4, "%.2f", ImGuiSliderFlags_Logarithmic);
    if (ImGui::Button("whole crowd")) state.see_whole_crowd();
    ImGui::SameLine();
    if (ImGui::Button("screenshot")) state.takes_screenshot = true;
}

// Figures of the crowd and its characters.
void figures_section(Scene& scene, const Measured& measured) {
    uint64_t joints = 0;
    for (uint32_t group = 0; group < scene.cast().characters.size(); ++group)
        joints += uint64_t{scene.instance_count_of(group)} * scene.cast().characters[group].rig.joint_count();
    begin_row("joints");
    ImGui::Text("%" PRIu64, joints);
    begin_row("memory");
    ImGui::Text("%.1f MB", static_cast<double>(scene.crowd().size_bytes()) / 1e6);
    begin_row("drawn");
    std::string drawn;
    for (const uint32_t count : measured.drawn) drawn += (drawn.empty() ? "" : " + ") + std::to_string(count);
    ImGui::TextUnformatted(drawn.c_str());
    tip("characters of each level of detail, the finest first");
    begin_row("renderer");
    ImGui::TextUnformatted(tools::renderer_name(measured.is_drawn_natively).c_str());
    tip("native: this machine's processor draws; vulkan: the device's shaders");
}

}  // namespace

void begin_row(const char* name) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(scaled(88));
    ImGui::SetNextItemWidth(-1);
}

bool slider_row(const char* name, float& value, float least, float most, const char* format, ImGuiSliderFlags flags) {
    begin_row(name);
    return ImGui::SliderFloat(id_of(name).c_str(), &value, least, most, format, flags | ImGuiSliderFlags_AlwaysClamp);
}

bool blend_row(float& weight_of_first) {
    float second = 1 - weight_of_first;
    if (!slider_row("blend", second, 0, 1, "%.2f of the second")) return false;
    weight_of_first = 1 - second;
    return true;
}

bool clip_row(const char* name, const Character& character, ClipIndex& clip) {
    std::vector<Choice> choices;
    for (const auto& one : character.clips) choices.push_back({one.name.c_str()});
    size_t chosen = clip;
    const bool changed = combo_row(name, choices, chosen, "rest pose");
    clip = static_cast<uint32_t>(chosen);
    return changed;
}

bool parameter_row(const Controller& controller, uint32_t parameter, float& value) {
    const ControllerParameter& of = controller.parameters[parameter];
    const tools::ParameterRange range = tools::parameter_range(controller, parameter);
    const std::string id = "##parameter" + std::to_string(parameter);
    begin_row(of.name.c_str());
    if (of.type == ParameterType::kFloat)
        return ImGui::SliderFloat(id.c_str(), &value, range.least, range.most, "%.2f");
    if (of.type == ParameterType::kTrigger) {
        value = 1;
        return ImGui::Button(("set" + id).c_str(), {-1, 0});
    }
    bool is_set = value != 0;
    const bool changed = ImGui::Checkbox(id.c_str(), &is_set);
    value = is_set ? 1.0f : 0.0f;
    return changed;
}

void begin_side_panel(const char* name, float width, bool at_right) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float gap = scaled(kPanelGap);
    ImGui::SetNextWindowPos({at_right ? display.x - gap : gap, gap}, ImGuiCond_Always, {at_right ? 1.0f : 0.0f, 0});
    ImGui::SetNextWindowSizeConstraints({scaled(width), 0}, {scaled(width), display.y - 2 * gap});
    ImGui::Begin(name, nullptr, kFixedPanel | ImGuiWindowFlags_AlwaysAutoResize);
}

bool corner_button(const char* name, float panel_width) {
    ImGui::SameLine(scaled(panel_width) - scaled(34));
    return ImGui::SmallButton(name);
}

PicturePart part_without_panels() {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    PicturePart part{.left = scaled(kSettingsWidth + kPanelGap) / display.x,
                     .bottom = 1 - scaled(kGraphHeight + kPanelGap) / display.y};
    constexpr float kMinimum = 1 / 3.0f;
    if (part.width() < kMinimum) part.left = 0;
    if (part.height() < kMinimum) part.bottom = 1;
    return part;
}

void draw_settings(State& state, Scene& scene, const Measured& measured) {
    begin_side_panel("settings", kSettingsWidth, false);
    ImGui::Text("%.1f frames/s", measured.frame_ms > 0 ? 1000 / double{measured.frame_ms} : 0.0);
    ImGui::SameLine();
    ImGui::TextDisabled("%s", measured.device.substr(0, measured.device.find(" (")).c_str());
    if (corner_button("?", kSettingsWidth)) state.shows_keys = !state.shows_keys;
    const auto section = [](const char* name) { return ImGui::CollapsingHeader(name, ImGuiTreeNodeFlags_DefaultOpen); };
    if (section("Crowd")) crowd_section(state);
    if (section("Animation")) animation_section(state, scene);
    if (section("Update")) update_section(state, scene);
    if (section("Picture")) picture_section(state);
    if (section("Figures")) figures_section(scene, measured);
    ImGui::End();
}

}  // namespace throng::view
