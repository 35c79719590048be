#include "scan/scan_table.h"
#include "scan/stream_plan.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint32_t kMaxSubgroups = 4;  // per character: more were slower on an H100 (docs/scan.md#stream)

// Two or more subgroups, so that the limit of workgroups per processor does not limit occupancy.
uint32_t workgroup_size(const ScanLimits& limits, const StreamTeam& team) {
    if (team.subgroups > 1) return team.lanes * team.subgroups;
    const uint32_t wanted = limits.is_cpu ? std::max(limits.subgroup_size, team.lanes) : std::max(64u, 2 * team.lanes);
    return std::min(wanted, limits.workgroup_size);
}

// At most 32: with 64 lanes, a round of doubling would have twice as many products.
uint32_t preferred_lanes(const ScanLimits& limits) {
    return std::min(32u, std::max(limits.subgroup_size, limits.largest_subgroup_size));
}

std::vector<uint32_t> lane_choices(const ScanLimits& limits) {
    std::vector<uint32_t> choices;
    if (!limits.shuffle) return choices;
    for (uint32_t lanes = preferred_lanes(limits); lanes >= 4; lanes /= 2) choices.push_back(lanes);
    return choices;
}

std::vector<uint32_t> thread_choices(const ScanLimits& limits) {
    std::vector<uint32_t> choices = lane_choices(limits);
    if (choices.empty()) return choices;
    for (uint32_t threads = 2 * preferred_lanes(limits); threads <= limits.workgroup_size; threads *= 2) {
        const StreamTeam team(limits, threads);
        const bool is_certain = team.lanes <= limits.largest_subgroup_size;  // that subgroups have as many lanes
        if (team.subgroups > (is_certain ? kMaxSubgroups : 1)) break;
        choices.push_back(threads);
    }
    return choices;
}

// Multiplications on the critical path. The rounds of a team's subgroups run in parallel. But they multiply by
// ancestors in earlier chunks one after the other, since each needs what the one before has put into slots.
uint32_t longest_thread(const StreamPlan& stream, uint32_t subgroups) {
    uint32_t longest = stream.longest_lane - stream.round_count;
    for (size_t first = 0; first < stream.rounds.size(); first += subgroups) {
        const auto rounds = std::span(stream.rounds).subspan(first);
        longest += std::ranges::max(rounds.first(std::min<size_t>(subgroups, rounds.size())));
    }
    return longest;
}

ScanPlan plan_with(const ScanRig& rig, const ScanLimits& limits, uint32_t threads, ScanFormat format) {
    const StreamTeam team(limits, threads);
    const uint32_t lanes = team.lanes;
    const uint32_t invocations = workgroup_size(limits, team), teams = invocations / threads;
    // The same as for a team of one subgroup, so that the chunks do not depend on how many subgroups share them
    const uint32_t teams_of_one = workgroup_size(limits, StreamTeam(limits, lanes)) / lanes;
    const StreamPlan stream = plan_stream(
        rig, {.lanes = lanes,
              .max_slots = std::min(limits.shared_memory_bytes / (teams_of_one * bytes_of(format)), 0xFFFFu),
              .max_characters = team.subgroups > 1 ? 1 : StreamLimits().max_characters});
    const uint32_t slot_bytes = stream.slots * bytes_of(format);
    if (std::string reason = memory_unsupported_reason(uint64_t{slot_bytes} * teams, " for parents of later chunks",
                                                       limits);
        !reason.empty())
        return {.unsupported_reason = std::move(reason)};
    ScanPlan plan{
        .workgroup_size = invocations,
        .instances_per_workgroup = teams * stream.characters,
        .constants = {lanes, stream.characters, stream.slots, std::max(stream.slots * teams, 1u), team.subgroups},
        .links = stream_links(stream, rig.parents),
        // Otherwise drivers may choose larger subgroups, in which rounds cost more
        .subgroup_size = lanes >= limits.subgroup_size && lanes <= limits.largest_subgroup_size ? lanes : 0,
        .full_subgroups = true,
        .on_chip = true};
    constexpr double kShuffles = 0.35;  // in products; from navi21 machine code: 83 instructions a round, 62 a product
    const double rows_of_local = bytes_of(format) / 16.0;
    const auto chunks = static_cast<uint32_t>(stream.chunks.size());
    const uint32_t chunks_of_one = (chunks + team.subgroups - 1) / team.subgroups;
    const double subgroups = static_cast<double>(lanes) / limits.subgroup_size / stream.characters;
    plan.counts = {.multiplications = stream.multiplications / stream.characters,
                   .longest_thread = longest_thread(stream, team.subgroups),
                   .barriers = team.subgroups > 1 ? chunks_of_one * team.subgroups : 0,
                   .shared_bytes = slot_bytes / stream.characters,
                   // A round is a product, and the shuffles that fetch its other factor.
                   .issue_steps = (stream.longest_lane + kShuffles * stream.round_count) * subgroups,
                   .loop_iterations = (team.subgroups > 1 ? 2 + team.subgroups : uint64_t{2}) * chunks_of_one +
                                      stream.round_count + 1,
                   .run_joints = lanes < rig.joint_count() ? static_cast<double>(lanes) : 0,
                   // Links, a local transform, a slot read and one written, a model transform
                   .issue_rows = chunks * (2 * kRowsOfLink + 3 * rows_of_local + kRowsOfAffine) * subgroups,
                   .loops = {{"chunks", static_cast<double>(chunks_of_one)},
                             {"rounds", static_cast<double>(stream.round_count) / team.subgroups}}};
    return plan;
}

