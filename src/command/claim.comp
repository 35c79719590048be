// claim: validates the commands that an application's shaders wrote, and finds the last one where several set the same
//   property of an instance. Invalid commands become kNothing, so that later kernels can trust the rest. One invocation
//   per command that fits the buffer. Cost: 64 bytes read and one atomic a command.
#include "command/command_io.h"
#include "gpu/buffers_io.h"
#include "gpu/table.glsl"

WORKGROUP(kCommandWorkgroupSize);
BUFFER_WITH_HEAD(kInstanceCommandsBuffer, CommandHead, head, InstanceCommand, commands);
BUFFER(kClaimsBuffer, uint, claims);  // [instance][claims_of_instance()]
TABLE_OF_WORDS(kControllerBuffer, tables);
PUSH(InstanceCommandPush);

#include "command/claims.glsl"
#include "control/tables.glsl"

bool is_finite(uint bits) { return (bits & 0x7F800000u) != 0x7F800000u; }
bool is_within(uint bits, float least, float most) {
    const float number = uintBitsToFloat(bits);
    return is_finite(bits) && number >= least && number <= most;
}
bool is_finite_row(uvec4 row) { return is_finite(row.x) && is_finite(row.y) && is_finite(row.z) && is_finite(row.w); }

// Clip, loop, time, speed.
bool is_clip(uvec4 played) {
    return (played.x == kNone || played.x < push.clip_count) && is_finite(played.z) && is_finite(played.w);
}

bool is_layer_without_states(uint layer) {
    if ((push.flags & kHasController) == 0 || layer >= push.layer_count) return false;
    layout_of_group = load_layout();
    return load_layer(layer).state_count == 0;
}

bool is_fade(uint bits) { return is_within(bits, 0, 3.4e38); }

bool can_be_obeyed(InstanceCommand command) {
    const uvec4 data = command.data[0];
    if (command.instance >= push.instance_count) return false;
    if (command.kind == kDespawn) return (push.flags & kShadersPopulate) != 0;
    if (command.kind == kSpawn || command.kind == kPlace)
        return (command.kind == kPlace || (push.flags & kShadersPopulate) != 0) && is_finite_row(data) &&
               is_finite_row(command.data[1]) && is_finite_row(command.data[2]);
    if (command.kind == kPlayback)
        return (push.flags & kHasController) == 0 && is_clip(data) && is_clip(command.data[1]) &&
               is_within(command.data[2].x, 0, 1);
    if (command.kind == kPlay)
        return is_layer_without_states(command.target) && is_clip(data) && is_fade(command.data[1].x) &&
               (command.data[1].y == 0 || (push.flags & kMayBeInertial) != 0);
    if (command.kind == kBlendLayer)
        return is_layer_without_states(command.target) && is_within(data.x, 0, 1) && data.y <= kModeAdditive &&
               (data.z == kNone || data.z < push.mask_count) && is_fade(data.w);
    if (command.kind == kSetParameter)
        return (push.flags & kHasController) != 0 && command.target < push.parameter_count && is_finite(data.x);
    const float kMaxTint = 1000;
    return command.kind == kSetLook && is_within(data.x, 0, kMaxTint) && is_within(data.y, 0, kMaxTint) &&
           is_within(data.z, 0, kMaxTint) && data.w < push.outfit_count;
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i == 0) head.lost = head.count - command_count();
    if (i >= command_count()) return;
    const InstanceCommand command = commands[i];
    if (command.kind == kNothing) return;
    if (can_be_obeyed(command)) {
        atomicMax(claims[claim_of(command)], i + 1);
    } else {
        commands[i].kind = kNothing;
        atomicAdd(head.ignored, 1);
    }
}
