// controller: one update of each instance's layers: transitions, fades, times, events, root motion. Writes the clips
// that its pose is made of. One invocation per instance. Defined in docs/controller.md. Whatever decides a state is
// computed without divisions and without fused multiply-adds, so that all devices agree. Loops test at the end of a
// round: a software device runs a loop that tests first one round longer than any invocation needs.
#include "gpu/buffers_io.h"
#include "gpu/stored.glsl"
#include "control/births.glsl"
#include "control/controller_io.h"

WORKGROUP(kControllerWorkgroupSize);
TABLE_OF_WORDS(kControllerBuffer, tables);
TABLE_OF_WORDS(kTimelineBuffer, timelines);
TABLE_OF_WORDS(kTimesBuffer, times);
TABLE_OF_ROWS(kRootRowsBuffer, root_rows);
BUFFER(kLayersBuffer, LayerState, layers);     // [instance][layer]
BUFFER(kParametersBuffer, float, parameters);  // [instance][parameter]
// [instance][active_clip_limit], four pairs of words each
WRITEONLY_BUFFER(kActiveClipsBuffer, StoredPair, active_clips);
BUFFER_WITH_HEAD(kEventsBuffer, EventHead, event_head, EventRecord, events);
BUFFER(kRootsBuffer, RootState, roots);
BUFFER(kRootRemaindersBuffer, vec2, root_remainders);
// world_from_model, three rows each
WRITEONLY_BUFFER(kPlacementsBuffer, vec4, placements);
// A software device reads layers and parameters as tables, which are faster there. Other devices must not bind them
// twice: compilers assume that two buffer variables do not alias (SPIR-V 2.18.2, "Aliasing").
#ifdef GPU_SOFTWARE
TABLE_OF_WORDS(kLayersBeforeBuffer, layers_before);
TABLE_OF_WORDS(kParametersBeforeBuffer, parameters_before);
#define PARAMETER_AT(index) FLOAT_AT(parameters_before, index)
#define LAYER_AT(index) LAYER_STATE_AT(layers_before, kLayerStateWords*(index))
#else
#define PARAMETER_AT(index) parameters[index]
#define LAYER_AT(index) layers[index]
#endif
BUFFER(kInertiasBuffer, InstanceInertia, inertias);
WRITEONLY_BUFFER(kActiveClipTimesBuffer, float, active_clip_times);  // [instance][active_clip_limit]
PUSH(ControllerPush);

uint instance, first_parameter;

// Parameters that are not finite count as 0, and so do denormal ones (closer to 0 than 1.2e-38), which some devices
// flush to 0.
float parameter_at(uint index) {
    const float value = PARAMETER_AT(first_parameter + index);
    const uint exponent = floatBitsToUint(value) & 0x7F800000u;
    return exponent == 0x7F800000u || exponent == 0 ? 0 : value;
}

LayerState load_layer_state(uint index) { return LAYER_AT(index); }

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
    if (instance >= push.instance_count || !is_there(instance, push.birth)) return;
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
