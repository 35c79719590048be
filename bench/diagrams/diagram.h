// The pictures of docs/scan: each method's data flow on one small skeleton. A column is a joint, a row is a
// multiplication of the longest thread, so that a picture's height is the critical path and its ink is the work.
#pragma once

#include "scan/scan_table.h"

namespace throng::bench {

struct Diagram {
    std::string name, svg;
};

// One for each method of the scan table that has a diagram, and for the baselines without a hierarchy.
std::vector<Diagram> scan_diagrams();

// What the pictures show: 16 joints in 8 levels, blocks and strides scaled down with them.
ScanRig diagram_rig();
inline constexpr FlowSettings kDiagramSettings{.block = 8, .stride = 3, .threads = 4};

}  // namespace throng::bench
