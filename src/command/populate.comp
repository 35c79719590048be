// populate: resets the instances that an application's shaders spawn, and removes those that they despawn. One
//   invocation per command that fits the buffer. Cost: 64 bytes read and one atomic a command; for a spawned instance
//   the initial state is written, some 100 bytes and the layers of its controller.
#include "command/command_io.h"
#include "gpu/affine.glsl"
#include "gpu/buffers_io.h"

WORKGROUP(kCommandWorkgroupSize);
BUFFER_WITH_HEAD(kInstanceCommandsBuffer, CommandHead, head, InstanceCommand, commands);
BUFFER(kClaimsBuffer, uint, claims);
BUFFER(kBirthsBuffer, uint, births);
BUFFER(kPlacementsBuffer, Affine, placements);
BUFFER(kRootsBuffer, RootState, roots);
BUFFER(kRootRemaindersBuffer, vec2, root_remainders);
BUFFER(kInstanceLooksBuffer, InstanceLook, looks);
BUFFER(kPlaybacksBuffer, InstancePlayback, playbacks);
BUFFER(kLayersBuffer, LayerState, layers);
BUFFER(kParametersBuffer, float, parameters);
BUFFER(kInertiasBuffer, InstanceInertia, inertias);
READONLY_BUFFER(kInitialLayersBuffer, LayerState, initial_layers);
READONLY_BUFFER(kInitialParametersBuffer, float, initial_parameters);
BUFFER(kTargetsBuffer, vec4, targets);
BUFFER(kDestinationsBuffer, vec4, destinations);
PUSH(InstanceCommandPush);

#include "command/claims.glsl"
#include "command/place.glsl"
#include "control/begin.glsl"

void begin(InstanceCommand command) {
    const uint instance = command.instance;
    births[instance] = push.birth;
    place(command);
    if (push.outfit_count > 0) looks[instance] = InstanceLook(1, 1, 1, 0);
    if ((push.flags & kHasDestinations) != 0) destinations[instance] = vec4(0);
    for (uint i = 0; i < push.target_count; ++i) targets[instance * push.target_count + i] = vec4(0);
    if ((push.flags & kHasController) != 0) {
        begin_controller(instance, push.layer_count, push.parameter_count, (push.flags & kMayBeInertial) != 0);
    } else {
        const ClipPlay rest = {push.clip_count, 0, 0, 0};
        playbacks[instance] = InstancePlayback(rest, rest, 1);
    }
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= command_count()) return;
    const InstanceCommand command = commands[i];
    if ((command.kind != kSpawn && command.kind != kDespawn) || !takes_claim(i, command)) return;
    if (command.kind == kSpawn)
        begin(command);
    else
        births[command.instance] = 0;
}
