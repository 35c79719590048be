#include "update_rate/update_rate.h"

#include "shaders.h"

namespace throng {

Kernel update_rate_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format) {
    return Kernel(gpu, {.name = "update_rate",
                        .spirv = shaders::update_rate.words(*gpu),
                        .constants = {static_cast<uint32_t>(format)}});
}

}  // namespace throng
