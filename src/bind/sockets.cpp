#include "bind/sockets.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "bind/sockets.comp.inc"
};
constexpr uint32_t kWide[] = {
#include "bind/sockets.wide.inc"
};

}  // namespace

Kernel socket_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu,
                  {.name = "sockets", .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWide) : kPlain});
}

}  // namespace throng
