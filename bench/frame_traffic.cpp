#include "bench/frame_traffic.h"

#include "control/control_io.h"

#include <throng/transform.h>

namespace throng::bench {

uint64_t FrameTraffic::bytes_per_instance() const {
    constexpr uint64_t kPose_bytes = 48, kModel_bytes = sizeof(Affine), kState_bytes = sizeof(io::InstancePlayback),
                       kTimes_bytes = 8, kCursor_bytes = sizeof(io::InstanceCursor);
    // control reads the state and writes both times and the cursor. The fused kernel reads the cursor; or two samples
    // and blend do.
    const uint64_t control_bytes = kState_bytes + kTimes_bytes + kCursor_bytes * (fused ? 2 : 4);
    // sample writes poses and blend reads them; blend writes local transforms and the scan reads them; the scan writes
    // model transforms.
    const uint64_t joint_bytes = fused ? 0 : 2 * clip_count * kPose_bytes + 2 * local_bytes + kModel_bytes;
    // bind reads a model transform and writes a skin matrix for each palette entry.
    const uint64_t entry_bytes = (fused ? 0 : kModel_bytes) + skin_bytes;
    return control_bytes + joint_count * joint_bytes + palette_count * entry_bytes;
}

}  // namespace throng::bench
