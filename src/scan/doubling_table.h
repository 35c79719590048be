// Hillis and Steele's doubling over chains of ancestors: what `doubling` and `blocks64` work on.
#pragma once

#include "scan/scan_table.h"

namespace throng {

struct DoublingTable {
    uint32_t round_count = 1;     // ceil(log2(joints of the longest chain)), at least 1
    std::vector<uint32_t> links;  // as in scan/doubling_io.h
};

// parents[j] < j, or kNone where the joint's chain ends, be it at a root or where it is cut.
DoublingTable doubling_table(std::span<const uint32_t> parents);

// What the rounds cost, with a barrier between two. `last_stores_all`: in the last round, a loop of its own, joints
// whose chains were complete before store their products too.
void count_doubling(const DoublingTable& table, uint32_t joint_count, bool reloads, bool last_stores_all,
                    ScanCounter& counter);

// Runs the rounds over all chains; returns each joint's product.
std::vector<Product> flow_doubling(Flow& flow, std::span<const uint32_t> parents);

}  // namespace throng
