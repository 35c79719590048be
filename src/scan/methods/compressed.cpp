#include "scan/scan_io.h"
#include "scan/scan_table.h"

namespace throng {
namespace {

constexpr uint32_t kBlock = 64, kStride = 8, kBytesPerJoint = 96;

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    const bool fits = uint64_t{rig.joint_count()} * kBytesPerJoint <= limits.shared_memory_bytes;
    ScanPlan plan{.workgroup_size = strided_workgroup_size(rig.joint_count(), limits), .on_chip = fits};
    plan.constants = {fits ? rig.joint_count() : 1u, fits ? 1u : 0u};

    // Three words a joint: parent, 8th ancestor within the joint's block, first ancestor outside the block.
    std::vector<uint32_t> near(rig.joint_count()), strides(rig.joint_count()), hops(rig.joint_count());
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        uint32_t ancestor = joint, above = 0, eighth = io::kScanNoJoint;
        while (ancestor != io::kScanNoJoint && ancestor / kBlock == joint / kBlock) {
            if (above == kStride) eighth = ancestor;
            ancestor = rig.parents[ancestor];
            ++above;  // joints of the chain inside the block, the joint included
        }
        plan.links.insert(plan.links.end(), {rig.parents[joint], eighth, ancestor});
        near[joint] = std::min(above - 1, kStride - 1);
        strides[joint] = (above - 1) / kStride;
        hops[joint] = ancestor == io::kScanNoJoint ? 0 : hops[ancestor] + 1;
    }
    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    counter.phase(near, 2);
    counter.barrier();
    counter.phase(strides, 2);
    counter.barrier();
    counter.phase(hops, 2);
    counter.shared_bytes(fits ? uint64_t{rig.joint_count()} * kBytesPerJoint : 0);
    plan.counts = counter.counts();
    return plan;
}

}  // namespace

ScanMethod compressed() {
    return {.name = "compressed",
            .order = 50,
            .summary = "blocks of 64 joints, two strides of 8 inside a block, then hops between blocks",
            .source = "the paper's final method (Algorithm 4)",
            .origin = ScanOrigin::kPaper,
            .thread_choices = no_thread_choice,
            .plan = plan};
}

}  // namespace throng
