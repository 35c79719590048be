#include "scan/blocks.h"

namespace throng {

Blocks::Blocks(const ScanRig& rig, uint32_t block) {
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        const uint32_t parent = rig.parents[joint];
        const bool stays = parent != kNone && parent / block == joint / block;
        inside.push_back(stays ? parent : kNone);
        outside.push_back(stays ? outside[parent] : parent);
        depths.push_back(stays ? depths[parent] + 1 : 0);
        hops.push_back(outside.back() == kNone ? 0 : hops[outside.back()] + 1);
    }
}

void flow_hops(Flow& flow, const Blocks& blocks, const std::vector<Product>& products) {
    flow.phase("hops from\nblock to block", FlowBoundary::kBarrier);
    for (uint32_t joint = 0; joint < products.size(); ++joint) {
        Product product = products[joint];
        for (uint32_t ancestor = blocks.outside[joint]; ancestor != kNone; ancestor = blocks.outside[ancestor])
            product = flow.multiply(joint, FlowSource::kShared, products[ancestor], product);
        flow.store(joint, joint, product);
    }
}

}  // namespace throng
