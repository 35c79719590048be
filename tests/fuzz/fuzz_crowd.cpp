#include "tests/fuzz/fuzz_crowd.h"

#include "tools/creatures/creature.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace throng::fuzz {
namespace {

constexpr const char* kControllerJson = R"({
    "parameters": {"speed": 1, "hit": "trigger", "weight": 0.5},
    "events": [{"name": "step", "clip": "walk", "at_s": 0.25}],
    "layers": [
        {"name": "ground",
         "states": {
            "idle": {"clip": "idle"},
            "go": {"blend": "speed", "clips": [{"clip": "walk", "at": 0}, {"clip": "run", "at": 2}]},
            "empty": {"clip": null}},
         "transitions": [
            {"from": "idle", "to": "go", "when": {"speed": {"above": 0.5}}, "fade_s": 0.2},
            {"from": "go", "to": "idle", "when": {"speed": {"below": 0.4}}, "fade_s": 0.2, "fade": "inertial"},
            {"to": "empty", "when": {"hit": "triggered"}, "fade_s": 0.1},
            {"from": "empty", "to": "idle", "fade_s": 0.3}]},
        {"name": "wave", "mode": "additive", "weight": "weight", "states": {"wave": {"clip": "wave"}}},
        {"name": "played", "inertial": true}]})";

}  // namespace

void abort_with(std::string_view what, const Error& error) {
    std::fprintf(stderr, "%.*s: %s\n", static_cast<int>(what.size()), what.data(), error.text().c_str());
    std::abort();
}

void check_is_one_line(const Error& error) {
    if (error.text().find_first_of("\r\n\x1b") != std::string::npos) abort_with("a refusal is not one line", error);
}

void check_refusal(const Error& error, std::string_view name) {
    check_is_one_line(error);
    if (!error.text().starts_with(std::string(name) + ":")) abort_with("a refusal does not name the input", error);
}

Device& device() {
    static Device native = Device::create({.select = "native", .threads = 1}).value();
    return native;
}

const Character& small_walker() {
    static const Character walker =
        compile_character(
            make_creature({.joint_count = 16, .level_count = 5, .face_count = 60, .kind = CreatureKind::kWalker})
                .value())
            .value();
    return walker;
}

const Controller& walker_controller() {
    static const Controller controller = parse_controller(kControllerJson, "fuzz.json").value();
    return controller;
}

namespace {

std::vector<CrowdGroup> groups_of(bool shaders_populate) {
    static const ProceduralRules rules{.targets = {"prey"},
                                       .rules = {LookAtRule{.joint = small_walker().rig.names[2], .target = "prey"}}};
    const Character* walker = &small_walker();
    std::vector<CrowdGroup> groups{{.character = walker,
                                    .instance_count = 3,
                                    .pose_capacity = 2,
                                    .capacity = 6,
                                    .shader_commands = ShaderCommands{32}},
                                   {.character = walker,
                                    .instance_count = 3,
                                    .controller = &walker_controller(),
                                    .sockets = {3},
                                    .steering = Steering{},
                                    .capacity = 5,
                                    .shader_commands = ShaderCommands{32}},
                                   {.character = walker, .instance_count = 2, .procedural = &rules},
                                   {.character = walker, .instance_count = 3, .sockets = {2}, .is_carried = true}};
    if (shaders_populate)
        groups.push_back({.character = walker,
                          .controller = &walker_controller(),
                          .capacity = 8,
                          .shader_commands = ShaderCommands{.capacity = 32, .populate = true}});
    groups[0].outfits.resize(2);
    return groups;
}

// Names no instance if none with this number is alive.
InstanceHandle handle_of(const Crowd& crowd, uint32_t number) { return crowd.handle(number).value_or({}); }

}  // namespace

