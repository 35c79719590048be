#include "scan/scan_flow.h"

#include <algorithm>

namespace throng {

void Flow::phase(std::string label, FlowBoundary before) {
    phases.push_back({std::move(label), before});
    taken_.clear();
}

Product Flow::multiply(uint32_t thread, FlowSource source, const Product& left, const Product& right) {
    if (taken_.size() <= thread) taken_.resize(thread + 1);
    Product product = left;
    product.insert(product.end(), right.begin(), right.end());
    steps.push_back({.phase = static_cast<uint32_t>(phases.size() - 1),
                     .row = taken_[thread]++,
                     .thread = thread,
                     .joint = product.back(),
                     .source = left.empty() ? FlowSource::kIdentity : source,
                     .source_joint = left.empty() ? kNone : left.back(),
                     .source_length = static_cast<uint32_t>(left.size()),
                     .product = product});
    return product;
}

void Flow::store(uint32_t thread, uint32_t joint, const Product& product) {
    const auto made = std::find_if(steps.rbegin(), steps.rend(), [&](const FlowStep& step) {
        return step.thread == thread && step.product == product;
    });
    if (made != steps.rend()) made->stored = true;
    model[joint] = product;
    writers[joint] = thread;
}

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
    return static_cast<uint32_t>(std::ranges::count(phases, FlowBoundary::kBarrier, &FlowPhase::before));
}

std::vector<Product> local_products(const ScanRig& rig) {
    std::vector<Product> products;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) products.push_back({joint});
    return products;
}

}  // namespace throng
