#include "scan/scan_table.h"

namespace throng {
namespace {

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    ScanPlan plan{
        .workgroup_size = strided_workgroup_size(rig.joint_count(), limits), .links = rig.parents, .on_chip = true};
    std::vector<uint32_t> multiplications;
    for (const uint32_t depth : rig.depths) multiplications.push_back(depth - 1);
    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    counter.phase(multiplications, 2);
    plan.counts = counter.counts();
    return plan;
}

}  // namespace

ScanMethod gateau2012_walk() {
    return {.name = "gateau2012_walk",
            .order = 10,
            .summary = "one thread per joint walks up to the root",
            .source = "Gateau, Massive Crowds on GPU, GTC 2012 (the paper's Algorithm 1)",
            .origin = ScanOrigin::kPaper,
            .thread_choices = no_thread_choice,
            .plan = plan};
}

}  // namespace throng
