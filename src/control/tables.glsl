// The tables of a group (control/controller_io.h). The includer declares the table `tables`, of words.
#include "control/controller_io.h"

ControllerLayout load_layout() { return CONTROLLER_LAYOUT_AT(tables, 0); }

ControllerLayout layout_of_group;

ControlClip load_clip(uint i) { return CONTROL_CLIP_AT(tables, layout_of_group.clips + kControlClipWords * i); }
ControlLayer load_layer(uint i) { return CONTROL_LAYER_AT(tables, layout_of_group.layers + kControlLayerWords * i); }
ControlState load_state(uint i) { return CONTROL_STATE_AT(tables, layout_of_group.states + kControlStateWords * i); }
ControlPoint load_point(uint i) { return CONTROL_POINT_AT(tables, layout_of_group.points + kControlPointWords * i); }
ControlTriangle load_triangle(uint i) {
    return CONTROL_TRIANGLE_AT(tables, layout_of_group.triangles + kControlTriangleWords * i);
}
ControlEdge load_edge(uint i) { return CONTROL_EDGE_AT(tables, layout_of_group.edges + kControlEdgeWords * i); }
ControlTransition load_transition(uint i) {
    return CONTROL_TRANSITION_AT(tables, layout_of_group.transitions + kControlTransitionWords * i);
}
ControlCondition load_condition(uint i) {
    return CONTROL_CONDITION_AT(tables, layout_of_group.conditions + kControlConditionWords * i);
}
ControlEvent load_event(uint i) { return CONTROL_EVENT_AT(tables, layout_of_group.events + kControlEventWords * i); }
