#version 460
// commands: what the CPU asks of instances since the last update. Commands lie sorted by instance; the invocation of an
// instance's first one applies them all, in their order.
#include "gpu/buffers_io.h"
#include "control/controller_io.h"

layout(local_size_x = kControllerWorkgroupSize) in;
layout(set = 0, binding = kCommandsBuffer, std430) readonly buffer Commands { ControlCommand commands[]; };
layout(set = 0, binding = kLayersBuffer, std430) buffer Layers { LayerState layers[]; };  // [instance][layer]
layout(set = 0, binding = kParametersBuffer, std430) buffer Parameters {
    float parameters[];
};  // [instance][parameter]
layout(push_constant) uniform Push { CommandPush push; };

#include "control/rounded.glsl"
#include "control/stack.glsl"

void play(uint at, ControlCommand command) {
    LayerState state = layers[at];
    const bool at_once = command.fade_rate == 0 || command.kind == kCommandPlayInertial;
    push_play(state, LayerPlay(command.motion, command.phase, 0, at_once ? 1 : 0, command.fade_rate, command.value,
                               command.loop));
    if (command.kind == kCommandPlayInertial) state.inertial_rate = command.fade_rate;
    layers[at] = state;
}

void set_layer(uint at, ControlCommand command) {
    layers[at].weight_goal = command.value;
    layers[at].weight_rate = product(abs(difference(command.value, layers[at].weight)), command.fade_rate);
    if (command.fade_rate == 0) layers[at].weight = command.value;
    layers[at].mode = command.phase;
    layers[at].mask = command.motion;
}

void main() {
    const uint first = gl_GlobalInvocationID.x;
    if (first >= push.command_count) return;
    const uint instance = commands[first].instance;
    if (first > 0 && commands[first - 1].instance == instance) return;
    for (uint i = first; i < push.command_count && commands[i].instance == instance; ++i) {
        const ControlCommand command = commands[i];
        const uint at = instance * push.layer_count + command.target;
        if (command.kind == kCommandPlay || command.kind == kCommandPlayInertial)
            play(at, command);
        else if (command.kind == kCommandLayer)
            set_layer(at, command);
        else
            parameters[instance * push.parameter_count + command.target] = command.value;
    }
}
