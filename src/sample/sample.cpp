#include "sample/sample.h"

namespace throng {
namespace {

constexpr uint32_t kSpirv[] = {
#include "sample/sample.comp.inc"
};

}  // namespace

Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu) { return Kernel(gpu, {.name = "sample", .spirv = kSpirv}); }

}  // namespace throng
