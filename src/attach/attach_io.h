// What the attach stage reads. Shared by C++ and GLSL.
#ifndef THRONG_ATTACH_IO_H
#define THRONG_ATTACH_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kAttachWorkgroupSize = 64;

// Where an instance hangs.
struct InstanceAttachment {
    uint carrier_batch;  // or kNone: it hangs on nobody
    uint carrier;        // of that batch
    uint socket;         // of the carrier's group
    uint unused;
    vec4 socket_from_model[3];  // rows
};

struct AttachPush {
    uint instance_count;
    uint carrier_batch;  // whose sockets are bound
    uint socket_count;   // of an instance
};

THRONG_IO_END
#endif
