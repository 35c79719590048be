// A group's tables on the CPU, with the functions that the controller's .glsl files call to read them.
#pragma once

#include "controller/controller_arrays.h"
#include "gpu/glsl.h"

namespace throng::io {

struct ArrayTables {
    const ControllerArrays& arrays;

    const ControlClip& load_clip(uint i) const { return arrays.clips[i]; }
    const ControlLayer& load_layer(uint i) const { return arrays.layers[i]; }
    const ControlState& load_state(uint i) const { return arrays.states[i]; }
    const ControlPoint& load_point(uint i) const { return arrays.points[i]; }
    const ControlTriangle& load_triangle(uint i) const { return arrays.triangles[i]; }
    const ControlEdge& load_edge(uint i) const { return arrays.edges[i]; }
    const ControlTransition& load_transition(uint i) const { return arrays.transitions[i]; }
    const ControlCondition& load_condition(uint i) const { return arrays.conditions[i]; }
};

}  // namespace throng::io
