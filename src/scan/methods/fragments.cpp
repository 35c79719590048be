#include "scan/pieces.h"
#include "scan/scan_table.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint32_t kTransform_bytes = 48;

std::vector<uint32_t> thread_choices(const ScanLimits& limits) {
    std::vector<uint32_t> choices;
    for (const uint32_t threads : {32u, 16u, 64u, 128u, 256u})
        if (threads <= limits.workgroup_size) choices.push_back(threads);
    return choices;
}

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    PieceTable table = piece_table(rig, threads, kRowsOfAffine);
    const uint32_t slots = std::max(table.slot_count, 1u), shared_transforms = (slots + 2) * threads;
    const uint32_t shared_bytes = shared_transforms * kTransform_bytes;
    if (std::string reason = memory_unsupported_reason(shared_bytes, " for the pieces", limits); !reason.empty())
        return {.unsupported_reason = std::move(reason)};
    ScanPlan plan{.workgroup_size = threads,
                  .constants = {threads, slots * threads},
                  .links = std::move(table.links),
                  .on_chip = true};
    const double subgroups = std::max(1.0, static_cast<double>(threads) / limits.subgroup_size);
    plan.counts = {.multiplications = table.multiplications,
                   .longest_thread = table.longest_thread,
                   .barriers = table.round_count,
                   .shared_bytes = shared_bytes,
                   .issue_steps = table.longest_thread * subgroups,
                   .loop_iterations = table.loop_iterations(),
                   .scattered = true,
                   .splits_lines = true,
                   .issue_rows = table.rows_on(limits) * subgroups,
                   .loops = table.loops()};
    return plan;
}

Flow simulate(const ScanRig& rig, const FlowSettings& settings) {
    return flow_pieces(rig, settings.threads, FlowBoundary::kBarrier);
}

}  // namespace

ScanMethod fragments() {
    return {
        .name = "fragments",
        .order = 100,
        .summary =
            "a connected piece of the skeleton per thread, a small scan over the pieces, one multiplication per joint",
        .source = "the work-efficient scan (Blelloch 1990; Harris et al. 2007) carried over to trees",
        .thread_choices = thread_choices,
        .plan = plan,
        .fused_place =
            [](const ScanLimits& limits, const FusedNeed&) {
                return FusedPlace{limits.is_cpu ? 0u : 30u, 32};
            },
        .picture = {simulate,
                    "Drawn with 4 pieces; the method has 16 to 256. A piece's path runs through the piece above it,\n"
                    "down to the joint that it hangs from. ×1: nothing lies above a root."},
        .rank = 100,
        .style = {{"#2f81f7", "#58a6ff"}, 2.2, "", 7, 0.45}};
}

}  // namespace throng
