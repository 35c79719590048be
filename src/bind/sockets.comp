#version 460
// sockets: transforms of the joints that things are attached to, of every instance, for other passes and the CPU.
// One invocation per instance and socket. Fused updates have written model_from_joint already; of staged ones it is
// gathered here.
#include "gpu/buffers_io.h"
#include "bind/sockets_io.h"
#include "gpu/affine.glsl"
#include "gpu/table.glsl"

layout(local_size_x = kSocketWorkgroupSize) in;
layout(set = 0, binding = kModelBuffer, std430) readonly buffer Model { Affine model[]; };  // [instance][joint]
TABLE_OF_WORDS(kSocketJointsBuffer, Joints, joints);                                        // [socket]
layout(set = 0, binding = kPlacementsBuffer, std430) readonly buffer Placements { Affine placements[]; };  // [instance]
layout(set = 0, binding = kSocketsBuffer, std430) buffer Sockets { Affine sockets[]; };  // [instance][socket]
layout(push_constant) uniform Push { SocketPush push; };

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.instance_count * push.socket_count) return;
    const uint instance = i / push.socket_count;
    Affine transform;
    if ((push.flags & kSocketsGather) != 0)
        transform = model[instance * push.joint_count + WORD_AT(joints, i % push.socket_count)];
    else
        transform = sockets[i];
    if ((push.flags & kSocketsToWorld) != 0) transform = affine_multiply(placements[instance], transform);
    sockets[i] = transform;
}
