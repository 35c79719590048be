#include "bench/control_bench.h"

#include "bench/updates.h"

#include <throng/reference.h>

#include <cmath>
#include <random>

namespace throng::bench {
namespace {

constexpr uint32_t kWarmUp = 30;             // updates, so that states, fades and times have spread
constexpr uint32_t kCheckedCharacters = 16;  // characters, followed by the reference

using Test = ControllerCondition::Test;

ControllerState plays(std::string name, std::string clip, float speed, bool loop = true) {
    return {.name = std::move(name), .points = {{std::move(clip)}}, .loop = loop, .speed = speed};
}

ControllerTransition leads(std::string from, std::string to, std::vector<ControllerCondition> conditions, float exit,
                           float fade_s) {
    return {.from = std::move(from),
            .to = std::move(to),
            .conditions = std::move(conditions),
            .exit = exit,
            .fade_s = fade_s,
            .interrupts = true};
}

}  // namespace

Controller control_bench_controller(const Character& character) {
    Controller controller{.name = "bench control"};
    controller.parameters = {{"forward"},
                             {"side"},
                             {"watch"},
                             {.name = "grounded", .type = ParameterType::kBool, .initial = 1},
                             {.name = "strike", .type = ParameterType::kTrigger}};
    controller.events = {{"step", "walk", 0.3}, {"step", "walk", 0.9}, {"beat", "fly", 0.25}};
    controller.masks = {
        {.name = "front", .items = {{.joint = character.rig.names[character.rig.joint_count() / 3], .ramp = 2}}}};
    const ControllerState move{
        .name = "move",
        .points = {{"idle", 0, 0}, {"walk", 0, 1}, {"walk", 1, 0}, {"walk", -1, 0}, {"fly", 0, 3}},
        .x_parameter = "side",
        .y_parameter = "forward"};
    controller.layers.push_back(
        {.name = "body",
         .states = {plays("stand", "idle", 1), move, plays("take off", "fly", 1.2f, false), plays("air", "fly", 1),
                    plays("land", "walk", 1, false), plays("fidget", "idle", 1.5f, false)},
         .transitions = {leads("stand", "move", {{"forward", Test::kAbove, 0.1f}}, 0, 0.2f),
                         leads("move", "stand", {{"forward", Test::kBelow, 0}}, 0, 0.3f),
                         leads("", "take off", {{"grounded", Test::kIsFalse}, {"strike", Test::kTriggered}}, 0, 0.2f),
                         leads("take off", "air", {}, 0.8f, 0.3f),
                         leads("air", "land", {{"grounded", Test::kIsTrue}}, 0, 0.4f),
                         leads("land", "stand", {}, 0.9f, 0.3f), leads("stand", "fidget", {}, 2, 0.5f),
                         leads("fidget", "stand", {}, 1, 0.5f)}});
    controller.layers.push_back(
        {.name = "front",
         .mask = "front",
         .weight_parameter = "watch",
         .states = {plays("calm", "idle", 0.5f), plays("look", "walk", -0.5f), plays("strike", "fly", 2, false)},
         .transitions = {
             leads("", "strike", {{"strike", Test::kTriggered}}, 0, 0.1f), leads("strike", "look", {}, 1, 0.3f),
             leads("calm", "look", {{"side", Test::kAbove, 0.5f}}, 0, 0.3f), leads("look", "calm", {}, 3, 0.8f)}});
    controller.layers.push_back(
        {.name = "breath",
         .mode = LayerMode::kAdditive,
         .weight = 0.3f,
         .states = {plays("slow", "idle", 0.7f), plays("quick", "walk", 1), plays("beating", "fly", 1)},
         .transitions = {leads("slow", "quick", {{"forward", Test::kAbove, 1}}, 0, 0.4f),
                         leads("quick", "slow", {{"forward", Test::kBelow, 1}}, 0, 0.6f),
                         leads("", "beating", {{"grounded", Test::kIsFalse}}, 0, 0.3f),
                         leads("beating", "slow", {{"grounded", Test::kIsTrue}}, 0, 0.6f)}});
    return controller;
}

Json measure_control(const Device& device, const ControlCase& control, const Progress& progress) {
    const Character& character = *control.character;
    const Controller controller = control_bench_controller(character);
    const std::string what = std::to_string(control.count) + " x " + std::to_string(character.rig.joint_count());
    progress(what + ": preparing");
    Crowd crowd = value_of(Crowd::create(
        device, {.groups = {{.character = &character, .instance_count = control.count, .controller = &controller}},
                 .path = control.path}));
    std::vector<ReferenceCharacter> references;
    for (uint32_t i = 0; i < std::min(kCheckedCharacters, control.count); ++i)
        references.push_back(value_of(ReferenceCharacter::create(character, controller)));

    // Sets parameters as an application would: of nearly all characters at first, and then of a hundredth of them in
    // each update.
    std::mt19937_64 random(control.seed);
    const auto set_parameters = [&](uint32_t characters) {
        for (uint32_t k = 0; k < characters; ++k) {
            const auto instance = static_cast<uint32_t>(random() % control.count),
                       parameter = static_cast<uint32_t>(random() % controller.parameters.size());
            const float unit = static_cast<float>(random() % 1024) / 1023;
            const bool is_float = controller.parameters[parameter].type == ParameterType::kFloat;
            const float value = is_float ? 3 * unit - 1 : std::round(unit);
            value_of(crowd.set_parameter(InstanceHandle{instance}, parameter, value));
            if (instance < references.size()) value_of(references[instance].set_parameter(parameter, value));
        }
    };
    const uint32_t changed = std::max(1u, control.count / 100);
    for (uint32_t update = 0; update < kWarmUp; ++update) {
        set_parameters(update == 0 ? 4 * control.count : changed);
        value_of(crowd.update(kFrame_s));
        for (ReferenceCharacter& reference : references) value_of(reference.update(kFrame_s));
    }
    double error = 0;
    for (uint32_t i = 0; i < references.size(); ++i)
        error = std::max(error, skin_error(value_of(crowd.read_skin_matrices({i})),
                                           references[i].pose().model_from_bind, character.size));
    Json record = where_and_when(device.info());
    record.update({{"bench", "control"},
                   {"characters", control.count},
                   {"joints", character.rig.joint_count()},
                   {"levels", character.rig.level_count},
                   {"states", 12},
                   {"layers", 3},
                   {"commands", changed},
                   {"samples", control.samples},
                   {"max_error", error},
                   {"path", path_name(crowd)}});
    if (!(error <= kSkinErrorBound)) {
        record["wrong"] = true;
        return record;
    }
    UpdateTimes times;
    const GpuLoad load(device.gpu());
    const TimedRun updates{what, [&] {
                               set_parameters(changed);
                               times.take(load, crowd);
                           }};
    run_rounds({&updates, 1}, control.samples, progress);
    const Spread of_control = times.stage(index_of_stage("control")), of_update = times.total();
    record.update({{"host_samples", times.count_by_host()},
                   {"control_ms", spread_json(of_control)},
                   {"update_ms", spread_json(of_update)},
                   {"ns_per_character", of_control.median * 1e6 / control.count},
                   {"share", of_control.median / of_update.median}});
    return record;
}

}  // namespace throng::bench
