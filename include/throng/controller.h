// Controllers: state machines as data. docs/controller.md says how they are written and evaluated.
#pragma once

#include <throng/character.h>

#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

// A number that each instance has, read by conditions, blend spaces, speeds and weights. A bool is 0 or 1; a trigger
// stays set (not 0) until an update takes a transition that has it as a condition.
enum class ParameterType { kFloat, kBool, kTrigger };
struct ControllerParameter {
    std::string name{};
    ParameterType type = ParameterType::kFloat;
    float initial = 0;
};

// An event that happens whenever a clip passes this time while it leads its layer (docs/controller.md).
struct ControllerEvent {
    std::string name{};
    std::string clip{};
    double time_s = 0;
};

// Sets the weight, 0..1, of a joint and all below it; later items win. With a ramp, the first `ramp` generations rise
// towards the weight in equal steps: generation g has weight * (g + 1) / (ramp + 1), where the joint itself is
// generation 0.
struct MaskItem {
    std::string joint{};
    float weight = 1;
    uint32_t ramp = 0;
};
struct JointMask {
    std::string name{};
    std::vector<MaskItem> items{};  // joints that no item sets have weight 0
};

// A clip within a state, at a place of its blend space: x and y are not used in a state without parameters.
struct BlendPoint {
    std::string clip{};
    float x = 0, y = 0;
};

// A state plays one clip, a blend space, or nothing. A blend space of one parameter has points ascending in x; between
// two points it mixes their clips. One of two parameters is triangulated: within a triangle it mixes its three clips,
// outside all of them the two clips of the nearest edge. Clips of a blend space keep the same phase. A state without
// points plays nothing: the layers below are seen as if this one had no weight, and a fade from or to another state
// fades the layer in or out.
struct ControllerState {
    std::string name{};
    std::vector<BlendPoint> points{};
    std::string x_parameter{}, y_parameter{};  // empty: none
    bool loop = true;
    float speed = 1;
    std::string speed_parameter{};  // multiplies speed
    // States of a layer with the same name here keep their phase when one follows the other; empty: none
    std::string sync{};
};

struct ControllerCondition {
    enum class Test { kAbove, kBelow, kIsTrue, kIsFalse, kTriggered };
    std::string parameter{};
    Test test = Test::kIsTrue;
    float value = 0;  // of kAbove and kBelow
};

enum class FadeKind { kCross, kInertial };

// A transition can be taken when all conditions hold and the leading state has played `exit` cycles since it was
// entered. An update takes the first in the list that can be taken.
struct ControllerTransition {
    std::string from{};  // empty: any state but `to`
    std::string to{};
    std::vector<ControllerCondition> conditions{};
    float exit = 0;  // cycles
    float fade_s = 0;
    FadeKind fade = FadeKind::kCross;
    bool interrupts = false;  // may be taken before the fade of the previous transition has ended
};

enum class LayerMode { kOverride, kAdditive };

// A layer without states plays what Crowd::play() says.
struct ControllerLayer {
    std::string name{};
    LayerMode mode = LayerMode::kOverride;
    // In a layer without states, Crowd::play() may ask for inertial fades, for which each instance keeps 144 bytes a
    // joint
    bool inertial_plays = false;
    // In a layer of mode kOverride, rotations of joints are blended in model space, not relative to their parents
    // (docs/controller.md); groups with such a layer are updated stage by stage
    bool model_space_rotations = false;
    std::string mask{};  // empty: all joints
    float weight = 1;
    std::string weight_parameter{};         // multiplies weight; the product is clamped to 0..1
    std::vector<ControllerState> states{};  // the layer starts in the first one
    std::vector<ControllerTransition> transitions{};

    // Index of the state with this name, for Crowd::set_state(), or kNone. The state that a file names as `start` comes
    // first, before the others in their order. state_named() is the same, but a missing name is an error that says
    // which there are: kInvalidArgument.
    StateIndex find_state(std::string_view state_name) const;
    Result<StateIndex> state_named(std::string_view state_name) const;
};

struct Controller {
    std::string name{};
    std::vector<ControllerParameter> parameters{};
    std::vector<ControllerEvent> events{};
    std::vector<JointMask> masks{};
    std::vector<ControllerLayer> layers{};  // lowest first

    // Index of the parameter, layer or mask with this name, or kNone. The ..._named() calls are the same, but a missing
    // name is an error that says which there are: kInvalidArgument. (kNone is also a valid mask, the whole body, and a
    // valid Steering::speed_parameter, none. There, a wrong name given to find_mask() or find_parameter() would go
    // unnoticed.)
    ParameterIndex find_parameter(std::string_view parameter_name) const;
    LayerIndex find_layer(std::string_view layer_name) const;
    MaskIndex find_mask(std::string_view mask_name) const;
    Result<ParameterIndex> parameter_named(std::string_view parameter_name) const;
    Result<LayerIndex> layer_named(std::string_view layer_name) const;
    Result<MaskIndex> mask_named(std::string_view mask_name) const;
    // All events with this name, as CharacterEvent::event has them: several clips may have one, such as a step.
    // events_named() is the same, but a missing name is an error that says which there are: kInvalidArgument.
    std::vector<EventIndex> find_events(std::string_view event_name) const;
    Result<std::vector<EventIndex>> events_named(std::string_view event_name) const;
};

// A controller of `count` layers (at least 1), none of which has states: they play what Crowd::play() says.
Controller direct_layers(uint32_t count = 4, std::vector<JointMask> masks = {}, bool inertial_plays = false);

// From JSON (docs/controller.schema.json). Errors name file and line: kFile, kInvalidFile (not JSON, unknown or missing
// fields, wrong types, names that are not there, numbers out of range).
Result<Controller> load_controller(const std::filesystem::path& path);
Result<Controller> parse_controller(std::string_view json, std::string_view name);

// Whether the controller can drive the character: clips and joints are there. Errors: kInvalidArgument, naming what is
// missing and what there is.
Result<void> check_controller(const Controller& controller, const Character& character);

}  // namespace throng
