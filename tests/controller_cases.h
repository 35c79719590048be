// JSON for a controller that uses every feature, and ways to break it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace throng::test {

inline const std::string kCompleteController = R"({
  "$schema": "controller.schema.json",
  "parameters": {
    "speed": 0.25, "side": -1e-3, "alert": true, "tired": false,
    "jump": "trigger"
  },
  "events": [
    {"name": "step", "clip": "walk", "at_s": 0.3},
    {"name": "step", "clip": "run", "at_s": 1e-1}
  ],
  "masks": {
    "upper": [
      {"joint": "spine", "ramp": 3},
      {"joint": "head", "weight": 0.5}
    ],
    "left arm": [{"joint": "arm.L"}]
  },
  "layers": [
    {
      "name": "base",
      "start": "move",
      "states": {
        "zebra": {"clip": "idle"},
        "move": {
          "blend": "speed",
          "clips": [
            {"clip": "walk", "at": 1.5},
            {"clip": "run", "at": 4}
          ],
          "speed": {"parameter": "speed", "times": 0.5},
          "sync": "legs"
        },
        "aim": {
          "blend": ["side", "speed"],
          "clips": [
            {"clip": "left", "at": [-1, 0]},
            {"clip": "up", "at": [0, 1]},
            {"clip": "right", "at": [1, 0]}
          ],
          "speed": "side"
        },
        "fall": {"clip": "fall", "loop": false, "speed": -2}
      },
      "transitions": [
        {"from": "zebra", "to": "move", "when": {"speed": {"above": 0.1, "below": 9}, "alert": true, "tired": false}},
        {"from": "*", "to": "aim", "when": {"jump": "triggered"}, "fade": "inertial", "fade_s": 0.2, "interrupts": )"
                                               R"(true},
        {"to": "fall", "exit": 2.5, "fade": "cross"},
        {"from": "fall", "to": "fall", "exit": 1},
        {"from": "aim", "to": "zebra"}
      ]
    },
    {"name": "arms", "mode": "additive", "mask": "upper", "weight": {"parameter": "tired", "times": 2}},
    {"name": "top", "mode": "override", "weight": 0.75, "mask": "left arm"}
  ]
}
)";

// The result of replacing `old` in the complete file: its first occurrence, which must exist.
struct BrokenController {
    std::string old, now;
    uint32_t line;       // named in the message
    std::string reason;  // in the message
    bool schema_tells = true;
};

