// The tables of a group (control/controller_io.h). The includer declares the table `tables`, of words.
#include "control/controller_io.h"

uint table_word(uint index) { return WORD_AT(tables, index); }
float table_float(uint index) { return uintBitsToFloat(WORD_AT(tables, index)); }

ControllerLayout load_layout() {
    return ControllerLayout(table_word(0), table_word(1), table_word(2), table_word(3), table_word(4), table_word(5),
                            table_word(6), table_word(7), table_word(8), table_word(9), table_word(10), table_word(11));
}

ControllerLayout layout_of_group;

ControlClip load_clip(uint i) {
    const uint w = layout_of_group.clips + 5 * i;
    return ControlClip(table_float(w), table_word(w + 1), table_word(w + 2), table_word(w + 3), table_word(w + 4));
}

ControlLayer load_layer(uint i) {
    const uint w = layout_of_group.layers + 7 * i;
    return ControlLayer(table_word(w), table_word(w + 1), table_word(w + 2), table_word(w + 3), table_float(w + 4),
                        table_word(w + 5), table_word(w + 6));
}

ControlState load_state(uint i) {
    const uint w = layout_of_group.states + 14 * i;
    return ControlState(table_word(w), table_word(w + 1), table_word(w + 2), table_word(w + 3), table_word(w + 4),
                        table_word(w + 5), table_word(w + 6), table_word(w + 7), table_word(w + 8), table_float(w + 9),
                        table_word(w + 10), table_word(w + 11), table_word(w + 12), table_word(w + 13));
}

ControlPoint load_point(uint i) {
    const uint w = layout_of_group.points + 4 * i;
    return ControlPoint(table_word(w), table_float(w + 1), table_float(w + 2), table_float(w + 3));
}

ControlTriangle load_triangle(uint i) {
    const uint w = layout_of_group.triangles + 9 * i;
    return ControlTriangle(table_word(w), table_word(w + 1), table_word(w + 2), table_float(w + 3), table_float(w + 4),
                           table_float(w + 5), table_float(w + 6), table_float(w + 7), table_float(w + 8));
}

ControlEdge load_edge(uint i) {
    const uint w = layout_of_group.edges + 4 * i;
    return ControlEdge(table_word(w), table_word(w + 1), table_float(w + 2), table_float(w + 3));
}

ControlTransition load_transition(uint i) {
    const uint w = layout_of_group.transitions + 7 * i;
    return ControlTransition(table_word(w), table_word(w + 1), table_word(w + 2), table_word(w + 3), table_word(w + 4),
                             table_float(w + 5), table_word(w + 6));
}

ControlCondition load_condition(uint i) {
    const uint w = layout_of_group.conditions + 3 * i;
    return ControlCondition(table_word(w), table_word(w + 1), table_float(w + 2));
}

ControlEvent load_event(uint i) {
    const uint w = layout_of_group.events + 2 * i;
    return ControlEvent(table_word(w), table_word(w + 1));
}
