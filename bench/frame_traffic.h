// The bytes that an update should move.
#pragma once

#include <cstdint>

namespace throng::bench {

// The bytes of its instances that an update moves to and from memory. What instances share (keys, tables, inverse
// binds) is left out: it is small, and stays in caches.
struct FrameTraffic {
    bool fused = false;
    uint32_t clip_count = 2;  // of each instance
    uint32_t joint_count = 0, palette_count = 0;
    uint32_t local_bytes = 48;  // staged: of a local transform, 32 where the scan takes similarities
    uint32_t skin_bytes = 48;   // of a skin matrix
    uint64_t bytes_per_instance() const;
};

}  // namespace throng::bench