inline const std::vector<BrokenController> kBrokenControllers{
    // Not JSON.
    {"  ]\n}\n", "  ]\n", 54, "not JSON: column", true},
    {"\"zebra\": {\"clip\": \"idle\"},", "\"zebra\": {\"clip\": \"idle\"}", 24, "expected '}'"},
    {"4}\n", "4},\n", 29, "unexpected ']'"},
    {"0.25", "1e999", 4, "number overflow"},
    {"0.25", "NaN", 4, "invalid literal"},
    {"idle", "id\xFFle", 23, "ill-formed UTF-8"},
    {"idle", "id\nle", 23, "must be escaped"},
    {"  },\n", "  }, // comment\n", 6, "not JSON", true},
    {"\"alert\"", "\"speed\"", 4, "duplicate key 'speed' in one object, first in line 4", false},
    {"\"move\": {", "\"zebra\": {", 24, "duplicate key 'zebra' in one object, first in line 23", false},
    {"0.25", std::string(40, '['), 4, "nested deeper than the limit of 32"},
    // Types and fields.
    {"{\n  \"$schema\"", "[{}, {\n  \"$schema\"", 55, "not JSON"},
    {"0.25", "null", 4, "parameters.speed: must be a number, true, false or \"trigger\""},
    {"\"trigger\"", "\"button\"", 5, "parameters.jump: must be a number, true, false or \"trigger\""},
    {"\"parameters\": {", "\"parametres\": {", 3,
     "parametres: there is no field 'parametres'; did you mean 'parameters'?"},
    {"\"name\": \"step\", ", "", 8, "events[0]: 'name' is missing"},
    {"\"at_s\": 0.3", "\"at\": 0.3", 8, "events[0].at: there is no field 'at'"},
    {"\"at_s\": 0.3", "\"at_s\": \"0.3\"", 8, "events[0].at_s: must be a number, but is a string"},
    {"\"ramp\": 3", "\"ramp\": 1.5", 13, "masks.upper[0].ramp: must be a whole number"},
    {"\"ramp\": 3", "\"ramp\": -1", 13, "masks.upper[0].ramp: must be a whole number"},
    {"[{\"joint\": \"arm.L\"}]", "{\"joint\": \"arm.L\"}", 16,
     "masks[\"left arm\"]: must be an array, but is an object"},
    {"\"layers\"", "\"events\"", 18, "duplicate key", false},
    {"\"name\": \"base\",", "", 19, "layers[0]: 'name' is missing"},
    {"\"mode\": \"additive\"", "\"mode\": \"add\"", 52,
     "layers[1].mode: must be \"override\" or \"additive\", but is 'add'"},
    {"\"clip\": \"idle\"", "", 23, "layers[0].states.zebra: must have a 'clip', or 'blend' and 'clips'"},
    {"\"clip\": \"idle\"", "\"clip\": \"idle\", \"blend\": \"speed\"", 23,
     "layers[0].states.zebra: must have one 'clip', or a 'blend' of 'clips', not both"},
    {"\"clip\": \"idle\"", "\"blend\": \"speed\"", 23, "layers[0].states.zebra: 'clips' is missing"},
    {"\"clip\": \"idle\"", "\"blend\": \"speed\", \"clips\": []", 23,
     "layers[0].states.zebra.clips: must not be empty"},
    {"\"clip\": \"idle\"", "\"clip\": 3", 23, "layers[0].states.zebra.clip: must be a string, but is a number"},
    {"\"clip\": \"idle\"", "\"clip\": \"\"", 23, "layers[0].states.zebra.clip: a name must not be empty"},
    {"\"clip\": \"idle\"", "\"clip\": null, \"speed\": 2", 23,
     "layers[0].states.zebra: plays nothing, so it must not have 'loop', 'speed' or 'sync'"},
    {"\"clip\": \"idle\"", "\"clip\": null, \"loop\": false", 23, "layers[0].states.zebra: plays nothing"},
    {"\"clip\": \"idle\"", "\"clip\": null, \"sync\": \"legs\"", 23, "layers[0].states.zebra: plays nothing"},
    {"\"clip\": \"fall\", \"loop\": false, \"speed\": -2", "\"clip\": null", 48,
     "layers[0].transitions[3].exit: is never reached: state 'fall' plays nothing", false},
    {"\"at\": 1.5", "\"at\": [1.5, 0]", 27, "layers[0].states.move.clips[0].at: must be a number, but is an array"},
    {"\"at\": [0, 1]", "\"at\": 1", 37, "layers[0].states.aim.clips[1].at: must be two numbers"},
    {"\"at\": [0, 1]", "\"at\": [0, 1, 2]", 37, "layers[0].states.aim.clips[1].at: must be two numbers"},
    {"[\"side\", \"speed\"]", "[\"side\"]", 34,
     "layers[0].states.aim.blend: must be the name of a parameter, or of two"},
    {"\"loop\": false", "\"loop\": 0", 42, "layers[0].states.fall.loop: must be true or false, but is a number"},
    {"\"speed\": \"side\"", "\"speed\": true", 40, "layers[0].states.aim.speed: must be a number, a parameter's name"},
    {"{\"parameter\": \"speed\", \"times\": 0.5}", "{\"times\": 0.5}", 30,
     "layers[0].states.move.speed: 'parameter' is missing"},
    {"\"sync\": \"legs\"", "\"sync\": \"\"", 31,
     "layers[0].states.move.sync: a name must not be empty; leave 'sync' out"},
    {"\"to\": \"move\", ", "", 45, "layers[0].transitions[0]: 'to' is missing"},
    {"{\"above\": 0.1, \"below\": 9}", "{}", 45, "layers[0].transitions[0].when.speed: 'above' or 'below' is missing"},
    {"{\"above\": 0.1, \"below\": 9}", "0.1", 45,
     "layers[0].transitions[0].when.speed: must be true, false, \"triggered\""},
    {"\"below\": 9", "\"belov\": 9", 45,
     "when.speed.belov: there is no field 'belov'; did you mean 'below'? There are: above, below"},
    {"\"fade\": \"inertial\"", "\"fade\": \"linear\"", 46,
     "layers[0].transitions[1].fade: must be \"cross\" or \"inertial\""},
    {"\"interrupts\": true", "\"interrupts\": \"yes\"", 46,
     "layers[0].transitions[1].interrupts: must be true or false, but is a string"},
    // Numbers.
    {"0.25", "1e39", 4, "parameters.speed: is too large for a 32-bit float"},
    {"\"at_s\": 0.3", "\"at_s\": -0.3", 8, "events[0].at_s: must be a time in the clip"},
    {"\"weight\": 0.5", "\"weight\": 1.5", 14, "masks.upper[1].weight: 1.5 is not between 0 and 1"},
    {"\"weight\": 0.75", "\"weight\": -1", 53, "layers[2].weight: -1 is not between 0 and 1"},
    {"\"at\": 4", "\"at\": 1.5", 28, "layers[0].states.move.clips[1].at: 1.5 is not above the 1.5 of the clip before",
     false},
    {"\"at\": 4", "\"at\": 1.50000001", 28, "layers[0].states.move.clips[1].at: 1.5 is not above", false},
    {"\"at\": 4", "\"at\": 2e6", 28, "layers[0].states.move.clips[1].at: 2000000 is not between -1000000 and 1000000"},
    {"\"at\": [1, 0]", "\"at\": [-1, 0]", 38, "layers[0].states.aim.clips[2].at: clips[0] is at the same place", false},
    {"\"exit\": 2.5", "\"exit\": -1", 47, "layers[0].transitions[2].exit: -1 is not between 0 and 1000000"},
    {"\"exit\": 1}", "\"exit\": 1.5}", 48,
     "layers[0].transitions[3].exit: is never reached: state 'fall' does not loop", false},
    {"\"fade_s\": 0.2", "\"fade_s\": -0.2", 46, "layers[0].transitions[1].fade_s: -0.2 is not between 0.0001 and 1000"},
    {"\"fade_s\": 0.2", "\"fade_s\": 1e-7", 46,
     "layers[0].transitions[1].fade_s: 0.0000001 is not between 0.0001 and 1000"},
    // Names.
    {"\"start\": \"move\"", "\"start\": \"mvoe\"", 21,
     "layers[0].start: there is no state 'mvoe'; did you mean 'move'? There are: zebra, move, aim, fall", false},
    {"\"from\": \"zebra\"", "\"from\": \"zebar\"", 45,
     "layers[0].transitions[0].from: there is no state 'zebar'; did you mean 'zebra'?", false},
    {"\"to\": \"aim\"", "\"to\": \"elsewhere\"", 46,
     "layers[0].transitions[1].to: there is no state 'elsewhere'. There are: move, zebra, aim, fall", false},
    {"\"when\": {\"speed\"", "\"when\": {\"sped\"", 45,
     "layers[0].transitions[0].when.sped: there is no parameter 'sped'; did you mean 'speed'?", false},
    {"\"mask\": \"upper\"", "\"mask\": \"uper\"", 52, "layers[1].mask: there is no mask 'uper'; did you mean 'upper'?",
     false},
    {"\"blend\": \"speed\"", "\"blend\": \"Speedy\"", 25,
     "layers[0].states.move.blend: there is no parameter 'Speedy'; did you mean 'speed'?", false},
    {"[\"side\", \"speed\"]", "[\"side\",\n\"spede\"]", 35,
     "layers[0].states.aim.blend[1]: there is no parameter 'spede'", false},
    {"\"name\": \"top\"", "\"name\": \"arms\"", 53, "layers[2].name: the name 'arms' is taken", false},
    {"\"speed\": 0.25", "\"\": 0.25", 4, "parameters[\"\"]: a name must not be empty"},
    {"\"name\": \"top\"", "\"name\": \"t\\nop\"", 53, "layers[2].name: a name must not have line breaks", false},
    {"\"zebra\": {", "\"*\": {", 23, "layers[0].states[\"*\"]: '*' means any state"},
    {"idle", std::string(300, 'x'), 23, "longer than the limit of 256 bytes"},
    // Meaning.
    {"\"speed\": \"side\"", "\"speed\": \"jump\"", 40,
     "layers[0].states.aim.speed.parameter: 'jump' is a trigger, not a number", false},
    {"\"blend\": \"speed\"", "\"blend\": \"jump\"", 25, "layers[0].states.move.blend: 'jump' is a trigger", false},
    {"\"parameter\": \"tired\"", "\"parameter\": \"jump\"", 52, "layers[1].weight.parameter: 'jump' is a trigger",
     false},
    {"\"alert\": true, \"tired\": false}}", "\"alert\": {\"above\": 0}}}", 45,
     "layers[0].transitions[0].when.alert: 'alert' is a bool; ask for true or false", false},
    {"\"alert\": true, \"tired\": false}}", "\"side\": true}}", 45,
     "layers[0].transitions[0].when.side: 'side' is a float; compare it", false},
    {"\"jump\": \"triggered\"", "\"jump\": true", 46,
     "layers[0].transitions[1].when.jump: 'jump' is a trigger; ask for \"triggered\"", false},
    {"\"below\": 9", "\"below\": 0.1", 45, "layers[0].transitions[0].when.speed: nothing is above 0.1 and below 0.1",
     false},
    {"\"exit\": 2.5, ", "", 47, "layers[0].transitions[2]: leaves any state at once, so that the layer never rests"},
    {"\"to\": \"fall\", \"exit\": 1}", "\"to\": \"fall\"}", 48,
     "layers[0].transitions[3]: begins its state again in every update", false},
    {"\"name\": \"top\",", "\"name\": \"top\", \"transitions\": [{\"from\": \"a\", \"to\": \"b\"}],", 53,
     "layers[2].transitions: the layer has no states to go between"},
    {"\"name\": \"top\",", "\"name\": \"top\", \"states\": {},", 53, "layers[2].states: must not be empty"},
    {"\"mode\": \"additive\",", "\"mode\": \"additive\", \"rotations\": \"model\",", 52,
     "layers[1].rotations: an additive layer turns joints relative to their parents"},
    {"\"name\": \"top\",", "\"name\": \"top\", \"start\": \"a\",", 53,
     "layers[2].start: there is no state 'a', nor any other"},
};

inline std::string broken(const BrokenController& how) {
    std::string text = kCompleteController;
    const size_t at = text.find(how.old);
    return at == text.npos ? "" : text.replace(at, how.old.size(), how.now);
}

}  // namespace throng::test
