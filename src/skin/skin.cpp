#include "skin/skin.h"

namespace throng {
namespace {

constexpr uint32_t kSpirv[] = {
#include "skin/skin.comp.inc"
};

}  // namespace

Kernel skin_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format) {
    return Kernel(gpu, {.name = "skin", .spirv = kSpirv, .constants = {static_cast<uint32_t>(format)}});
}

}  // namespace throng
