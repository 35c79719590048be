#include "controller/controller_arrays.h"

#include "base/count.h"
#include "base/find_name.h"
#include "controller/blend_space.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

// Converts the controller for the character; `out` is the result.
class Arrays {
public:
    Arrays(const Controller& controller, const Character& character) : controller_(controller), character_(character) {
        for (const ControllerEvent& event : controller.events)
            event_clips_.push_back(find_name(character.clips, event.clip));
        for (uint32_t clip = 0; clip < character.clips.size(); ++clip) add_clip(clip);
        out.clips.push_back({});  // the rest pose
        for (const ControllerLayer& layer : controller.layers) add_layer(layer);
    }

    ControllerArrays out;

private:
    void add_clip(uint32_t index) {
        const Clip& clip = character_.clips[index];
        const uint32_t first_event = count_of(out.events);
        for (uint32_t event = 0; event < controller_.events.size(); ++event)
            if (event_clips_[event] == index)
                out.events.push_back({phase_at(controller_.events[event].time_s, clip.duration_s, false), event});
        std::ranges::stable_sort(out.events.begin() + first_event, out.events.end(), {}, &io::ControlEvent::phase);
        const float rate = clip.duration_s > 0 ? 1 / clip.duration_s : 0;
        out.clips.push_back({.rate = std::isfinite(rate) ? rate : 0,
                             .first_event = first_event,
                             .event_count = count_of(out.events) - first_event,
                             .first_root = clip.first_root_row,
                             .root_count = clip.root_row_count});
    }

    void add_layer(const ControllerLayer& layer) {
        const uint32_t first_state = count_of(out.states);
        out.layers.push_back({.first_state = first_state,
                              .state_count = count_of(layer.states),
                              .mode = layer.mode == LayerMode::kAdditive ? io::kModeAdditive : io::kModeOverride,
                              .mask = layer.mask.empty() ? kNone : find_name(controller_.masks, layer.mask),
                              .weight = layer.weight,
                              .weight_parameter = parameter(layer.weight_parameter),
                              .model_rotations = layer.model_space_rotations ? 1u : 0u,
                              .has_empty_states = has_empty_state(layer) ? 1u : 0u});
        std::vector<std::string> sync_groups;
        for (const ControllerState& state : layer.states) add_state(state, sync_groups);
        add_transitions(layer, first_state);
    }

    static bool has_empty_state(const ControllerLayer& layer) {
        return std::ranges::any_of(layer.states, [](const ControllerState& state) { return state.points.empty(); });
    }

    void add_state(const ControllerState& state, std::vector<std::string>& sync_groups) {
        io::ControlState added{.first_point = count_of(out.points),
                               .point_count = std::max(count_of(state.points), 1u),
                               .first_triangle = count_of(out.triangles),
                               .first_edge = count_of(out.edges),
                               .x_parameter = parameter(state.x_parameter),
                               .y_parameter = parameter(state.y_parameter),
                               .speed_parameter = parameter(state.speed_parameter),
                               .speed = state.speed,
                               .loop = state.loop,
                               .sync = state.sync.empty() ? kNone : group(sync_groups, state.sync)};
        for (const BlendPoint& point : state.points)
            out.points.push_back({find_name(character_.clips, point.clip), point.x, point.y, 0});
        if (state.points.empty()) out.points.push_back({count_of(character_.clips), 0, 0, 0});
        if (!state.y_parameter.empty())
            add_blend_space(added, state);
        else if (!state.x_parameter.empty())
            add_spans(added);
        out.states.push_back(added);
    }

    void add_blend_space(io::ControlState& added, const ControllerState& state) {
        const BlendSpace space = make_blend_space(state.points);
        out.triangles.insert(out.triangles.end(), space.triangles.begin(), space.triangles.end());
        out.edges.insert(out.edges.end(), space.edges.begin(), space.edges.end());
        added.triangle_count = count_of(space.triangles);
        added.edge_count = count_of(space.edges);
    }

    void add_spans(const io::ControlState& added) {
        for (uint32_t i = added.first_point; i + 1 < count_of(out.points); ++i)
            out.points[i].inverse_span = static_cast<float>(1 / (double{out.points[i + 1].x} - out.points[i].x));
    }

    // Each state has its own list, which includes the transitions from any state, except those that lead to the state
    // itself.
    void add_transitions(const ControllerLayer& layer, uint32_t first_state) {
        std::vector<io::ControlTransition> all;
        for (const ControllerTransition& transition : layer.transitions) all.push_back(converted(transition, layer));
        for (uint32_t state = 0; state < layer.states.size(); ++state) {
            io::ControlState& from = out.states[first_state + state];
            from.first_transition = count_of(out.transitions);
            for (size_t i = 0; i < all.size(); ++i) {
                const std::string& named = layer.transitions[i].from;
                if (named.empty() ? all[i].to != state : named == layer.states[state].name)
                    out.transitions.push_back(all[i]);
            }
            from.transition_count = count_of(out.transitions) - from.first_transition;
        }
    }

    io::ControlTransition converted(const ControllerTransition& transition, const ControllerLayer& layer) {
        // One less, so that a clip that has stopped at kLastPhase counts as one whole cycle.
        const auto exit = static_cast<uint64_t>(std::max(std::round(transition.exit * 0x1p32) - 1, 0.0));
        const io::ControlTransition added{
            .to = find_name(layer.states, transition.to),
            .first_condition = count_of(out.conditions),
            .condition_count = count_of(transition.conditions),
            .exit_loops = static_cast<uint32_t>(exit >> 32),
            .exit_phase = static_cast<uint32_t>(exit),
            .fade_rate = transition.fade_s > 0 ? 1 / transition.fade_s : 0,
            .flags = (transition.interrupts ? io::kTransitionInterrupts : 0) |
                     (transition.fade == FadeKind::kInertial ? io::kTransitionInertial : 0)};
        for (const ControllerCondition& condition : transition.conditions)
            out.conditions.push_back(
                {parameter(condition.parameter), static_cast<uint32_t>(condition.test), condition.value});
        return added;
    }

    uint32_t parameter(std::string_view name) const {
        return name.empty() ? kNone : find_name(controller_.parameters, name);
    }

    static uint32_t group(std::vector<std::string>& groups, const std::string& name) {
        const auto found = std::ranges::find(groups, name);
        const auto index = static_cast<uint32_t>(found - groups.begin());
        if (found == groups.end()) groups.push_back(name);
        return index;
    }

    const Controller& controller_;
    const Character& character_;
    std::vector<uint32_t> event_clips_;  // [event_count]
};

using ConditionTest = ControllerCondition::Test;
static_assert(uint32_t(ConditionTest::kAbove) == io::kTestAbove && uint32_t(ConditionTest::kBelow) == io::kTestBelow &&
              uint32_t(ConditionTest::kIsTrue) == io::kTestTrue &&
              uint32_t(ConditionTest::kIsFalse) == io::kTestFalse &&
              uint32_t(ConditionTest::kTriggered) == io::kTestTriggered);

}  // namespace

ControllerArrays make_controller_arrays(const Controller& controller, const Character& character) {
    return Arrays(controller, character).out;
}

uint32_t phase_at(double time_s, double duration_s, bool loop) {
    if (!(duration_s > 0)) return 0;
    const double cycles = time_s / duration_s;
    if (!loop) return static_cast<uint32_t>(std::clamp(std::round(cycles * 0x1p32), 0.0, double{io::kLastPhase}));
    // 2^32 wraps around to the beginning
    return static_cast<uint32_t>(static_cast<uint64_t>(std::round((cycles - std::floor(cycles)) * 0x1p32)));
}

}  // namespace throng
