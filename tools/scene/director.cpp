#include "tools/scene/director.h"

#include "tools/cli/command.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng::tools {

ParameterRange parameter_range(const Controller& controller, uint32_t parameter) {
    const std::string& name = controller.parameters[parameter].name;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    ParameterRange range{controller.parameters[parameter].type, kInfinity, -kInfinity};
    for (const ControllerLayer& layer : controller.layers) {
        const auto include = [&](float value) {
            range.least = std::min(range.least, value);
            range.most = std::max(range.most, value);
        };
        for (const ControllerState& state : layer.states)
            for (const BlendPoint& point : state.points) {
                if (state.x_parameter == name) include(point.x);
                if (state.y_parameter == name) include(point.y);
            }
        for (const ControllerTransition& transition : layer.transitions)
            for (const ControllerCondition& condition : transition.conditions)
                if (condition.parameter == name && range.type == ParameterType::kFloat) {
                    // So that the condition is sometimes true and sometimes false
                    const float beyond = condition.value == 0 ? 1 : 0.25f * std::abs(condition.value);
                    include(condition.value - beyond);
                    include(condition.value + beyond);
                }
    }
    return range.least <= range.most ? range : ParameterRange{.type = range.type};
}

Director::Director(std::span<const CrowdGroup> groups, uint64_t seed) : random_(seed) {
    uint32_t first = 0;
    for (const CrowdGroup& group : groups) {
        Cast cast{first, group.instance_count, {}};
        for (uint32_t p = 0; group.controller && p < group.controller->parameters.size(); ++p)
            if (!group.steering || group.steering->speed_parameter != p)
                cast.parameters.emplace_back(p, parameter_range(*group.controller, p));
        if (group.instance_count > 0 && !cast.parameters.empty()) casts_.push_back(std::move(cast));
        first += group.instance_count;
    }
}

void Director::direct(Crowd& crowd, double step_s) {
    constexpr double kChanges_per_s = 0.35;
    for (Cast& cast : casts_) {
        cast.owed += cast.instance_count * std::min(kChanges_per_s * std::abs(step_s), 1.0);
        for (; cast.owed >= 1; cast.owed -= 1) {
            const auto instance = cast.first_instance + static_cast<uint32_t>(random_.unit() * cast.instance_count);
            const auto& [parameter, range] =
                cast.parameters[static_cast<size_t>(random_.unit() * static_cast<double>(cast.parameters.size()))];
            const double unit = random_.unit();
            const auto value = static_cast<float>(
                range.type == ParameterType::kFloat ? creature::mix(range.least, range.most, unit) : std::round(unit));
            unwrap(crowd.set_parameter(InstanceHandle{instance}, parameter, value));
        }
    }
}

}  // namespace throng::tools
