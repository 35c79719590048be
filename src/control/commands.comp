// commands: applies what the CPU has asked of instances since the last update. Commands are sorted by instance. The
// invocation of an instance's first command applies all commands of that instance, in their order.
#include "gpu/buffers_io.h"
#include "control/controller_io.h"

WORKGROUP(kControllerWorkgroupSize);
READONLY_BUFFER(kCommandsBuffer, ControlCommand, commands);
BUFFER(kLayersBuffer, LayerState, layers);     // [instance][layer]
BUFFER(kParametersBuffer, float, parameters);  // [instance][parameter]
BUFFER(kInertiasBuffer, InstanceInertia, inertias);
// What kCommandBegin sets; bound only where instances come and go
READONLY_BUFFER(kInitialLayersBuffer, LayerState, initial_layers);
READONLY_BUFFER(kInitialParametersBuffer, float, initial_parameters);
PUSH(CommandPush);

#include "control/rounded.glsl"
#include "control/stack.glsl"
#include "control/commands.glsl"
#include "control/begin.glsl"

void main() {
    const uint first = gl_GlobalInvocationID.x;
    if (first >= push.command_count) return;
    const uint instance = commands[first].instance;
    if (first > 0 && commands[first - 1].instance == instance) return;
    for (uint i = first; i < push.command_count && commands[i].instance == instance; ++i) {
        const ControlCommand command = commands[i];
        if (command.kind == kCommandBegin)
            begin_controller(instance, push.layer_count, push.parameter_count, push.is_inertial != 0);
        else
            obey(command, instance * push.layer_count + command.target,
                 instance * push.parameter_count + command.target);
    }
}