ScanPlan plan_affine(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    return plan_with(rig, limits, threads, ScanFormat::kAffine);
}
ScanPlan plan_similarity(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    return plan_with(rig, limits, threads, ScanFormat::kSimilarity);
}

// One subgroup per character, or as many as the device can hold and the character has chunks for. Characters so small
// that several may share a chunk get one, so that their chunks, and thus their results to the bit, are the same for any
// number of characters.
template <uint32_t kOrder>
FusedPlace fused_place(const ScanLimits& limits, const FusedNeed& need) {
    FusedPlace place{limits.is_cpu ? 0 : kOrder, preferred_lanes(limits)};
    const uint32_t lanes = place.threads;
    for (const uint32_t threads : thread_choices(limits)) {
        const StreamTeam team(limits, threads);
        if (team.lanes == lanes && threads > place.threads && team.subgroups <= need.subgroups &&
            need.joint_count > lanes * std::max(kMaxShared / 2, team.subgroups - 1))
            place.threads = threads;
    }
    return place;
}

Flow simulate(const ScanRig& rig, const FlowSettings& settings) {
    const StreamPlan stream = plan_stream(rig, {.lanes = settings.threads, .max_characters = 1});
    Flow flow(rig);
    std::vector<Product> products(rig.joint_count());
    std::vector<uint32_t> outside(rig.joint_count(), kNone);  // the lowest ancestor in an earlier chunk
    for (uint32_t c = 0; c < stream.chunks.size(); ++c) {
        const std::vector<uint32_t>& chunk = stream.chunks[c];
        const std::string name = "chunk " + std::to_string(c + 1);
        std::vector<uint32_t> ancestors(chunk.size());  // lanes
        for (uint32_t lane = 0; lane < chunk.size(); ++lane) {
            const uint32_t joint = chunk[lane], parent = rig.parents[joint];
            const auto found = std::ranges::find(chunk, parent);
            ancestors[lane] = found == chunk.end() ? lane : static_cast<uint32_t>(found - chunk.begin());
            if (parent != kNone) outside[joint] = found == chunk.end() ? parent : outside[parent];
            products[joint] = {joint};
        }
        for (uint32_t round = 0; round < stream.rounds[c]; ++round) {
            flow.phase(name + ",\nround " + std::to_string(round + 1), FlowBoundary::kShuffle);
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
        flow.phase(name + ",\nfrom above");
        for (uint32_t lane = 0; lane < chunk.size(); ++lane) {
            const uint32_t joint = chunk[lane];
            if (outside[joint] != kNone)
                products[joint] = flow.multiply(lane, FlowSource::kShared, products[outside[joint]], products[joint]);
            flow.store(lane, joint, products[joint]);
        }
    }
    return flow;
}

}  // namespace

ScanMethod stream() {
    return {.name = "stream",
            .order = 126,
            .summary = "joints in chunks of a subgroup's width, a lane each; parents by shuffles or from a few slots",
            .source = "warp scans (Harris and Garland 2012), list scheduling (Hu 1961)",
            .thread_choices = thread_choices,
            .planned_choices = lane_choices,  // not more: unfused, the stage is bound by memory
            .plan = plan_affine,
            .fused_place = fused_place<4>,  // it reads rows if the character has them
            .picture = {simulate,
                        "Drawn with 4 lanes. A chunk holds any joints whose parents are in it or in earlier ones;\n"
                        "ancestors in earlier chunks wait in shared memory."},
            .rank = 115,
            .style = {{"#1f7a3d", "#56d364"}, 2.4, "", 7, 0.45}};
}

ScanMethod stream_quaternion() {
    return {.name = "stream_quaternion",
            .order = 128,
            .summary = "stream, with rotations, translations and uniform scales of 32 bytes",
            .source = "stream",
            .format = ScanFormat::kSimilarity,
            .thread_choices = thread_choices,
            .planned_choices = lane_choices,  // not more: unfused, the stage is bound by memory
            .plan = plan_similarity,
            .fused_place = fused_place<5>,
            .rank = 118,
            .style = {{"#0f5c2b", "#a6f0b5"}, 2.4, "", 5, 0.45}};
}

}  // namespace throng
