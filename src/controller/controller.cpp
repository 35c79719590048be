#include <throng/controller.h>

#include "base/failure.h"
#include "base/find_name.h"
#include "base/message_name.h"
#include "controller/controller_rules.h"
#include "json/json_view.h"
#include "json/known_names.h"

#include <cassert>

namespace throng {
namespace {

std::string seconds(double time_s) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.4g s", time_s);
    return text;
}

void check_clips(const Controller& controller, const Character& character) {
    KnownNames clips("clip");
    for (const Clip& clip : character.clips) clips.add(clip.name);
    for (size_t i = 0; i < controller.events.size(); ++i) {
        const ControllerEvent& event = controller.events[i];
        const std::string place = place_of("events", i);
        const Clip& clip = character.clips[clips.require(event.clip, place_of(place, "clip"))];
        if (static_cast<float>(event.time_s) > clip.duration_s)
            throw Failure(ErrorCode::kInvalidArgument, place_of(place, "at_s"), seconds(event.time_s),
                          " is beyond the end of clip '", printable(clip.name), "', which lasts ",
                          seconds(double{clip.duration_s}));
    }
    for (size_t i = 0; i < controller.layers.size(); ++i)
        for (const ControllerState& state : controller.layers[i].states) {
            const std::string place = place_of("layers", i, "states", state.name);
            for (size_t k = 0; k < state.points.size(); ++k)
                clips.require(state.points[k].clip,
                              place_of(state.x_parameter.empty() ? place : place_of(place, "clips", k), "clip"));
        }
}

void check_joints(const Controller& controller, const Character& character) {
    KnownNames joints("joint");
    for (const std::string& joint : character.rig.names) joints.add(joint);
    for (const JointMask& mask : controller.masks)
        for (size_t i = 0; i < mask.items.size(); ++i)
            joints.require(mask.items[i].joint, place_of("masks", mask.name, i, "joint"));
}

}  // namespace

StateIndex ControllerLayer::find_state(std::string_view state_name) const { return find_name(states, state_name); }
Result<StateIndex> ControllerLayer::state_named(std::string_view state_name) const {
    return index_named<StateIndex>(name, "state", states, state_name);
}

ParameterIndex Controller::find_parameter(std::string_view parameter_name) const {
    return find_name(parameters, parameter_name);
}
LayerIndex Controller::find_layer(std::string_view layer_name) const { return find_name(layers, layer_name); }
MaskIndex Controller::find_mask(std::string_view mask_name) const { return find_name(masks, mask_name); }
std::vector<EventIndex> Controller::find_events(std::string_view event_name) const {
    return find_all_names<EventIndex>(events, event_name);
}
Result<std::vector<EventIndex>> Controller::events_named(std::string_view event_name) const {
    const Result<EventIndex> first = index_named<EventIndex>(name, "event", events, event_name);
    if (!first) return first.error();
    return find_events(event_name);
}
Result<ParameterIndex> Controller::parameter_named(std::string_view parameter_name) const {
    return index_named<ParameterIndex>(name, "parameter", parameters, parameter_name);
}
Result<LayerIndex> Controller::layer_named(std::string_view layer_name) const {
    return index_named<LayerIndex>(name, "layer", layers, layer_name);
}
Result<MaskIndex> Controller::mask_named(std::string_view mask_name) const {
    return index_named<MaskIndex>(name, "mask", masks, mask_name);
}

Controller direct_layers(uint32_t count, std::vector<JointMask> masks, bool inertial_plays) {
    assert(count >= 1);
    Controller controller;
    controller.name = "direct";
    controller.masks = std::move(masks);
    for (uint32_t i = 0; i < count; ++i)
        controller.layers.push_back({.name = "layer " + std::to_string(i), .inertial_plays = inertial_plays});
    return controller;
}

Result<void> check_controller(const Controller& controller, const Character& character) {
    const auto rules = as_result([&] { check_rules(controller); });
    const auto fits = rules ? as_result([&] {
        check_clips(controller, character);
        check_joints(controller, character);
    })
                            : rules;
    if (fits) return {};
    const std::string both = message_name(controller.name) + " with " + message_name(character.name);
    return Error{fits.error().code, both + ": " + fits.error().place, fits.error().message};
}

}  // namespace throng
