#include "bind/bind.h"

#include "shaders.h"

namespace throng {

Kernel bind_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format) {
    return Kernel(gpu,
                  {.name = "bind", .spirv = shaders::bind.words(*gpu), .constants = {static_cast<uint32_t>(format)}});
}

}  // namespace throng
