#version 460
// controller: one update of each instance's layers: transitions, fades, times, events, root motion; writes the clips
// that its pose is made of. One invocation per instance. Defined in docs/controller.md; nothing that decides a state is
// divided or fused, so that all devices agree. Loops test when a round is over: a software device goes round one that
// tests before it once more than any invocation needs.
#include "gpu/buffers_io.h"
#include "gpu/stored.glsl"
#include "gpu/table.glsl"
#include "control/controller_io.h"

layout(local_size_x = kControllerWorkgroupSize) in;
TABLE_OF_WORDS(kControllerBuffer, Tables, tables);
TABLE_OF_WORDS(kTimelineBuffer, Timelines, timelines);
TABLE_OF_WORDS(kTimesBuffer, Times, times);
TABLE_OF_ROWS(kRootRowsBuffer, RootRows, root_rows);
layout(set = 0, binding = kLayersBuffer, std430) buffer Layers { LayerState layers[]; };  // [instance][layer]
layout(set = 0, binding = kParametersBuffer, std430) buffer Parameters {
    float parameters[];
};  // [instance][parameter]
// [instance][active_clip_limit], four pairs of words each
layout(set = 0, binding = kActiveClipsBuffer, std430) writeonly buffer ActiveClips { StoredPair active_clips[]; };
layout(set = 0, binding = kEventsBuffer, std430) buffer Events {
    EventHead event_head;
    EventRecord events[];
};
layout(set = 0, binding = kRootsBuffer, std430) buffer Roots { RootState roots[]; };
// world_from_model, three rows each
layout(set = 0, binding = kPlacementsBuffer, std430) writeonly buffer Placements { vec4 placements[]; };
// The same as layers and parameters: to read them, which a software device does
TABLE_OF_WORDS(kLayersBeforeBuffer, LayersBefore, layers_before);
TABLE_OF_WORDS(kParametersBeforeBuffer, ParametersBefore, parameters_before);  // faster as tables
layout(set = 0, binding = kInertiasBuffer, std430) buffer Inertias { InstanceInertia inertias[]; };
layout(set = 0, binding = kActiveClipTimesBuffer, std430) writeonly buffer ActiveClipTimes {
    float active_clip_times[];
};  // [instance][active_clip_limit]
layout(push_constant) uniform Push { ControllerPush push; };

uint instance, first_parameter;

// What is not finite counts as 0.
float parameter_at(uint index) {
    const float value = FLOAT_AT(parameters_before, first_parameter + index);
    return (floatBitsToUint(value) & 0x7F800000u) == 0x7F800000u ? 0 : value;
}

LayerState load_layer_state(uint index) { return LAYER_STATE_AT(layers_before, kLayerStateWords * index); }

#include "control/control.glsl"
#include "control/rounded.glsl"
#include "control/tables.glsl"
#include "control/plays.glsl"
#include "control/root_motion.glsl"
#include "control/active_clips.glsl"
#include "control/events.glsl"
#include "control/layer.glsl"
#include "control/inertia_clock.glsl"

void main() {
    instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count) return;
    layout_of_group = load_layout();
    first_parameter = instance * layout_of_group.parameter_count;
    uint index = 0;
    do update_layer(index);
    while (++index < layout_of_group.layer_count);
    reset_triggers();
    end_active_clips();
    end_move();
    end_inertia();
}
