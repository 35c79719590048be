#include "bench/diagrams/flow.h"

#include "scan/pieces.h"

#include <algorithm>
#include <array>
#include <bit>

namespace throng::bench {
namespace {

class Simulation {
public:
    explicit Simulation(const ScanRig& rig) {
        flow_.model.resize(rig.joint_count());
        flow_.writers.resize(rig.joint_count(), kNone);
    }

    void phase(std::string label, FlowBoundary before = FlowBoundary::kNone) {
        flow_.phases.push_back({std::move(label), before});
        taken_.clear();
    }

    // The thread's next multiplication in this phase: left * right.
    Product multiply(uint32_t thread, FlowSource source, const Product& left, const Product& right) {
        if (taken_.size() <= thread) taken_.resize(thread + 1);
        Product product = left;
        product.insert(product.end(), right.begin(), right.end());
        flow_.steps.push_back({.phase = static_cast<uint32_t>(flow_.phases.size() - 1),
                               .row = taken_[thread]++,
                               .thread = thread,
                               .joint = product.back(),
                               .source = left.empty() ? FlowSource::kIdentity : source,
                               .source_joint = left.empty() ? kNone : left.back(),
                               .source_length = static_cast<uint32_t>(left.size()),
                               .product = product});
        return product;
    }

    // A product of the thread's, or a local transform that needs no multiplication.
    void store(uint32_t thread, uint32_t joint, const Product& product) {
        const auto made = std::find_if(flow_.steps.rbegin(), flow_.steps.rend(),
                                       [&](const FlowStep& s) { return s.thread == thread && s.product == product; });
        if (made != flow_.steps.rend()) made->stored = true;
        flow_.model[joint] = product;
        flow_.writers[joint] = thread;
    }

    Flow take() { return std::move(flow_); }

private:
    Flow flow_;
    std::vector<uint32_t> taken_;  // [thread], multiplications in this phase
};

std::vector<Product> locals(const ScanRig& rig) {
    std::vector<Product> out;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) out.push_back({joint});
    return out;
}

// From the first joint of the chain down to `joint`.
Product chain(std::span<const uint32_t> parents, uint32_t joint) {
    Product out;
    for (; joint != kNone; joint = parents[joint]) out.push_back(joint);
    std::reverse(out.begin(), out.end());
    return out;
}

Flow gateau2012_walk(const ScanRig& rig, const FlowSettings&) {
    Simulation run(rig);
    run.phase("each joint walks\nup to the root");
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        Product product{joint};
        for (uint32_t ancestor = rig.parents[joint]; ancestor != kNone; ancestor = rig.parents[ancestor])
            product = run.multiply(joint, FlowSource::kLocal, {ancestor}, product);
        run.store(joint, joint, product);
    }
    return run.take();
}

Flow kandar2024_leaves(const ScanRig& rig, const FlowSettings&) {
    std::vector<bool> has_child(rig.joint_count()), owned(rig.joint_count());
    for (const uint32_t parent : rig.parents)
        if (parent != kNone) has_child[parent] = true;
    Simulation run(rig);
    run.phase("each leaf comes\ndown from the root");
    uint32_t thread = 0;
    for (uint32_t leaf = 0; leaf < rig.joint_count(); ++leaf) {
        if (has_child[leaf]) continue;
        Product product;
        for (const uint32_t joint : chain(rig.parents, leaf)) {
            product = product.empty() ? Product{joint} : run.multiply(thread, FlowSource::kRegister, product, {joint});
            if (owned[joint]) continue;
            owned[joint] = true;
            run.store(thread, joint, product);
        }
        ++thread;
    }
    return run.take();
}

// Doubling over chains that may be cut; a barrier between two rounds.
std::vector<Product> run_doubling(Simulation& run, const std::vector<uint32_t>& parents) {
    std::vector<Product> products;
    for (uint32_t joint = 0; joint < parents.size(); ++joint) products.push_back({joint});
    std::vector<uint32_t> ancestors = parents;
    for (uint32_t distance = 1;; distance *= 2) {
        if (distance > 1 && std::all_of(ancestors.begin(), ancestors.end(), [](uint32_t a) { return a == kNone; }))
            return products;
        run.phase("round " + std::to_string(std::bit_width(distance)) + ":\n" +
                      (distance == 1 ? "the parent's" : std::to_string(distance) + " above"),
                  distance == 1 ? FlowBoundary::kNone : FlowBoundary::kBarrier);
        std::vector<Product> next = products;
        std::vector<uint32_t> next_ancestors = ancestors;
        for (uint32_t joint = 0; joint < parents.size(); ++joint) {
            const uint32_t ancestor = ancestors[joint];
            if (ancestor == kNone) continue;
            next[joint] = run.multiply(joint, distance == 1 ? FlowSource::kLocal : FlowSource::kShared,
                                       products[ancestor], products[joint]);
            next_ancestors[joint] = ancestors[ancestor];
        }
        products = std::move(next);
        ancestors = std::move(next_ancestors);
    }
}

