// sockets: the transforms of every instance's attachment joints, for other passes and the CPU. One invocation per
// instance and socket. In fused updates model_from_joint is already written; in staged ones it is copied here.
#include "gpu/buffers_io.h"
#include "bind/sockets_io.h"
#include "control/births.glsl"
#include "gpu/affine.glsl"

WORKGROUP(kSocketWorkgroupSize);
READONLY_BUFFER(kModelBuffer, Affine, model);            // [instance][joint]
TABLE_OF_WORDS(kSocketJointsBuffer, joints);             // [socket]
READONLY_BUFFER(kPlacementsBuffer, Affine, placements);  // [instance]
BUFFER(kSocketsBuffer, Affine, sockets);                 // [instance][socket]
PUSH(SocketPush);

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.instance_count * push.socket_count) return;
    const uint instance = i / push.socket_count;
    if (!is_there(instance, push.birth)) return;
    Affine transform;
    if ((push.flags & kSocketsGather) != 0)
        transform = model[instance * push.joint_count + WORD_AT(joints, i % push.socket_count)];
    else
        transform = sockets[i];
    if ((push.flags & kSocketsToWorld) != 0) transform = affine_multiply(placements[instance], transform);
    sockets[i] = transform;
}
