// Simulates a scan method on a skeleton, multiplication by multiplication. A transform is represented by the list of
// joints whose local transforms it is the product of. The pictures in docs/scan are drawn from it.
#pragma once

#include "scan/scan_rig.h"

#include <string>
#include <string_view>

namespace throng {

using Product = std::vector<uint32_t>;  // joints in the order of the factors, the topmost ancestor first

enum class FlowSource { kLocal, kRegister, kShared, kIdentity };  // where the left factor comes from

struct FlowStep {                 // a multiplication
    uint32_t phase = 0, row = 0;  // row: number of earlier multiplications of this thread in the phase
    uint32_t thread = 0;
    uint32_t joint = 0;  // the last joint of the product
    FlowSource source = FlowSource::kLocal;
    uint32_t source_joint = kNone;  // the last joint of the left factor
    uint32_t source_length = 0;     // number of joints in the left factor
    Product product;
    bool stored = false;  // the product is stored as the joint's model_from_joint
};

enum class FlowBoundary { kNothing, kBarrier, kShuffle };

struct FlowPhase {
    std::string label;
    FlowBoundary before = FlowBoundary::kNothing;
};

// The record of a simulation, which a method builds by phase(), multiply() and store().
class Flow {
public:
    explicit Flow(const ScanRig& rig) : model(rig.joint_count()), writers(rig.joint_count(), kNone) {}

    void phase(std::string label, FlowBoundary before = FlowBoundary::kNothing);
    // The thread's next multiplication in this phase: left * right.
    Product multiply(uint32_t thread, FlowSource source, const Product& left, const Product& right);
    // Stores a product that the thread computed, or a local transform that needs no multiplication.
    void store(uint32_t thread, uint32_t joint, const Product& product);

    uint32_t rows(uint32_t phase) const;
    uint32_t longest_thread() const;  // like ScanCounts::longest_thread
    uint32_t barriers() const;

    std::vector<FlowPhase> phases;
    std::vector<FlowStep> steps;
    std::vector<Product> model;     // [joint_count]
    std::vector<uint32_t> writers;  // [joint_count], thread that stored the joint

private:
    std::vector<uint32_t> taken_;  // [thread], multiplications in this phase
};

// [joint_count]: each joint's local transform.
std::vector<Product> local_products(const ScanRig& rig);

struct FlowSettings {
    uint32_t block = 64, stride = 8;  // of blocks64 and compressed
    uint32_t threads = 32;            // of fragments and subgroup
};

// The data for a method's picture.
struct FlowPicture {
    Flow (*simulate)(const ScanRig& rig, const FlowSettings& settings) = nullptr;  // null: no picture
    std::string_view note;                                                         // what the picture does not show
    bool has_blocks = false;
};

}  // namespace throng
