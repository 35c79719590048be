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

// One dispatch: places the instances of this level that hang on instances of this batch.
struct AttachPush {
    uint instance_count;
    uint level;
    uint carrier_batch;         // whose sockets are bound; kNone at level 0
    uint carrier_socket_count;  // per instance of that batch
    uint socket_count;          // per placed instance
    uint birth;                 // control/births.glsl
};

THRONG_IO_END
#endif
