#include "cull/cull.h"

#include "cull/cells.kernel.h"
#include "cull/cull.kernel.h"
#include "cull/list.kernel.h"
#include "cull/offsets.kernel.h"
#include "cull/pyramid.kernel.h"
#include "cull/reveal.kernel.h"

#include <algorithm>

namespace throng {
namespace {

uint32_t quotient_up(uint32_t count, uint32_t divisor) { return count / divisor + (count % divisor > 0 ? 1 : 0); }

}  // namespace

uint32_t cell_count(uint32_t instance_count) { return quotient_up(instance_count, io::kCullWorkgroupSize); }

// A single workgroup, of the offsets kernel, reads the counts of all others. Fewer workgroups have more cells each;
// more of them make the offsets kernel take longer (docs/performance.md, "A million").
uint32_t cells_of_workgroup(uint32_t instance_count) {
    constexpr uint32_t kWorkgroups = 1024;
    return std::clamp(quotient_up(cell_count(instance_count), kWorkgroups), 1u, uint32_t{io::kMaxCells});
}

uint32_t cull_workgroups_of(uint32_t instance_count) {
    return quotient_up(cell_count(instance_count), cells_of_workgroup(instance_count));
}

CullKernels::CullKernels(const std::shared_ptr<Gpu>& gpu)
    : cells(kernels::cells.on(gpu)),
      cull(kernels::cull.on(gpu)),
      offsets(kernels::offsets.on(gpu)),
      list(kernels::list.on(gpu)) {
    if (gpu->is_native()) return;
    reveal = kernels::reveal.on(gpu);
    pyramid = kernels::pyramid.on(gpu);
}

}  // namespace throng
