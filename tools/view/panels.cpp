#include "tools/view/panels.h"

#include "tools/view/commands.h"

#include <algorithm>
#include <array>
#include <cinttypes>

namespace throng::view {
namespace {

template <class T>
struct Named {
    T value;
    const char* name;
    const char* tip;
};
constexpr std::array kFormations{Named{tools::Formation::kGrid, "grid", "row by row"},
                                 Named{tools::Formation::kDisc, "disc", "a sunflower's seeds, facing outwards"},
                                 Named{tools::Formation::kPath, "path", "a parade along a closed curve"},
                                 Named{tools::Formation::kRandom, "random", "anywhere, but apart"}};
constexpr std::array kPaths{Named{UpdatePath::kAuto, "auto", "fused where it applies"},
                            Named{UpdatePath::kFused, "fused", "sample, blend, scan and bind in one pass"},
                            Named{UpdatePath::kStaged, "staged", "one after another"}};
constexpr std::array kFormats{
    Named{SkinFormat::kAffine, "affine, 48 bytes", "three rows of four floats"},
    Named{SkinFormat::kHalfAffine, "half, 24 bytes", "three rows of four half floats"},
    Named{SkinFormat::kSimilarity, "similarity, 32 bytes", "rotation, translation and one scale"}};
constexpr std::array kBlends{
    Named{SkinBlend::kLinear, "linear", "weighted sums of skin matrices"},
    Named{SkinBlend::kDualQuaternion, "dual quaternion", "joints that twist keep their girth"}};

template <class T, size_t count>
void choose(const char* id, const std::array<Named<T>, count>& all, T& value) {
    const auto current = std::ranges::find(all, value, &Named<T>::value);
    if (!ImGui::BeginCombo(id, current->name)) return;
    for (const Named<T>& one : all) {
        if (ImGui::Selectable(one.name, one.value == value)) value = one.value;
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", one.tip);
    }
    ImGui::EndCombo();
}

void choose_scan(std::string& scan) {
    if (!ImGui::BeginCombo("##scan", scan.c_str())) return;
    if (ImGui::Selectable("auto", scan == "auto")) scan = "auto";
    for (const ScanMethodInfo& method : scan_methods()) {
        if (!method.in_crowds) continue;
        if (ImGui::Selectable(method.name.c_str(), scan == method.name)) scan = method.name;
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", method.summary.c_str());
    }
    ImGui::EndCombo();
}

// Takes effect when it is let go: what it changes is costly.
void slide_count(State& state) {
    if (!state.sliding_count) state.sliding_count = static_cast<int>(state.wanted.count);
    ImGui::SliderInt("##count", &*state.sliding_count, 1, static_cast<int>(kMostCharacters), "%d",
                     ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemDeactivatedAfterEdit()) state.wanted.count = static_cast<uint32_t>(*state.sliding_count);
    if (!ImGui::IsItemActive()) state.sliding_count.reset();
}

void crowd_section(State& state) {
    begin_row("number");
    slide_count(state);
    begin_row("seed");
    ImGui::InputScalar("##seed", ImGuiDataType_U64, &state.wanted.seed, nullptr, nullptr, nullptr,
                       ImGuiInputTextFlags_EnterReturnsTrue);
    begin_row("placement");
    choose("##placement", kFormations, state.wanted.formation);
}

void clips_of(Scene& scene, uint32_t group) {
    const Character& character = scene.cast().characters[group];
    GroupPlayback playback = scene.group_playback(group);
    ImGui::Checkbox("each its own clips", &playback.own);
    if (!playback.own) {
        begin_row("first");
        choose_clip("##first", character, playback.first);
        begin_row("second");
        choose_clip("##second", character, playback.second);
        begin_row("blend");
        float second = 1 - playback.weight;
        ImGui::SliderFloat("##blend", &second, 0, 1, "%.2f of the second", ImGuiSliderFlags_AlwaysClamp);
        playback.weight = 1 - second;
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
    if (ImGui::Button(state.paused ? "go on" : "pause", {scaled(80), 0})) state.paused = !state.paused;
    ImGui::SameLine();
    if (ImGui::Button("one frame")) state.paused = state.steps = true;
    begin_row("speed");
    ImGui::SliderFloat("##speed", &state.time_factor, 0, 3, "%.2f", ImGuiSliderFlags_AlwaysClamp);
    const std::vector<Character>& characters = scene.cast().characters;
    const bool has_controllers = std::ranges::any_of(scene.cast().controllers,
                                                     [](const auto& controller) { return controller.has_value(); });
    if (bool directs = scene.directs(); has_controllers && ImGui::Checkbox("told something now and then", &directs))
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
    begin_row("scan");
    choose_scan(state.wanted.scan);
    const ScanAdvice advice = scene.crowd().path(0)->scan;
    begin_row("");
    ImGui::TextDisabled("%s, %s", advice.method.c_str(), scene.crowd().path(0)->is_fused ? "fused" : "staged");
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("%s\n%s", advice.reason.c_str(), scene.crowd().path(0)->reason.c_str());
    begin_row("path");
    choose("##path", kPaths, state.wanted.path);
    begin_row("output");
    choose("##format", kFormats, state.wanted.format);
    begin_row("skinning");
    choose("##blend", kBlends, state.wanted.blend);
    ImGui::Checkbox("vertices once a frame", &state.wanted.skins_once);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("in compute, for the shadows and the picture");
    ImGui::Checkbox("only what is seen, as fine as it is seen", &state.wanted.culls);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("culling and levels of detail");
    if (!state.wanted.culls) return;
    begin_row("detail");
    ImGui::SliderFloat("##detail", &state.drawing.lod_pixels, 0.25f, 16, "off by %.2f pixels",
                       ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    ImGui::Checkbox("not who is hidden behind others", &state.drawing.occlusion);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("by the depths of the last frame; pays where large ones hide many");
    ImGui::Checkbox("small ones less often", &state.wanted.skips_updates);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("animated in every 2nd, 4th or 8th frame; in between, matrices go on evenly");
    if (!state.wanted.skips_updates) return;
    begin_row("smaller than");
    ImGui::SliderFloat("##full_rate", &state.drawing.full_rate_pixels, 0, 1000, "%.0f pixels",
                       ImGuiSliderFlags_AlwaysClamp);
    begin_row("update");
    ImGui::SliderFloat("##budget", &state.drawing.budget_ms, 0, 100,
                       state.drawing.budget_ms > 0 ? "at most %.1f ms" : "as long as it takes",
                       ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
}

void choose_camera(State& state) {
    begin_row("camera");
    if (!ImGui::BeginCombo("##camera", state.camera.c_str())) return;
    for (const char* name : {kByHand, "orbit", "flyover", "low", "follow"})
        if (ImGui::Selectable(name, state.camera == name)) state.camera = name;
    ImGui::EndCombo();
}

void picture_section(State& state) {
    choose_camera(state);
    ImGui::Checkbox("skeletons", &state.drawing.skeletons);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("a colour for each level");
    ImGui::SameLine(scaled(130));
    ImGui::Checkbox("boxes", &state.drawing.bounds);
    ImGui::Checkbox("shadows", &state.drawing.shadows);
    ImGui::SameLine(scaled(130));
    ImGui::Checkbox("fog", &state.drawing.fog);
    begin_row("exposure");
    ImGui::SliderFloat("##exposure", &state.drawing.exposure, 0.25f, 4, "%.2f",
                       ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::Button("whole crowd")) state.resets_view = true;
    ImGui::SameLine();
    if (ImGui::Button("screenshot")) state.takes_screenshot = true;
}

// Of the crowd and its characters.
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
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("characters of each level of detail, the finest first");
}

}  // namespace

void begin_row(const char* name) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(scaled(88));
    ImGui::SetNextItemWidth(-1);
}

bool choose_clip(const char* id, const Character& character, uint32_t& clip) {
    const auto name = [&](uint32_t index) {
        return index < character.clips.size() ? character.clips[index].name.c_str() : "rest pose";
    };
    if (!ImGui::BeginCombo(id, name(clip))) return false;
    const uint32_t before = clip;
    for (uint32_t i = 0; i < character.clips.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));  // names need not differ
        if (ImGui::Selectable(name(i), i == clip)) clip = i;
        ImGui::PopID();
    }
    ImGui::EndCombo();
    return clip != before;
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

void draw_settings(State& state, Scene& scene, const Measured& measured) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float gap = scaled(kPanelGap);
    ImGui::SetNextWindowPos({gap, gap});
    ImGui::SetNextWindowSizeConstraints({scaled(kSettingsWidth), 0}, {scaled(kSettingsWidth), display.y - 2 * gap});
    ImGui::Begin("settings", nullptr, kFixedPanel | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::Text("%.1f frames/s", measured.frame_ms > 0 ? 1000 / double{measured.frame_ms} : 0.0);
    ImGui::SameLine();
    ImGui::TextDisabled("%s", measured.device.substr(0, measured.device.find(" (")).c_str());
    ImGui::SameLine(scaled(kSettingsWidth) - scaled(34));
    if (ImGui::SmallButton("?")) state.shows_keys = !state.shows_keys;
    const auto section = [](const char* name, bool open) {
        return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
    };
    if (section("Crowd", true)) crowd_section(state);
    if (section("Animation", true)) animation_section(state, scene);
    if (section("Update", true)) update_section(state, scene);
    if (section("Picture", true)) picture_section(state);
    if (section("Figures", true)) figures_section(scene, measured);
    ImGui::End();
}

}  // namespace throng::view
