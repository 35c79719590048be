#include "bind/sockets.h"

#include "shaders.h"

namespace throng {

Kernel socket_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu, {.name = "sockets", .spirv = shaders::sockets.words(*gpu)});
}

}  // namespace throng
