// What the attach stage reads. Shared by C++ and GLSL.
#ifndef THRONG_ATTACH_IO_H
#define THRONG_ATTACH_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kAttachWorkgroupSize = 64;

// Where an instance hangs.
struct InstanceAttachment {
    uint carrier_batch;         // or kNone: it hangs on nobody
    uint carrier;               // of that batch
    uint socket;                // of the carrier's group
    uint level;                 // 1 + its carrier's; 0: it hangs on nobody
    vec4 socket_from_model[3];  // rows
};

// What one dispatch places: instances of this level that hang in this batch.
struct AttachPush {
    uint instance_count;
    uint level;
    uint carrier_batch;         // whose sockets are bound; of level 0, kNone
    uint carrier_socket_count;  // of an instance there
    uint socket_count;          // of an instance that is placed
    uint birth;                 // control/births.glsl
};

THRONG_IO_END
#endif
