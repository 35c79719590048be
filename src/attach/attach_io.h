// What the attach stage reads. Shared by C++ and GLSL.
#ifndef THRONG_ATTACH_IO_H
#define THRONG_ATTACH_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kAttachWorkgroupSize = 64;

// What an instance is attached to.
struct InstanceAttachment {
    uint carrier_batch;         // kNone: not attached
    uint carrier;               // instance of that batch
    uint socket;                // index in the carrier's group
    uint level;                 // 1 + the carrier's level; 0: not attached
    vec4 socket_from_model[3];  // rows
};

// One dispatch: places the instances of `level` that are attached to instances of `carrier_batch`.
struct AttachPush {
    uint instance_count;
    uint level;
    uint carrier_batch;         // the batch whose sockets are bound; kNone at level 0
    uint carrier_socket_count;  // per instance of that batch
    uint socket_count;          // per placed instance
    uint birth;                 // control/births.glsl
};

THRONG_IO_END
#endif
