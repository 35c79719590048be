// attach: places each instance that is attached to another one's socket; defined by attach_reference.h. Then moves the
//   instance's own sockets, which updates leave in model space, to world space, for instances attached to them. One
//   invocation per instance, one dispatch for each carrier batch and level. Instances that are not attached have level
//   0, those attached to level 0 have level 1, and so on.
//   Cost: 64 bytes of an attachment and 48 of a socket read, 48 of a placement written, 96 moved for each own socket.
#include "attach/attach_io.h"
#include "gpu/affine.glsl"
#include "gpu/buffers_io.h"
#include "control/births.glsl"

WORKGROUP(kAttachWorkgroupSize);
READONLY_BUFFER(kAttachmentsBuffer, InstanceAttachment, attachments);
READONLY_BUFFER(kCarrierSocketsBuffer, Affine, carrier_sockets);  // [instance][socket], world_from_joint
BUFFER(kPlacementsBuffer, Affine, placements);
BUFFER(kSocketsBuffer, Affine, sockets);  // [instance][socket]: model_from_joint, then world_from_joint
PUSH(AttachPush);

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || !is_there(instance, push.birth)) return;
    if (attachments[instance].carrier_batch != push.carrier_batch || attachments[instance].level != push.level) return;
    Affine world_from_model;
    if (push.level == 0) {
        world_from_model = placements[instance];
    } else {
        const InstanceAttachment hangs = attachments[instance];
        const Affine socket_from_model = {hangs.socket_from_model[0], hangs.socket_from_model[1],
                                          hangs.socket_from_model[2]};
        world_from_model = affine_multiply(carrier_sockets[hangs.carrier * push.carrier_socket_count + hangs.socket],
                                           socket_from_model);
        placements[instance] = world_from_model;
    }
    for (uint socket = instance * push.socket_count; socket < (instance + 1) * push.socket_count; ++socket)
        sockets[socket] = affine_multiply(world_from_model, sockets[socket]);
}
