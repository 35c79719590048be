#include "sample/sample.h"

#include "shaders.h"

namespace throng {

Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu, bool packed) {
    return Kernel(gpu, {.name = "sample", .spirv = shaders::sample.words(*gpu), .constants = {packed ? 1u : 0u}});
}

}  // namespace throng
