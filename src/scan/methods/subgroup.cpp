#include "scan/pieces.h"
#include "scan/scan_table.h"

#include <algorithm>

namespace throng {
namespace {

// On GPUs a multiple of every subgroup size up to 64. On a software device the smallest workgroups spread evenly over
// the cores.
uint32_t workgroup_size(const ScanLimits& limits) {
    return std::min(limits.is_cpu ? limits.subgroup_size : 64, limits.workgroup_size);
}

// At most a whole subgroup per character. The best guess is that on a GPU, a single lane on a software device.
std::vector<uint32_t> thread_choices(const ScanLimits& limits) {
    std::vector<uint32_t> choices;
    if (!limits.shuffle) return choices;
    for (uint32_t threads = 1; threads <= std::min(limits.subgroup_size, workgroup_size(limits)); threads *= 2)
        choices.push_back(threads);
    if (!limits.is_cpu) std::reverse(choices.begin(), choices.end());
    return choices;
}

ScanPlan plan_with(const ScanRig& rig, const ScanLimits& limits, uint32_t threads, double rows_of_local) {
    PieceTable table = piece_table(rig, threads, rows_of_local);
    const uint32_t invocations = workgroup_size(limits), slots = std::max(table.slot_count, 1u);
    const auto transform_bytes = static_cast<uint32_t>(16 * rows_of_local);
    const uint32_t shared_bytes = slots * invocations * transform_bytes;
    if (std::string reason = memory_unsupported_reason(shared_bytes, kForWaitingParents, limits); !reason.empty())
        return {.unsupported_reason = std::move(reason)};
    ScanPlan plan{.workgroup_size = invocations,
                  .instances_per_workgroup = invocations / threads,
                  .constants = {threads, slots * invocations},
                  .links = std::move(table.links),
                  .full_subgroups = true,
                  .on_chip = true};
    const double subgroups = static_cast<double>(threads) / limits.subgroup_size;
    plan.counts = {.multiplications = table.multiplications,
                   .longest_thread = table.longest_thread,
                   .shared_bytes = slots * threads * transform_bytes,
                   .issue_steps = table.longest_thread * subgroups,
                   .loop_iterations = table.loop_iterations(),
                   .scattered = true,
                   .splits_lines = true,
                   .issue_rows = table.rows_on(limits) * subgroups,
                   .loops = table.loops()};
    return plan;
}

ScanPlan plan_affine(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    return plan_with(rig, limits, threads, kRowsOfAffine);
}
ScanPlan plan_similarity(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    return plan_with(rig, limits, threads, kRowsOfSimilarity);
}

// A subgroup per character, so that the barrier after the tile is the only one: see docs/performance.md.
template <uint32_t kOrder>
FusedPlace fused_place(const ScanLimits& limits, const FusedNeed&) {
    return {limits.is_cpu ? 0 : kOrder, std::min(32u, limits.subgroup_size)};
}

Flow simulate(const ScanRig& rig, const FlowSettings& settings) {
    return flow_pieces(rig, settings.threads, FlowBoundary::kShuffle);
}

}  // namespace

ScanMethod subgroup() {
    return {
        .name = "subgroup",
        .order = 110,
        .summary = "fragments inside a subgroup, by shuffles and without barriers; several small characters share one",
        .source = "fragments; warp scans (Harris and Garland 2012)",
        .thread_choices = thread_choices,
        .plan = plan_affine,
        .fused_place = fused_place<20>,
        .picture = {simulate,
                    "As fragments, with the lanes of a subgroup for threads and shuffles for barriers. Drawn with 4 "
                    "lanes.\n×1: nothing lies above a root."},
        .rank = 90,
        .style = {{"#0a8a94", "#39d3c3"}, 2.2, "", 7, 0.45}};
}

ScanMethod subgroup_quaternion() {
    return {.name = "subgroup_quaternion",
            .order = 120,
            .summary = "subgroup, with rotations, translations and uniform scales of 32 bytes",
            .source = "fragments; warp scans (Harris and Garland 2012)",
            .format = ScanFormat::kSimilarity,
            .thread_choices = thread_choices,
            .plan = plan_similarity,
            .fused_place = fused_place<10>,  // similarities need less shared memory
            .rank = 110,
            .style = {{"#075a73", "#8ee8f5"}, 2.4, "", 5, 0.45}};
}

}  // namespace throng