Crowd make_crowd(bool shaders_populate) {
    CrowdSettings settings{.groups = groups_of(shaders_populate), .culling = Culling{.skips_updates = true}};
    settings.event_capacity = 64;
    settings.pose_request_capacity = 4;
    Result<Crowd> crowd = Crowd::create(device(), settings);
    if (!crowd) abort_with("no crowd", crowd.error());
    return std::move(*crowd);
}

void use(Crowd& crowd, uint32_t update) {
    const uint32_t count = crowd.instance_count();
    for (uint32_t i = 0; i < count; ++i) {
        const InstanceHandle instance = handle_of(crowd, i);
        const float value = static_cast<float>((update + i) % 4) * 0.6f;
        (void)crowd.set_parameter(instance, 0, value);
        (void)crowd.set_parameter(instance, 1, 1.0f);
        (void)crowd.set_look(instance, {.tint = {value, 1, 1}, .outfit = i % 2});
        (void)crowd.set_target(instance, 0, TargetPlace{.world_place = {value, 1, 0}, .weight = 0.5f});
        (void)crowd.set_destination(instance, {value * 3, 0, value});
        if (update % 3 == i % 3) {
            (void)crowd.play(instance, 2,
                             LayerPlayback{.clip = {.clip = i % 4}, .fade_s = 0.2f, .fade = FadeKind::kInertial});
            (void)crowd.set_playback(instance, {.first = {.clip = i % 4}, .second = {.clip = 1}, .weight = 0.5f});
            (void)crowd.set_pose(instance, std::vector<Trs<float>>(small_walker().rig.rest), 0.3f);
            (void)crowd.request_poses(instance);
        } else if (update % 3 == (i + 1) % 3) {
            (void)crowd.clear_pose(instance, 0.2f);
            (void)crowd.attach(instance, Attachment{.carrier = handle_of(crowd, 6)});
        } else if (update % 5 == 4) {
            (void)crowd.despawn(instance);
        }
    }
    (void)crowd.spawn(update % 2, to_affine(Trs<float>{.translation = {1, 0, 2}}));
    (void)crowd.watch(handle_of(crowd, 7));
    const Bounds bounds{{-5, 0, -5}, {5, 3, 5}};
    const CrowdView view = view_of(fit_camera(bounds, 1), 64, 64, bounds).value();
    (void)crowd.update(0.1f, update % 2 == 0 ? &view : nullptr);
    (void)crowd.feedback();
    (void)crowd.read_drawn();
    for (uint32_t i = 0; i < count; ++i) (void)crowd.read_positions(handle_of(crowd, i));
}

void animate_and_draw(const Character& character) {
    const auto clip_count = static_cast<uint32_t>(character.clips.size());
    const uint32_t instance_count = std::min(clip_count, 8u) + 1;
    CrowdSettings settings{.groups = {{.character = &character, .instance_count = instance_count}},
                           .culling = Culling{.skips_updates = true, .reduces_joints = true}};
    settings.keep_model_matrices = true;
    settings.skins_once = true;
    Result<Crowd> crowd = Crowd::create(device(), settings);
    if (!crowd) return;
    for (uint32_t i = 0; i < instance_count; ++i) {
        const uint32_t first = i < clip_count ? i : kNone, second = i + 1 < clip_count ? i + 1 : kNone;
        const Playback playback{
            .first = {.clip = first, .time_s = 0.3f}, .second = {.clip = second, .loop = false}, .weight = 0.6f};
        (void)crowd->set_playback(InstanceHandle{i}, playback);
    }
    Result<Renderer> renderer = Renderer::create(device(), {.width = 64, .height = 48});
    if (!renderer) abort_with("no renderer", renderer.error());
    const Camera camera = fit_camera(main_bounds(*crowd), 64.0f / 48);
    for (const float step_s : {0.0f, 0.7f, 1e4f}) (void)renderer->render_frame(*crowd, step_s, camera);
    (void)crowd->update(0.1f);
    (void)renderer->render(*crowd, Camera{});
}

}  // namespace throng::fuzz
