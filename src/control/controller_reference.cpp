#include "control/controller_reference.h"

#include "control/array_tables.h"
#include "control/control_reference.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace throng {
namespace io {
namespace {

// The kernel's own source, for one instance; it fills a ControllerUpdate instead of the device's buffers.
struct ControllerText : ArrayTables {
    const Character& character;
    std::vector<float>& parameters;
    std::vector<LayerState>& layers;
    ControllerPush push{};  // only its time_step_s is used
    ControllerUpdate* update = nullptr;
    ControllerLayout layout_of_group{};
    uint instance = 0, first_parameter = 0;
    uint shown_layer = 0;
    float shown_weight = 0;

    // Parameters that are not finite, or denormal, count as 0 (docs/controller.md).
    float parameter_at(uint index) const { return std::isnormal(parameters[index]) ? parameters[index] : 0; }
    const LayerState& load_layer_state(uint index) const { return layers[index]; }

#include "control/plays.glsl"

    void add_rest_pose() { update->active_clips.push_back({.clip = static_cast<uint>(character.clips.size())}); }

    // Step 9.
    void begin_layer(const LayerState& state, const ControlLayer&, float weight) {
        const bool covers_all = weight >= 1 && state.mode == kModeOverride && state.mask == kNone;
        if (update->active_clips.empty() && !covers_all) add_rest_pose();
        shown_weight = weight;
    }
    void add_active_clip(uint clip, uint phase, float weight) {
        const LayerState& state = layers[shown_layer];
        const double duration_s = clip < character.clips.size() ? character.clips[clip].duration_s : 0;
        update->active_clips.push_back(
            {.clip = clip,
             .phase = phase,
             .time_s = phase * 0x1p-32 * duration_s,
             .weight = weight,
             .layer = shown_layer,
             .layer_weight = shown_weight,
             .mode = state.mode,
             .mask = state.mask,
             .model_rotations = state.mode == kModeOverride && load_layer(shown_layer).model_rotations != 0});
    }

    // Step 8.
    void add_move(uint index, const PhaseStep& step, float weight) {
        const ControlClip& clip = load_clip(index);
        const auto rows = RootRows(character.root_rows).subspan(clip.first_root, clip.root_count);
        add_weighted(update->move, move_between(rows, step.before, step.after, step.crossed), double{weight});
    }
    void scale_move(float shown) {
        const GroundMove moved = std::exchange(update->move, {.cos = 0});
        add_weighted(update->move, moved, double{shown});
        add_weighted(update->move, {}, 1 - double{shown});
    }

    // Step 7: looks at the position of each event in each cycle that the step touches.
    void emit_events(uint clip, const PhaseStep& step, uint layer) {
        constexpr int64_t kCycle = int64_t{1} << 32;
        const int64_t before = step.before, after = step.crossed * kCycle + step.after;
        const int64_t low = std::min(before, after), high = std::max(before, after) + (step.reached_end ? 1 : 0);
        const size_t first = update->events.size();
        const ControlClip& heard = load_clip(clip);
        if (heard.event_count == 0) return;  // saves going through up to a billion cycles
        const int64_t direction = step.crossed < 0 ? -1 : 1, cycle_count = std::abs(int64_t{step.crossed}) + 1;
        const auto has_room = [&] { return update->events.size() < kMaxEvents; };
        for (int64_t cycle = 0; cycle < cycle_count && has_room(); ++cycle)
            for (const ControlEvent& event : std::span(arrays.events).subspan(heard.first_event, heard.event_count)) {
                const int64_t place = direction * cycle * kCycle + event.phase;
                if (place < low || place >= high || !has_room()) continue;
                const double distance = static_cast<double>(std::abs(place - before)) * 0x1p-32;
                update->events.push_back(
                    {event.event, layer,
                     std::abs(double{push.time_step_s}) * std::min(distance / std::abs(double{step.cycles}), 1.0)});
            }
        std::ranges::stable_sort(std::span(update->events).subspan(first), {}, &ControllerEventAt::time_s);
    }

#include "control/commands.glsl"
#include "control/layer.glsl"
};

}  // namespace
}  // namespace io

ControllerReference::ControllerReference(const Controller& controller, const Character& character)
    : character_(character) {
    const ControllerTables tables = make_controller_tables(controller, character);
    arrays_ = make_controller_arrays(controller, character);
    parameters = tables.initial_parameters;
    layers = tables.initial_layers;
}

void ControllerReference::apply(const io::ControlCommand& command) {
    io::ControllerText{{arrays_}, character_, parameters, layers}.obey(command, command.target, command.target);
}

ControllerUpdate ControllerReference::update(float time_step_s) {
    ControllerUpdate update{.move = {.cos = 0}};  // moves are summed up in it
    io::ControllerText text{{arrays_}, character_, parameters, layers, {.time_step_s = time_step_s}, &update};
    text.layout_of_group.layer_count = static_cast<uint32_t>(layers.size());
    text.layout_of_group.clip_count = static_cast<uint32_t>(character_.clips.size());
    for (; text.shown_layer < layers.size(); ++text.shown_layer) text.update_layer(text.shown_layer);
    text.reset_triggers();
    if (update.active_clips.empty()) text.add_rest_pose();
    update.move = turned_to_length_one(update.move);
    update.inertial_s = text.begun_duration_s;
    return update;
}

std::vector<io::ActiveClip> to_io(std::span<const ControllerActiveClip> active_clips, const Character& character) {
    std::vector<io::ActiveClip> out;
    for (size_t i = 0; i < active_clips.size(); ++i) {
        const ControllerActiveClip& active_clip = active_clips[i];
        const Clip rest_pose{.row_count = 1};
        const Clip& clip = active_clip.clip < character.clips.size() ? character.clips[active_clip.clip] : rest_pose;
        // Computed in float, like the time in the kernel, so that both find the same rows.
        const float time_s = (static_cast<float>(active_clip.phase) * 0x1p-32f) * clip.duration_s;
        const RowCursor rows = find_rows_reference(
            std::span(character.times_s)
                .subspan(clip.first_time, std::min<size_t>(clip.row_count, character.times_s.size() - clip.first_time)),
            time_s);
        const auto row = [&](uint32_t index) { return clip.first_row + index * clip.row_stride; };
        uint32_t flags = active_clip.mode == io::kModeAdditive ? io::kActiveClipAdditive : 0;
        if (active_clip.model_rotations) flags |= io::kActiveClipModelRotations;
        if (active_clip.mask != kNone) flags |= io::kActiveClipMasked | active_clip.mask << io::kActiveClipMaskShift;
        if (i == 0 || active_clips[i - 1].layer != active_clip.layer) flags |= io::kActiveClipBeginsLayer;
        if (i + 1 == active_clips.size() || active_clips[i + 1].layer != active_clip.layer)
            flags |= io::kActiveClipEndsLayer;
        if (i + 1 == active_clips.size()) flags |= io::kActiveClipEnds;
        out.push_back({.first_track = active_clip.clip * character.rig.joint_count(),
                       .earlier = row(rows.earlier),
                       .later = row(rows.later),
                       .fraction = static_cast<float>(rows.fraction),
                       .weight = active_clip.weight,
                       .layer_weight = active_clip.layer_weight,
                       .reference_row = clip.first_row,
                       .flags = flags});
    }
    return out;
}

}  // namespace throng
