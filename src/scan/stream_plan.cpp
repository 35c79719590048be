#include "scan/stream_plan.h"

#include "scan/stream_io.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <queue>

namespace throng {
namespace {

// Costs in multiplications. A chunk: sampling, blending and storing a joint, from machine code (docs/performance.md).
constexpr double kChunkCost = 5;
constexpr double kCharacterCost = 0.5;  // extra cost of a chunk if several characters share it
// A slot takes shared memory. The first kFreeSlots do not limit occupancy (docs/performance.md)
constexpr double kSlotCost = 0.02, kCostOfMoreSlots = 0.2;
constexpr uint32_t kFreeSlots = 56;
// For each run of adjacent joints in a chunk beyond the first. Cache lines that one chunk writes partly and a later one
// completes go to memory twice, since the subgroups of a large GPU together write more than its cache holds. On an
// H100, a chunk of 32 joints, none of them adjacent, took as long as one with 30 products more (docs/scan.md#stream).
constexpr double kPlaceCost = 1;

// The joints of several characters, one character after the other.
struct Forest {
    Forest(std::span<const uint32_t> of_one, uint32_t characters) : parents(of_one.size() * characters) {
        const auto joint_count = static_cast<uint32_t>(of_one.size());
        for (uint32_t joint = 0; joint < parents.size(); ++joint) {
            const uint32_t parent = of_one[joint % joint_count];
            parents[joint] = parent == kNone ? kNone : joint / joint_count * joint_count + parent;
        }
        children.resize(parents.size());
        heights.resize(parents.size(), 1);
        for (uint32_t joint = static_cast<uint32_t>(parents.size()); joint-- > 0;) {
            if (parents[joint] == kNone) continue;
            children[parents[joint]].push_back(joint);
            heights[parents[joint]] = std::max(heights[parents[joint]], heights[joint] + 1);
        }
    }

    uint32_t joint_count() const { return static_cast<uint32_t>(parents.size()); }

