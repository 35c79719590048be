#include "scan/doubling_table.h"

#include "scan/doubling_io.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace throng {
namespace {

void go_twice_as_far(std::vector<uint32_t>& ancestors) {
    for (auto joint = ancestors.size(); joint-- > 0;)  // from the end: an ancestor's own entry is not updated yet
        if (ancestors[joint] != kNone) ancestors[joint] = ancestors[ancestors[joint]];
}

}  // namespace

DoublingTable doubling_table(std::span<const uint32_t> parents) {
    DoublingTable table;
    std::vector<uint32_t> lengths, rounds;  // of the chain that ends in the joint
    for (const uint32_t parent : parents) {
        lengths.push_back(parent == kNone ? 1 : lengths[parent] + 1);
        rounds.push_back(std::max(static_cast<uint32_t>(std::bit_width(lengths.back() - 1)), 1u));
        table.round_count = std::max(table.round_count, rounds.back());
    }
    const auto writes_last = [&](uint32_t joint, uint32_t round) { return (rounds[joint] - 1 - round) % 2 == 0; };

    table.links.reserve(table.round_count * parents.size());
    std::vector<uint32_t> ancestors(parents.begin(), parents.end());
    for (uint32_t round = 0; round < table.round_count; ++round) {
        for (uint32_t joint = 0; joint < parents.size(); ++joint) {
            if (round >= rounds[joint]) {
                table.links.push_back(io::kDoublingDone);
                continue;
            }
            const uint32_t ancestor = ancestors[joint];
            uint32_t word = ancestor == kNone ? io::kDoublingNoAncestor : ancestor;
            if (round > 0 && writes_last(ancestor, std::min(round, rounds[ancestor]) - 1))
                word |= io::kDoublingAncestorInLast;
            if (writes_last(joint, round)) word |= io::kDoublingToLast;
            table.links.push_back(word);
        }
        go_twice_as_far(ancestors);
    }
    return table;
}

void count_doubling(const DoublingTable& table, uint32_t joint_count, bool reloads, bool last_stores_all,
                    ScanCounter& counter) {
    const uint32_t rounds = table.round_count;
    std::vector<double> strides;  // [round]
    for (uint32_t round = 0; round < rounds; ++round) {
        if (round > 0) counter.barrier();
        const bool stores_all = last_stores_all && round + 1 == rounds;
        std::vector<uint32_t> multiplications, moves;
        for (const uint32_t word : std::span(table.links).subspan(size_t{round} * joint_count, joint_count)) {
            const bool done = word == io::kDoublingDone;
            multiplications.push_back(done || (word & io::kDoublingNoAncestor) ? 0 : 1);
            moves.push_back(done && !stores_all ? 0 : (round == 0 || reloads ? 2 : 1));
        }
        strides.push_back(counter.phase(multiplications, moves).strides);
    }
    const bool has_last = last_stores_all && rounds > 1;
    counter.loop("joints, first round", strides.front());
    if (const uint32_t between = rounds - 1 - (has_last ? 1 : 0); between > 0) {
        if (between > 1) counter.loop("rounds", between);  // compilers remove a loop that runs once
        counter.loop("joints, rounds", std::accumulate(strides.begin() + 1, strides.begin() + 1 + between, 0.0));
    }
    if (has_last) counter.loop("joints, last round", strides.back());
}

std::vector<Product> flow_doubling(Flow& flow, std::span<const uint32_t> parents) {
    std::vector<Product> products;
    for (uint32_t joint = 0; joint < parents.size(); ++joint) products.push_back({joint});
    std::vector<uint32_t> ancestors(parents.begin(), parents.end());
    for (uint32_t distance = 1;; distance *= 2) {
        if (distance > 1 && std::ranges::all_of(ancestors, [](uint32_t ancestor) { return ancestor == kNone; }))
            return products;
        flow.phase("round " + std::to_string(std::bit_width(distance)) + ":\n" +
                       (distance == 1 ? "the parent's" : std::to_string(distance) + " above"),
                   distance == 1 ? FlowBoundary::kNothing : FlowBoundary::kBarrier);
        std::vector<Product> next = products;
        for (uint32_t joint = 0; joint < parents.size(); ++joint)
            if (ancestors[joint] != kNone)
                next[joint] = flow.multiply(joint, distance == 1 ? FlowSource::kLocal : FlowSource::kShared,
                                            products[ancestors[joint]], products[joint]);
        products = std::move(next);
        go_twice_as_far(ancestors);
    }
}

}  // namespace throng
