// A skeleton cut into blocks of consecutive joint indices, for `blocks64` and `compressed`.
#pragma once

#include "scan/scan_flow.h"

namespace throng {

struct Blocks {
    Blocks(const ScanRig& rig, uint32_t block);

    // [joint_count]. inside: the parent if it lies in the joint's block, else kNone. outside: the first ancestor
    // outside the block
    std::vector<uint32_t> inside, outside;
    // [joint_count]. depths: number of ancestors in the joint's block. hops: blocks crossed on the way to the root
    std::vector<uint32_t> depths, hops;
};

// Simulates the last phase, which multiplies the products of the blocks on a joint's path.
void flow_hops(Flow& flow, const Blocks& blocks, const std::vector<Product>& products);

}  // namespace throng
