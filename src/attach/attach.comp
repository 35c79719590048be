// attach: instances that hang on a socket of another are put there; defined by attach_reference.h. One invocation per
//   instance, for each batch that carries any. Cost: 64 bytes of an attachment and 48 of a socket read, 48 of a
//   placement written.
#include "attach/attach_io.h"
#include "gpu/affine.glsl"
#include "gpu/buffers_io.h"

WORKGROUP(kAttachWorkgroupSize);
READONLY_BUFFER(kAttachmentsBuffer, InstanceAttachment, attachments);
READONLY_BUFFER(kSocketsBuffer, Affine, sockets);  // of the carriers, [instance][socket], world_from_joint
BUFFER(kPlacementsBuffer, Affine, placements);
PUSH(AttachPush);

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || attachments[instance].carrier_batch != push.carrier_batch) return;
    const InstanceAttachment hangs = attachments[instance];
    const Affine socket_from_model = {hangs.socket_from_model[0], hangs.socket_from_model[1],
                                      hangs.socket_from_model[2]};
    placements[instance] = affine_multiply(sockets[hangs.carrier * push.socket_count + hangs.socket],
                                           socket_from_model);
}