Flow doubling(const ScanRig& rig, const FlowSettings&) {
    Simulation run(rig);
    const std::vector<Product> products = run_doubling(run, rig.parents);
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) run.store(joint, joint, products[joint]);
    return run.take();
}

// The parent where it lies in the joint's block; the first ancestor that does not.
struct Blocks {
    std::vector<uint32_t> inside, outside;
};

Blocks blocks_of(const ScanRig& rig, uint32_t block) {
    Blocks out;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        const uint32_t parent = rig.parents[joint];
        const bool stays = parent != kNone && parent / block == joint / block;
        out.inside.push_back(stays ? parent : kNone);
        out.outside.push_back(stays ? out.outside[parent] : parent);
    }
    return out;
}

void run_hops(Simulation& run, const Blocks& blocks, const std::vector<Product>& products) {
    run.phase("hops from\nblock to block", FlowBoundary::kBarrier);
    for (uint32_t joint = 0; joint < products.size(); ++joint) {
        Product product = products[joint];
        for (uint32_t ancestor = blocks.outside[joint]; ancestor != kNone; ancestor = blocks.outside[ancestor])
            product = run.multiply(joint, FlowSource::kShared, products[ancestor], product);
        run.store(joint, joint, product);
    }
}

Flow blocks64(const ScanRig& rig, const FlowSettings& settings) {
    Simulation run(rig);
    const Blocks blocks = blocks_of(rig, settings.block);
    run_hops(run, blocks, run_doubling(run, blocks.inside));
    return run.take();
}

Flow compressed(const ScanRig& rig, const FlowSettings& settings) {
    Simulation run(rig);
    const Blocks blocks = blocks_of(rig, settings.block);
    std::vector<Product> strides = locals(rig);
    run.phase("nearest " + std::to_string(settings.stride - 1) + "\nin the block");
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        uint32_t ancestor = blocks.inside[joint];
        for (uint32_t i = 1; i < settings.stride && ancestor != kNone; ++i, ancestor = blocks.inside[ancestor])
            strides[joint] = run.multiply(joint, FlowSource::kLocal, {ancestor}, strides[joint]);
    }
    run.phase("strides of " + std::to_string(settings.stride) + "\nin the block", FlowBoundary::kBarrier);
    std::vector<Product> products = strides;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
        while (blocks.inside[products[joint].front()] != kNone)
            products[joint] = run.multiply(joint, FlowSource::kShared, strides[blocks.inside[products[joint].front()]],
                                           products[joint]);
    run_hops(run, blocks, products);
    return run.take();
}

Flow levels(const ScanRig& rig, const FlowSettings&) {
    std::vector<bool> has_child(rig.joint_count());
    for (const uint32_t parent : rig.parents)
        if (parent != kNone) has_child[parent] = true;
    Simulation run(rig);
    std::vector<Product> products = locals(rig);
    for (uint32_t depth = 1; depth <= rig.level_count; ++depth) {
        run.phase("level " + std::to_string(depth), depth == 1 ? FlowBoundary::kNone : FlowBoundary::kBarrier);
        uint32_t thread = 0;
        for (const bool with_children : {true, false})
            for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
                if (rig.depths[joint] != depth || has_child[joint] != with_children) continue;
                if (depth > 1)
                    products[joint] = run.multiply(thread, FlowSource::kShared, products[rig.parents[joint]],
                                                   products[joint]);
                run.store(thread++, joint, products[joint]);
            }
    }
    return run.take();
}

Flow serial(const ScanRig& rig, const FlowSettings&) {
    Simulation run(rig);
    std::vector<Product> products = locals(rig);
    run.phase("one thread,\njoint after joint");
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        const uint32_t parent = rig.parents[joint];
        const bool in_register = parent + 1 == joint;  // a run of joints goes on
        if (parent != kNone)
            products[joint] = run.multiply(0, in_register ? FlowSource::kRegister : FlowSource::kShared,
                                           products[parent], products[joint]);
        run.store(0, joint, products[joint]);
    }
    return run.take();
}

