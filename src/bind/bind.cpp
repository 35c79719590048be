#include "bind/bind.h"

namespace throng {
namespace {

constexpr uint32_t kSpirv[] = {
#include "bind/bind.comp.inc"
};

}  // namespace

Kernel bind_kernel(const std::shared_ptr<Gpu>& gpu) { return Kernel(gpu, {.name = "bind", .spirv = kSpirv}); }

}  // namespace throng
