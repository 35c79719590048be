// A Controller for a Character as arrays of the structs of controller_io.h: names become indices, times become phases,
// divisions are done once.
#pragma once

#include "control/controller_io.h"

#include <throng/controller.h>

#include <vector>

namespace throng {

struct ControllerArrays {
    std::vector<io::ControlClip> clips;  // [clip_count + 1], the last the rest pose
    std::vector<io::ControlLayer> layers;
    std::vector<io::ControlState> states;
    std::vector<io::ControlPoint> points;
    std::vector<io::ControlTriangle> triangles;
    std::vector<io::ControlEdge> edges;
    std::vector<io::ControlTransition> transitions;
    std::vector<io::ControlCondition> conditions;
    std::vector<io::ControlEvent> events;
};

// For a controller that check_controller() accepts.
ControllerArrays make_controller_arrays(const Controller& controller, const Character& character);

// A time in a clip as a phase: wrapped around if looping, else clamped to the clip. 0 if the clip has no duration.
uint32_t phase_at(double time_s, double duration_s, bool loop);

}  // namespace throng
