#include "scan/scan_table.h"
#include "scan/stream_plan.h"

#include <algorithm>

namespace throng {
namespace {

// Two subgroups or more, so that a processor's limit of workgroups does not bind.
uint32_t workgroup_size(const ScanLimits& limits, uint32_t lanes) {
    const uint32_t wanted = limits.is_cpu ? std::max(limits.subgroup_size, lanes) : std::max(64u, 2 * lanes);
    return std::min(wanted, limits.workgroup_size);
}

uint32_t most_lanes(const ScanLimits& limits) { return std::max(limits.subgroup_size, limits.largest_subgroup_size); }

// 32 where the device can do that: half as many products a round as with 64.
std::vector<uint32_t> lane_choices(const ScanLimits& limits) {
    std::vector<uint32_t> choices;
    if (!limits.shuffle) return choices;
    for (uint32_t lanes = std::min(32u, most_lanes(limits)); lanes >= 4; lanes /= 2) choices.push_back(lanes);
    if (most_lanes(limits) >= 64) choices.push_back(64);
    return choices;
}

ScanPlan plan_with(const ScanRig& rig, const ScanLimits& limits, uint32_t lanes, ScanFormat format) {
    const uint32_t invocations = workgroup_size(limits, lanes), teams = invocations / lanes;
    const StreamPlan stream = plan_stream(
        rig,
        {.lanes = lanes, .most_slots = std::min(limits.shared_memory_bytes / (teams * bytes_of(format)), 0xFFFFu)});
    const uint32_t slot_bytes = stream.slots * bytes_of(format);
    if (std::string reason = memory_unsupported_reason(uint64_t{slot_bytes} * teams, " for parents of later chunks",
                                                       limits);
        !reason.empty())
        return {.unsupported_reason = std::move(reason)};
    ScanPlan plan{.workgroup_size = invocations,
                  .instances_per_workgroup = teams * stream.characters,
                  .constants = {lanes, stream.characters, stream.slots, std::max(stream.slots * teams, 1u)},
                  .links = stream_links(stream, rig.parents),
                  // Drivers may prefer larger ones, in which rounds cost more
                  .subgroup_size = lanes >= limits.subgroup_size && lanes <= limits.largest_subgroup_size ? lanes : 0,
                  .full_subgroups = true,
                  .on_chip = true};
    constexpr double kShuffles = 0.35;  // in products, by machine code of navi21: 83 instructions a round, 62 a product
    const double rows_of_local = bytes_of(format) / 16.0;
    const auto chunks = static_cast<uint32_t>(stream.chunks.size());
    const double subgroups = static_cast<double>(lanes) / limits.subgroup_size / stream.characters;
    plan.counts = {
        .multiplications = stream.multiplications / stream.characters,
        .longest_thread = stream.longest_lane,
        .shared_bytes = slot_bytes / stream.characters,
        // A round is a product and the shuffles that bring it the other factor.
        .issue_steps = (stream.longest_lane + kShuffles * stream.round_count) * subgroups,
        .loop_iterations = uint64_t{2} * chunks + stream.round_count + 1,
        .run_joints = lanes < rig.joint_count() ? static_cast<double>(lanes) : 0,
        // Links, a local transform, a slot read and one written, a model transform
        .issue_rows = chunks * (2 * kRowsOfLink + 3 * rows_of_local + kRowsOfAffine) * subgroups,
        .loops = {{"chunks", static_cast<double>(chunks)}, {"rounds", static_cast<double>(stream.round_count)}}};
    return plan;
}

ScanPlan plan_affine(const ScanRig& rig, const ScanLimits& limits, uint32_t lanes) {
    return plan_with(rig, limits, lanes, ScanFormat::kAffine);
}
ScanPlan plan_similarity(const ScanRig& rig, const ScanLimits& limits, uint32_t lanes) {
    return plan_with(rig, limits, lanes, ScanFormat::kSimilarity);
}

template <uint32_t kOrder>
FusedPlace fused_place(const ScanLimits& limits) {
    return {limits.is_cpu ? 0 : kOrder, std::min(32u, most_lanes(limits))};
}

Flow simulate(const ScanRig& rig, const FlowSettings& settings) {
    const StreamPlan stream = plan_stream(rig, {.lanes = settings.threads, .most_characters = 1});
    Flow flow(rig);
    std::vector<Product> products(rig.joint_count());
    std::vector<uint32_t> chunk_of(rig.joint_count());
    for (uint32_t c = 0; c < stream.chunks.size(); ++c) {
        const std::vector<uint32_t>& chunk = stream.chunks[c];
        flow.phase("chunk " + std::to_string(c + 1));
        std::vector<uint32_t> ancestors(chunk.size());  // lanes
        for (uint32_t lane = 0; lane < chunk.size(); ++lane) {
            const uint32_t joint = chunk[lane], parent = rig.parents[joint];
            const auto found = std::ranges::find(chunk, parent);
            ancestors[lane] = found == chunk.end() ? lane : static_cast<uint32_t>(found - chunk.begin());
            products[joint] = {joint};
            if (parent != kNone && found == chunk.end())
                products[joint] = flow.multiply(lane, FlowSource::kShared, products[parent], {joint});
        }
        for (uint32_t round = 0; round < stream.rounds[c]; ++round) {
            flow.phase("chunk " + std::to_string(c + 1) + ",\nround " + std::to_string(round + 1),
                       FlowBoundary::kShuffle);
            std::vector<Product> next = products;
            std::vector<uint32_t> next_ancestors = ancestors;
            for (uint32_t lane = 0; lane < chunk.size(); ++lane) {
                if (ancestors[lane] == lane) continue;
                next[chunk[lane]] = flow.multiply(lane, FlowSource::kShared, products[chunk[ancestors[lane]]],
                                                  products[chunk[lane]]);
                const uint32_t above = ancestors[ancestors[lane]];
                next_ancestors[lane] = above == ancestors[lane] ? lane : above;
            }
            products = std::move(next);
            ancestors = std::move(next_ancestors);
        }
        for (uint32_t lane = 0; lane < chunk.size(); ++lane) flow.store(lane, chunk[lane], products[chunk[lane]]);
    }
    return flow;
}

}  // namespace

ScanMethod stream() {
    return {.name = "stream",
            .order = 126,
            .summary = "joints in chunks of a subgroup's width, a lane each; parents by shuffles or from a few slots",
            .source = "warp scans (Harris and Garland 2012), list scheduling (Hu 1961)",
            .thread_choices = lane_choices,
            .plan = plan_affine,
            .fused_place = fused_place<4>,  // it reads rows where a character has them
            .picture = {simulate,
                        "Drawn with 4 lanes. A chunk holds any joints whose parents are in it or in earlier ones;\n"
                        "parents in earlier chunks wait in shared memory. ×1: nothing lies above a root."},
            .rank = 115,
            .style = {{"#1f7a3d", "#56d364"}, 2.4, "", 7, 0.45}};
}

ScanMethod stream_quaternion() {
    return {.name = "stream_quaternion",
            .order = 128,
            .summary = "stream, with rotations, translations and uniform scales of 32 bytes",
            .source = "stream",
            .format = ScanFormat::kSimilarity,
            .thread_choices = lane_choices,
            .plan = plan_similarity,
            .fused_place = fused_place<5>,
            .rank = 118,
            .style = {{"#0f5c2b", "#a6f0b5"}, 2.4, "", 5, 0.45}};
}

}  // namespace throng
