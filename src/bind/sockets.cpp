#include "bind/sockets.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "bind/sockets.comp.inc"
};
constexpr uint32_t kSoftware[] = {
#include "bind/sockets.software.inc"
};

}  // namespace

Kernel socket_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu, {.name = "sockets",
                        .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftware) : kPlain});
}

}  // namespace throng
