// Transforms of chosen joints, for attachments.
#pragma once

#include "bind/sockets_io.h"
#include "gpu/kernel.h"

namespace throng {

// Dispatched with io::SocketPush, an invocation per instance and socket.
Kernel socket_kernel(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
