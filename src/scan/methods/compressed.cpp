#include "scan/blocks.h"
#include "scan/scan_table.h"

namespace throng {
namespace {

constexpr uint32_t kBlock = 64, kStride = 8;

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    const SharedJoints shared(rig.joint_count(), limits);
    ScanPlan plan{.workgroup_size = strided_workgroup_size(rig.joint_count(), limits, threads),
                  .constants = shared.constants,
                  .on_chip = shared.fit};

    // Three words a joint: parent, 8th ancestor within the joint's block, first ancestor outside the block.
    const Blocks blocks(rig, kBlock);
    std::vector<uint32_t> near, strides;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        uint32_t eighth = joint;
        for (uint32_t i = 0; i < kStride && eighth != kNone; ++i) eighth = blocks.inside[eighth];
        plan.links.insert(plan.links.end(), {rig.parents[joint], eighth, blocks.outside[joint]});
        near.push_back(std::min(blocks.depths[joint], kStride - 1));
        strides.push_back(blocks.depths[joint] / kStride);
    }
    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    counter.loops("joints, nearest", "nearest ancestors", counter.phase(near, 2));
    counter.barrier();
    counter.loops("joints, strides", "strides", counter.phase(strides, 2));
    counter.barrier();
    counter.loops("joints, hops", "hops", counter.phase(blocks.hops, 2));
    counter.shared_bytes(shared.bytes);
    plan.counts = counter.counts();
    return plan;
}

Flow simulate(const ScanRig& rig, const FlowSettings& settings) {
    Flow flow(rig);
    const Blocks blocks(rig, settings.block);
    std::vector<Product> strides = local_products(rig);
    flow.phase("nearest " + std::to_string(settings.stride - 1) + "\nin the block");
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        uint32_t ancestor = blocks.inside[joint];
        for (uint32_t i = 1; i < settings.stride && ancestor != kNone; ++i, ancestor = blocks.inside[ancestor])
            strides[joint] = flow.multiply(joint, FlowSource::kLocal, {ancestor}, strides[joint]);
    }
    flow.phase("strides of " + std::to_string(settings.stride) + "\nin the block", FlowBoundary::kBarrier);
    std::vector<Product> products = strides;
    for (Product& product : products)
        while (blocks.inside[product.front()] != kNone)
            product = flow.multiply(product.back(), FlowSource::kShared, strides[blocks.inside[product.front()]],
                                    product);
    flow_hops(flow, blocks, products);
    return flow;
}

}  // namespace

ScanMethod compressed() {
    return {.name = "compressed",
            .order = 50,
            .summary = "blocks of 64 joints, two strides of 8 inside a block, then hops between blocks",
            .source = "the paper's final method (Algorithm 4)",
            .origin = ScanOrigin::kPaper,
            .thread_choices = strided_choices,
            .planned_choices = no_thread_choice,
            .plan = plan,
            .picture = {simulate,
                        "Drawn with blocks of 8 joints and strides of 3; the method has blocks of 64 and strides of 8.",
                        true},
            .rank = 80,
            .style = {{"#8f2613", "#ff6a4d"}, 2.2, "(14,4)", 9, 0.65}};
}

}  // namespace throng
