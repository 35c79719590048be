// A skeleton whose joints are cut into blocks by their numbers: what `blocks64` and `compressed` work on.
#pragma once

#include "scan/scan_flow.h"

namespace throng {

struct Blocks {
    Blocks(const ScanRig& rig, uint32_t block);

    // [joint_count]: the parent if it lies in the joint's block, else kNone; the first ancestor outside the block
    std::vector<uint32_t> inside, outside;
    // [joint_count]: ancestors in the joint's block; blocks crossed on the way to the root
    std::vector<uint32_t> depths, hops;
};

// The last phase: products that end where their block does are joined.
void flow_hops(Flow& flow, const Blocks& blocks, const std::vector<Product>& products);

}  // namespace throng
