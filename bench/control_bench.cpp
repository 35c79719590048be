#include "bench/control_bench.h"

#include "bench/record.h"
#include "tools/cli/statistics.h"
#include "bench/value_of.h"

#include <throng/reference.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace throng::bench {
namespace {

constexpr float kStep_s = 1.0f / 60;
constexpr double kMostError = 1e-4;  // of the character's size
constexpr uint32_t kWarmUp = 30;     // updates, so that states, fades and times have spread
constexpr uint32_t kChecked = 16;    // characters, followed by the reference

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

// What an application would do: in each update a hundredth of the characters, and at first all of them, are told
// something new.
class Director {
public:
    Director(const Controller& controller, uint32_t count, uint64_t seed)
        : controller_(controller), count_(count), random_(seed) {}

    void direct(uint32_t telling, const std::function<void(uint32_t, uint32_t, float)>& tell) {
        for (uint32_t k = 0; k < telling; ++k) {
            const auto instance = static_cast<uint32_t>(random_() % count_),
                       parameter = static_cast<uint32_t>(random_() % controller_.parameters.size());
            const float unit = static_cast<float>(random_() % 1024) / 1023;
            tell(instance, parameter,
                 controller_.parameters[parameter].type == ParameterType::kFloat ? 3 * unit - 1 : std::round(unit));
        }
    }

private:
    const Controller& controller_;
    uint32_t count_;
    std::mt19937_64 random_;
};

double largest_error(Crowd& crowd, std::span<const ReferenceCharacter> references, double size) {
    double worst = 0;
    for (uint32_t i = 0; i < references.size(); ++i) {
        const std::vector<Affine> matrices = value_of(crowd.read_skin_matrices(i));
        const ReferencePose pose = references[i].pose();
        for (size_t entry = 0; entry < matrices.size(); ++entry)
            for (size_t row = 0; row < 3; ++row)
                for (size_t column = 0; column < 4; ++column) {
                    const double error = std::abs(double{matrices[entry].row[row][column]} -
                                                  pose.model_from_bind[entry].row[row][column]) /
                                         (column == 3 ? size : 1);
                    worst = error <= worst ? worst : error;
                }
    }
    return worst;
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

nlohmann::json measure_control(const Device& device, const ControlCase& control,
                               const std::function<void(const std::string&)>& progress) {
    const Character& character = *control.character;
    const Controller controller = control_bench_controller(character);
    const std::string what = std::to_string(control.count) + " x " + std::to_string(character.rig.joint_count());
    progress(what + ": preparing");
    Crowd crowd = value_of(Crowd::create(
        device, {.groups = {{.character = &character, .instance_count = control.count, .controller = &controller}}}));
    std::vector<ReferenceCharacter> references;
    for (uint32_t i = 0; i < std::min(kChecked, control.count); ++i)
        references.push_back(value_of(ReferenceCharacter::create(character, controller)));
    Director director(controller, control.count, control.seed);
    const auto tell = [&](uint32_t instance, uint32_t parameter, float value) {
        value_of(crowd.set_parameters(instance, parameter, {&value, 1}));
        if (instance < references.size()) value_of(references[instance].set_parameters(parameter, {&value, 1}));
    };
    const uint32_t changed = std::max(1u, control.count / 100);
    std::vector<double> control_ms, update_ms;
    double error = 0;
    for (uint32_t update = 0; update < kWarmUp + control.samples; ++update) {
        director.direct(update == 0 ? 4 * control.count : changed, tell);
        value_of(crowd.update(kStep_s));
        for (ReferenceCharacter& reference : references) value_of(reference.update(kStep_s));
        if (update + 1 == kWarmUp) error = largest_error(crowd, references, character.size);
        if (!(error <= kMostError)) break;
        if (update < kWarmUp) continue;
        progress(what + ": update " + std::to_string(update + 1 - kWarmUp) + " of " + std::to_string(control.samples));
        const StageTimes times = value_of(crowd.stage_times());
        control_ms.push_back(times.of("control"));
        update_ms.push_back(times.total());
    }
    const Spread of_control = spread_of(control_ms), of_update = spread_of(update_ms);
    nlohmann::json record = where_and_when(device.info());
    record.update({{"bench", "control"},
                   {"characters", control.count},
                   {"joints", character.rig.joint_count()},
                   {"levels", character.rig.level_count},
                   {"states", 12},
                   {"layers", 3},
                   {"commands", changed},
                   {"samples", control.samples},
                   {"max_error", error},
                   {"path", crowd.path(0)->is_fused ? "fused" : "staged"}});
    if (!(error <= kMostError)) {
        record["wrong"] = true;
        return record;
    }
    record.update({{"control_ms", {{"p5", of_control.p5}, {"median", of_control.median}, {"p95", of_control.p95}}},
                   {"update_ms", {{"p5", of_update.p5}, {"median", of_update.median}, {"p95", of_update.p95}}},
                   {"ns_per_character", of_control.median * 1e6 / control.count},
                   {"share", of_control.median / of_update.median}});
    return record;
}

}  // namespace throng::bench
