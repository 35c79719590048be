#include "procedural/procedural.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "procedural/procedural.comp.inc"
};
constexpr uint32_t kSoftware[] = {
#include "procedural/procedural.software.inc"
};

}  // namespace

Kernel procedural_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t kind, bool similarities) {
    return Kernel(gpu, {.name = "procedural",
                        .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftware) : kPlain,
                        .constants = {similarities, kind}});
}

}  // namespace throng
