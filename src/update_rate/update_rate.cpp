#include "update_rate/update_rate.h"

namespace throng {
namespace {

constexpr uint32_t kUpdateRate[] = {
#include "update_rate/update_rate.comp.inc"
};
constexpr uint32_t kUpdateRateSoftware[] = {
#include "update_rate/update_rate.software.inc"
};

}  // namespace

Kernel update_rate_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format) {
    return Kernel(gpu,
                  {.name = "update_rate",
                   .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kUpdateRateSoftware) : kUpdateRate,
                   .constants = {static_cast<uint32_t>(format)}});
}

}  // namespace throng
