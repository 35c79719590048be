#include "controller/controller_tables.h"

#include "base/count.h"
#include "base/failure.h"
#include "controller/controller_arrays.h"
#include "controller/joint_mask.h"

#include <algorithm>
#include <array>
#include <bit>

namespace throng {
namespace {

template <class T>
auto words_of(const T& item) {
    return std::bit_cast<std::array<uint32_t, sizeof(T) / sizeof(uint32_t)>>(item);
}

// Appends the structs as words and returns where they begin.
template <class T>
uint32_t append(std::vector<uint32_t>& words, const std::vector<T>& items) {
    const auto begin = count_of(words);
    for (const T& item : items) {
        const auto added = words_of(item);
        words.insert(words.end(), added.begin(), added.end());
    }
    return begin;
}

// The most points of a state that have weight at once.
uint32_t active_points(const io::ControlState& state) {
    if (state.triangle_count > 0) return 3;
    return std::min(state.x_parameter == kNone ? 1u : 2u, state.point_count);
}

uint32_t max_active_clips(const ControllerArrays& arrays) {
    uint32_t count = 1;  // the rest pose
    for (const io::ControlLayer& layer : arrays.layers) {
        uint32_t of_play = 1;
        for (uint32_t state = 0; state < layer.state_count; ++state)
            of_play = std::max(of_play, active_points(arrays.states[layer.first_state + state]));
        count += io::kStackSize * of_play;
    }
    return count;
}

io::LayerState initial_state(const io::ControlLayer& layer) {
    io::LayerState state{};
    state.weight = state.weight_goal = layer.weight;
    state.mode = layer.mode;
    state.mask = layer.mask;
    state.taken = kNone;
    return state;
}

}  // namespace

ControllerTables make_controller_tables(const Controller& controller, const Character& character) {
    if (const auto checked = check_controller(controller, character); !checked) throw Failure(checked.error());
    const ControllerArrays arrays = make_controller_arrays(controller, character);
    ControllerTables tables;
    std::vector<uint32_t>& words = tables.words;
    append(words, std::vector{tables.layout});  // reserves its words; filled in below
    tables.layout = {
        .clips = append(words, arrays.clips),
        .layers = append(words, arrays.layers),
        .states = append(words, arrays.states),
        .points = append(words, arrays.points),
        .triangles = append(words, arrays.triangles),
        .edges = append(words, arrays.edges),
        .transitions = append(words, arrays.transitions),
        .conditions = append(words, arrays.conditions),
        .events = append(words, arrays.events),
        .layer_count = count_of(controller.layers),
        .parameter_count = count_of(controller.parameters),
        .clip_count = count_of(character.clips),
    };
    std::ranges::copy(words_of(tables.layout), words.begin());
    for (const JointMask& mask : controller.masks) {
        const std::vector<float> weights = mask_weights(mask, character.rig);
        tables.masks.insert(tables.masks.end(), weights.begin(), weights.end());
    }
    for (const ControllerParameter& parameter : controller.parameters)
        tables.initial_parameters.push_back(parameter.initial);
    for (const io::ControlLayer& layer : arrays.layers) tables.initial_layers.push_back(initial_state(layer));
    tables.active_clip_limit = max_active_clips(arrays);
    return tables;
}

}  // namespace throng
