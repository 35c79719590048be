#include "bind/sockets.h"

#include "bind/sockets.kernel.h"

namespace throng {

Kernel socket_kernel(const std::shared_ptr<Gpu>& gpu) { return kernels::sockets.on(gpu); }

}  // namespace throng
