#include "bench/isa/scan_works.h"

#include "base/failure.h"
#include "bench/on_chip_kernel.h"

#include <cmath>

namespace throng::bench {
namespace {

// Besides the method's own loops, the on-chip host has two: one that fills shared memory, whose work does not count,
// and the repeats.
std::vector<LoopTrips> loops_of(const ScanCounts& counts, ScanPlace place) {
    std::vector<LoopTrips> loops;
    if (place == ScanPlace::kChip) loops = {{"filling", 0}, {"repeats", 1}};
    loops.insert(loops.end(), counts.loops.begin(), counts.loops.end());
    return loops;
}

}  // namespace

KernelWork ScanWork::of(uint32_t characters) const {
    KernelWork work{.needs = kernel.needs(),
                    .issued = issued_by_subgroup(kernel.code, trips),
                    .subgroups = std::ceil(static_cast<double>(characters) / plan.instances_per_workgroup) *
                                 subgroups_of(kernel.needs())};
    if (place == ScanPlace::kChip)
        work.issued.add(kernel.code.outside, -1);
    else
        work.bytes = (static_cast<double>(bytes_of(choice.method->format) + sizeof(Affine)) +
                      plan.counts.split_bytes()) *
                     joint_count * characters;
    return work;
}

void visit_scan_works(const Compiler& compiler, const ScanRig& rig, ScanPlace place,
                      const std::function<void(const ScanWork&)>& visit) {
    const ScanLimits limits = compiler.scan_limits();
    for (const ScanMethod& method : scan_table())
        for (const uint32_t threads : method.thread_choices(limits)) {
            ScanWork work{.place = place,
                          .choice = {&method, threads},
                          .plan = plan_scan(method, rig, limits, threads),
                          .joint_count = rig.joint_count()};
            const bool applies = place == ScanPlace::kMemory
                                     ? work.plan.unsupported_reason.empty()
                                     : on_chip_unsupported_reason(work.plan, method, rig, limits).empty();
            if (!applies) continue;
            work.kernel = compiler
                              .made_by([&] {
                                  if (place == ScanPlace::kMemory)
                                      ScanStage(compiler.gpu(), work.choice, rig, limits);
                                  else
                                      on_chip_kernel(compiler.gpu(), method, work.plan, rig, false);
                              })
                              .front();
            const auto trips = trips_of(work.kernel.code, loops_of(work.plan.counts, place), work.kernel.subgroup_size);
            if (!trips)
                throw Failure(ErrorCode::kUnsupported, "machine code of scan " + name_of(work.choice),
                              "its loops (" + std::to_string(work.kernel.code.loops.size()) +
                                  ") do not match those that the plan counts (" +
                                  std::to_string(work.plan.counts.loops.size()) + ")");
            work.trips = *trips;
            visit(work);
        }
}

}  // namespace throng::bench
