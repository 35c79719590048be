// Parameters of the sockets kernel. Shared by C++ and GLSL.
#ifndef THRONG_SOCKETS_IO_H
#define THRONG_SOCKETS_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSocketWorkgroupSize = 64;

struct SocketPush {
    uint instance_count;
    uint joint_count;
    uint socket_count;
    uint flags;
    uint birth;  // control/births.glsl
};
THRONG_IO_CONSTANT kSocketsGather = 1;   // copy from the model matrices; otherwise `sockets` holds them already
THRONG_IO_CONSTANT kSocketsToWorld = 2;  // store world_from_joint, not model_from_joint

THRONG_IO_END
#endif