    std::vector<uint32_t> parents;
    std::vector<std::vector<uint32_t>> children;
    std::vector<uint32_t> heights;  // number of joints on the longest path down
};

using Chunks = std::vector<std::vector<uint32_t>>;

// How many generations a chunk may go down from joints of its own.
struct DepthLimit {
    uint32_t most = 0;            // generations below the chunk's first
    bool only_if_needed = false;  // the limit is 0 while one generation per chunk suffices for the joints left
};

// Always takes the ready joint with the longest path below it. Source: list scheduling by levels, T. C. Hu, Parallel
// Sequencing and Assembly Line Problems, Operations Research 9 (6), 1961.
Chunks schedule(const Forest& forest, uint32_t lanes, const DepthLimit& limit) {
    const auto lower = [&](uint32_t a, uint32_t b) {
        return forest.heights[a] != forest.heights[b] ? forest.heights[a] < forest.heights[b] : a > b;
    };
    using Queue = std::priority_queue<uint32_t, std::vector<uint32_t>, decltype(lower)>;
    Queue ready(lower), below(lower);  // joints with their parents in earlier chunks; in the current chunk
    for (uint32_t joint = 0; joint < forest.joint_count(); ++joint)
        if (forest.parents[joint] == kNone) ready.push(joint);
    std::vector<uint32_t> depths(forest.joint_count()), later;
    Chunks chunks;
    for (uint32_t left = forest.joint_count(); left > 0; left -= static_cast<uint32_t>(chunks.back().size())) {
        const uint32_t chunks_left = (left + lanes - 1) / lanes;
        const bool needs_depth = ready.size() < std::min(lanes, left) || forest.heights[ready.top()] > chunks_left;
        const uint32_t max_depth = limit.only_if_needed && !needs_depth ? 0 : limit.most;
        std::vector<uint32_t>& chunk = chunks.emplace_back();
        while (chunk.size() < lanes && !(ready.empty() && below.empty())) {
            const bool from_below = ready.empty() || (!below.empty() && lower(ready.top(), below.top()));
            Queue& queue = from_below ? below : ready;
            const uint32_t joint = queue.top();
            queue.pop();
            if (!from_below) depths[joint] = 0;
            chunk.push_back(joint);
            for (const uint32_t child : forest.children[joint]) {
                depths[child] = depths[joint] + 1;
                if (depths[child] <= max_depth)
                    below.push(child);
                else
                    later.push_back(child);
            }
        }
        for (; !below.empty(); below.pop()) ready.push(below.top());
        for (const uint32_t joint : later) ready.push(joint);
        later.clear();
    }
    return chunks;
}

Chunks cut(const std::vector<uint32_t>& order, uint32_t lanes) {
    Chunks chunks;
    for (size_t first = 0; first < order.size(); first += lanes)
        chunks.emplace_back(order.begin() + static_cast<ptrdiff_t>(first),
                            order.begin() + static_cast<ptrdiff_t>(std::min<size_t>(first + lanes, order.size())));
    return chunks;
}

std::vector<uint32_t> as_they_are(const Forest& forest) {
    std::vector<uint32_t> order(forest.joint_count());
    std::iota(order.begin(), order.end(), 0u);
    return order;
}

// Largest subtree last, so that few joints wait for children.
std::vector<uint32_t> depth_first(const Forest& forest) {
    std::vector<uint32_t> sizes(forest.joint_count(), 1), order, stack;
    for (uint32_t joint = forest.joint_count(); joint-- > 0;)
        if (forest.parents[joint] != kNone) sizes[forest.parents[joint]] += sizes[joint];
    for (uint32_t joint = forest.joint_count(); joint-- > 0;)
        if (forest.parents[joint] == kNone) stack.push_back(joint);
    while (!stack.empty()) {
        const uint32_t joint = stack.back();
        stack.pop_back();
        order.push_back(joint);
        const auto first = static_cast<ptrdiff_t>(stack.size());
        stack.insert(stack.end(), forest.children[joint].begin(), forest.children[joint].end());
        std::stable_sort(stack.begin() + first, stack.end(),
                         [&](uint32_t a, uint32_t b) { return sizes[a] > sizes[b]; });
    }
    return order;
}

std::vector<uint32_t> breadth_first(const Forest& forest) {
    std::vector<uint32_t> depths(forest.joint_count()), order = as_they_are(forest);
    for (uint32_t joint = 0; joint < forest.joint_count(); ++joint)
        if (forest.parents[joint] != kNone) depths[joint] = depths[forest.parents[joint]] + 1;
    std::ranges::stable_sort(order, {}, [&](uint32_t joint) { return depths[joint]; });
    return order;
}

// Number of runs of adjacent joints.
uint32_t place_count(const std::vector<uint32_t>& sorted) {
    uint32_t count = 1;
    for (size_t i = 1; i < sorted.size(); ++i) count += sorted[i] != sorted[i - 1] + 1;
    return count;
}

std::vector<uint32_t> chunks_of_joints(const Chunks& chunks, size_t joint_count) {
    std::vector<uint32_t> of_joint(joint_count);
    for (uint32_t c = 0; c < chunks.size(); ++c)
        for (const uint32_t joint : chunks[c]) of_joint[joint] = c;
    return of_joint;
}

// Counts the rounds and multiplications of the plan's chunks.
void count(const Forest& forest, StreamPlan& plan) {
    const std::vector<uint32_t> chunk_of = chunks_of_joints(plan.chunks, forest.joint_count());
    std::vector<uint32_t> depths(forest.joint_count());  // within the chunk
    std::vector<bool> has_slot(forest.joint_count());    // whether an ancestor is in an earlier chunk
    for (const std::vector<uint32_t>& chunk : plan.chunks) {
        uint32_t max_rounds = 0, from_slots = 0;
        for (const uint32_t joint : chunk) {  // parents first
            const uint32_t parent = forest.parents[joint];
            if (parent == kNone) continue;
            const bool is_inside = chunk_of[parent] == chunk_of[joint];
            if (is_inside) depths[joint] = depths[parent] + 1;
            has_slot[joint] = !is_inside || has_slot[parent];
            from_slots += has_slot[joint];
            const auto rounds = static_cast<uint32_t>(std::bit_width(depths[joint]));
            plan.multiplications += rounds;
            max_rounds = std::max(max_rounds, rounds);
        }
        plan.rounds.push_back(max_rounds);
        plan.round_count += max_rounds;
        plan.multiplications += from_slots;
        plan.longest_lane += max_rounds + (from_slots > 0 ? 1 : 0);
    }
}

// The slots where transforms wait for children in later chunks.
struct Slots {
    std::vector<uint32_t> of_joint;  // kNone if none is needed
    uint32_t count = 0;
};

// A chunk reads all slots before it writes any, so a slot read for the last time can be written by the same chunk.
Slots slots_of(const std::vector<uint32_t>& parents, const Chunks& chunks) {
    const std::vector<uint32_t> chunk_of = chunks_of_joints(chunks, parents.size());
    std::vector<uint32_t> last_readers(parents.size());  // last chunk that reads the joint
    for (size_t joint = 0; joint < parents.size(); ++joint)
        if (parents[joint] != kNone)
            last_readers[parents[joint]] = std::max(last_readers[parents[joint]], chunk_of[joint]);
    Slots slots{.of_joint = std::vector<uint32_t>(parents.size(), kNone)};
    std::vector<std::vector<uint32_t>> freed(chunks.size());  // [chunk], slots read for the last time
    std::priority_queue<uint32_t, std::vector<uint32_t>, std::greater<>> free;
    for (uint32_t c = 0; c < chunks.size(); ++c) {
        for (const uint32_t slot : freed[c]) free.push(slot);
        for (const uint32_t joint : chunks[c]) {
            if (last_readers[joint] <= c) continue;
            if (free.empty()) free.push(slots.count++);
            slots.of_joint[joint] = free.top();
            free.pop();
            freed[last_readers[joint]].push_back(slots.of_joint[joint]);
        }
    }
    return slots;
}

struct Candidate {
    StreamPlan plan;
    double cost = 0;  // per character, in multiplications of a subgroup
};

// Repeats the chunks of one character for several characters that share them. A joint is computed in the same way in
// each, so that an instance's result does not depend, to the bit, on which others share its subgroup.
Chunks side_by_side(const Chunks& of_one, uint32_t joint_count, uint32_t characters) {
    Chunks chunks;
    for (const std::vector<uint32_t>& one : of_one) {
        std::vector<uint32_t>& chunk = chunks.emplace_back();
        for (uint32_t character = 0; character < characters; ++character)
            for (const uint32_t joint : one) chunk.push_back(character * joint_count + joint);
    }
    return chunks;
}

Candidate candidate_of(const Forest& forest, Chunks chunks, uint32_t lanes, uint32_t characters) {
    Candidate candidate;
    StreamPlan& plan = candidate.plan;
    plan.lanes = lanes;
    plan.characters = characters;
    plan.chunks = std::move(chunks);
    uint32_t more_places = 0;
    for (std::vector<uint32_t>& chunk : plan.chunks) {
        std::ranges::sort(chunk);  // keeps parents first, and adjacent lanes write adjacent joints
        more_places += place_count(chunk) - 1;
    }
    plan.slots = slots_of(forest.parents, plan.chunks).count;
    count(forest, plan);
    const double chunk_cost = characters == 1 ? kChunkCost : kChunkCost + kCharacterCost;
    candidate.cost = (chunk_cost * static_cast<double>(plan.chunks.size()) + plan.round_count +
                      kPlaceCost * more_places + kSlotCost * plan.slots +
                      kCostOfMoreSlots * (std::max(plan.slots, kFreeSlots) - kFreeSlots)) /
                     characters;
    return candidate;
}

}  // namespace

StreamTeam::StreamTeam(const ScanLimits& limits, uint32_t threads) {
    // Prefers subgroups of 32 if the device supports them: a round has half as many products as with 64.
    const uint32_t widest = std::max(limits.subgroup_size, std::min(32u, limits.largest_subgroup_size));
    lanes = std::min(threads, widest);
    subgroups = threads / lanes;
}

StreamPlan plan_stream(const ScanRig& rig, const StreamLimits& limits) {
    const Forest one(rig.parents, 1);
    Candidate best;
    for (uint32_t characters = 1; characters <= std::min(limits.max_characters, limits.lanes); ++characters) {
        if (characters > 1 && characters * rig.joint_count() > kMaxShared * limits.lanes) break;
        const Forest forest(rig.parents, characters);
        const uint32_t lanes = limits.lanes / characters;  // per character
        const auto consider = [&](const Chunks& of_one) {
            Candidate candidate = candidate_of(forest, side_by_side(of_one, rig.joint_count(), characters),
                                               limits.lanes, characters);
            const auto excess = [&](const StreamPlan& plan) {
                return std::max(plan.slots, limits.max_slots) - limits.max_slots;
            };
            const bool is_first = best.plan.lanes == 0;
            if (is_first || std::pair(excess(candidate.plan), candidate.cost) < std::pair(excess(best.plan), best.cost))
                best = std::move(candidate);
        };
        consider(cut(as_they_are(one), lanes));
        consider(cut(breadth_first(one), lanes));
        consider(cut(depth_first(one), lanes));
        for (uint32_t depth = 0; depth < lanes; depth = 2 * depth + 1)
            for (const bool only_if_needed : {false, true}) consider(schedule(one, lanes, {depth, only_if_needed}));
    }
    return std::move(best.plan);
}

std::vector<uint32_t> stream_links(const StreamPlan& plan, std::span<const uint32_t> parents) {
    const Forest forest(parents, plan.characters);
    const std::vector<uint32_t> chunk_of = chunks_of_joints(plan.chunks, forest.joint_count());
    const Slots slots = slots_of(forest.parents, plan.chunks);
    std::vector<uint32_t> lane_of(forest.joint_count());
    for (const std::vector<uint32_t>& chunk : plan.chunks)
        for (uint32_t lane = 0; lane < chunk.size(); ++lane) lane_of[chunk[lane]] = lane;
    std::vector<uint32_t> links{static_cast<uint32_t>(plan.chunks.size())};
    links.insert(links.end(), plan.rounds.begin(), plan.rounds.end());
    std::vector<uint32_t> from(forest.joint_count());  // 1 + slot of the lowest ancestor in an earlier chunk, or 0
    for (const std::vector<uint32_t>& chunk : plan.chunks)
        for (uint32_t lane = 0; lane < plan.lanes; ++lane) {
            if (lane >= chunk.size()) {
                links.insert(links.end(), {io::kStreamIdle, lane});
                continue;
            }
            const uint32_t joint = chunk[lane], parent = forest.parents[joint];
            const bool is_inside = parent != kNone && chunk_of[parent] == chunk_of[joint];
            const uint32_t keep = slots.of_joint[joint] + 1;  // kNone + 1 is 0
            if (parent != kNone) from[joint] = is_inside ? from[parent] : slots.of_joint[parent] + 1;
            const auto joint_count = static_cast<uint32_t>(parents.size());
            links.push_back(joint % joint_count | keep << io::kStreamKeepShift);
            links.push_back((is_inside ? lane_of[parent] : lane) | joint / joint_count << io::kStreamCharacterShift |
                            from[joint] << io::kStreamSlotShift);
        }
    return links;
}

}  // namespace throng
