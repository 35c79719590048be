// Hillis and Steele's doubling over chains of ancestors, for `doubling` and `blocks64`.
#pragma once

#include "scan/scan_table.h"

namespace throng {

struct DoublingTable {
    uint32_t round_count = 1;     // ceil(log2(joints of the longest chain)), at least 1
    std::vector<uint32_t> links;  // see scan/doubling_io.h
};

// parents[j] < j, or kNone where a chain ends: at a root, or where the caller cut it.
DoublingTable doubling_table(std::span<const uint32_t> parents);

// Adds the costs of the rounds, and of a barrier between each two, to `counter`. `reloads`: products do not stay in
// registers. `last_stores_all`: the last round is a loop of its own, and there joints whose chains were complete before
// store their products too.
void count_doubling(const DoublingTable& table, uint32_t joint_count, bool reloads, bool last_stores_all,
                    ScanCounter& counter);

// Simulates the rounds over all chains; returns each joint's product.
std::vector<Product> flow_doubling(Flow& flow, std::span<const uint32_t> parents);

}  // namespace throng
