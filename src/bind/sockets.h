// Transforms of chosen joints, for attachments.
#pragma once

#include "bind/sockets_io.h"
#include "gpu/kernel.h"

namespace throng {

// In the order of the bindings; dispatched with io::SocketPush, an invocation per instance and socket.
struct SocketBuffers {
    // Affine[instance_count][joint_count], model_from_joint; where nothing is gathered, any buffer
    BufferRange model;
    BufferRange joints;      // uint[socket_count], a table (gpu/table.glsl)
    BufferRange placements;  // Affine[instance_count], world_from_model
    BufferRange sockets;     // Affine[instance_count][socket_count], written
};

Kernel socket_kernel(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
