#include "procedural/procedural.h"

#include "shaders.h"

namespace throng {

Kernel procedural_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t kind, bool similarities) {
    return Kernel(gpu,
                  {.name = "procedural", .spirv = shaders::procedural.words(*gpu), .constants = {similarities, kind}});
}

}  // namespace throng