Flow pieces(const ScanRig& rig, uint32_t threads, FlowBoundary between_rounds) {
    const PieceCut cut = cut_into_pieces(rig, threads);
    const auto piece_count = static_cast<uint32_t>(cut.pieces.size());
    Simulation run(rig);
    run.phase("paths from piece\nto piece");
    std::vector<Product> prefixes(piece_count);
    std::vector<uint32_t> above(piece_count, kNone);
    for (uint32_t p = 0; p < piece_count; ++p) {
        const uint32_t attachment = cut.pieces[p].attachment;
        if (attachment == kNone) continue;
        const uint32_t piece_above = cut.piece_of_joint[attachment];
        // Above the root's piece there is nothing
        if (cut.pieces[piece_above].attachment != kNone) above[p] = piece_above;
        for (const uint32_t joint : chain(rig.parents, attachment)) {
            if (cut.piece_of_joint[joint] != piece_above) continue;
            prefixes[p] = prefixes[p].empty() ? Product{joint}
                                              : run.multiply(p, FlowSource::kRegister, prefixes[p], {joint});
        }
    }
    for (uint32_t round = 1; std::any_of(above.begin(), above.end(), [](uint32_t a) { return a != kNone; }); ++round) {
        run.phase("small scan over\nthe pieces" + (round > 1 ? ", " + std::to_string(round) : std::string()),
                  between_rounds);
        std::vector<Product> next = prefixes;
        std::vector<uint32_t> next_above = above;
        for (uint32_t p = 0; p < piece_count; ++p) {
            if (above[p] == kNone) continue;
            next[p] = run.multiply(p, FlowSource::kShared, prefixes[above[p]], prefixes[p]);
            next_above[p] = above[above[p]];
        }
        prefixes = std::move(next);
        above = std::move(next_above);
    }
    run.phase("each piece\non its own");
    std::vector<Product> products(rig.joint_count());
    for (uint32_t p = 0; p < piece_count; ++p) {
        uint32_t last = cut.pieces[p].attachment;
        for (const uint32_t joint : cut.pieces[p].joints) {
            const uint32_t parent = rig.parents[joint];
            const bool from_prefix = parent == cut.pieces[p].attachment;
            products[joint] = run.multiply(p,
                                           from_prefix || parent == last ? FlowSource::kRegister : FlowSource::kShared,
                                           from_prefix ? prefixes[p] : products[parent], {joint});
            run.store(p, joint, products[joint]);
            last = joint;
        }
    }
    return run.take();
}

Flow fragments(const ScanRig& rig, const FlowSettings& settings) {
    return pieces(rig, settings.threads, FlowBoundary::kBarrier);
}
Flow subgroup(const ScanRig& rig, const FlowSettings& settings) {
    return pieces(rig, settings.threads, FlowBoundary::kShuffle);
}

constexpr std::array kMethods{
    FlowMethod{"gateau2012_walk", gateau2012_walk, "Every joint multiplies the whole chain above it again."},
    FlowMethod{"kandar2024_leaves", kandar2024_leaves,
               "Stacked: threads that make the same product at the same time. The outlined one stores it:\na joint "
               "belongs to the first leaf below it."},
    FlowMethod{"doubling", doubling, "A product covers twice as many joints after each round."},
    FlowMethod{"blocks64", blocks64, "Drawn with blocks of 8 joints; the method has blocks of 64.", true},
    FlowMethod{"compressed", compressed,
               "Drawn with blocks of 8 joints and strides of 3; the method has blocks of 64 and strides of 8.", true},
    FlowMethod{"levels", levels,
               "A thread for each joint of the widest level; in the other levels some have nothing to do."},
    FlowMethod{"serial", serial,
               "One thread for the whole character; the threads beside it have characters of their own."},
    FlowMethod{"fragments", fragments,
               "Drawn with 4 pieces; the method has 16 to 256. A piece's path runs through the piece above it,\n"
               "down to the joint that it hangs from. ×1: nothing lies above a root."},
    FlowMethod{"subgroup", subgroup,
               "As fragments, with the lanes of a subgroup for threads and shuffles for barriers. Drawn with 4 lanes.\n"
               "×1: nothing lies above a root."},
};

}  // namespace

uint32_t Flow::rows(uint32_t phase) const {
    uint32_t count = 0;
    for (const FlowStep& step : steps)
        if (step.phase == phase) count = std::max(count, step.row + 1);
    return count;
}

uint32_t Flow::longest_thread() const {
    uint32_t sum = 0;
    for (uint32_t phase = 0; phase < phases.size(); ++phase) sum += rows(phase);
    return sum;
}

uint32_t Flow::barriers() const {
    return static_cast<uint32_t>(std::count_if(phases.begin(), phases.end(),
                                               [](const FlowPhase& p) { return p.before == FlowBoundary::kBarrier; }));
}

std::span<const FlowMethod> flow_methods() { return kMethods; }

}  // namespace throng::bench
