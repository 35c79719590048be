// What a scan method does with a skeleton, multiplication by multiplication: a simulation of its algorithm in which a
// transform is the list of joints that it is the product of. The pictures in docs/scan are drawn from it.
#pragma once

#include "scan/scan_rig.h"

#include <string>
#include <string_view>

namespace throng {

using Product = std::vector<uint32_t>;  // joints, the ancestor first: the order of the factors

enum class FlowSource { kLocal, kRegister, kShared, kIdentity };  // where the left factor comes from

struct FlowStep {                 // a multiplication
    uint32_t phase = 0, row = 0;  // row: multiplications of the same thread before it in the phase
    uint32_t thread = 0;
    uint32_t joint = 0;  // where the product ends
    FlowSource source = FlowSource::kLocal;
    uint32_t source_joint = kNone;  // where the left factor ends
    uint32_t source_length = 0;     // factors of the left factor
    Product product;
    bool stored = false;  // it is the joint's model_from_joint
};

enum class FlowBoundary { kNothing, kBarrier, kShuffle };

struct FlowPhase {
    std::string label;
    FlowBoundary before = FlowBoundary::kNothing;
};

// A method's simulation makes one by phase(), multiply() and store().
class Flow {
public:
    explicit Flow(const ScanRig& rig) : model(rig.joint_count()), writers(rig.joint_count(), kNone) {}

    void phase(std::string label, FlowBoundary before = FlowBoundary::kNothing);
    // The thread's next multiplication in this phase: left * right.
    Product multiply(uint32_t thread, FlowSource source, const Product& left, const Product& right);
    // Stores a product of the thread's, or a local transform that needs no multiplication.
    void store(uint32_t thread, uint32_t joint, const Product& product);

    uint32_t rows(uint32_t phase) const;
    uint32_t longest_thread() const;  // the longest of each phase, summed, as ScanCounts has it
    uint32_t barriers() const;

    std::vector<FlowPhase> phases;
    std::vector<FlowStep> steps;
    std::vector<Product> model;     // [joint_count]
    std::vector<uint32_t> writers;  // [joint_count], threads

private:
    std::vector<uint32_t> taken_;  // [thread], multiplications in this phase
};

// [joint_count]: each joint's local transform.
std::vector<Product> local_products(const ScanRig& rig);

struct FlowSettings {
    uint32_t block = 64, stride = 8;  // of blocks64 and compressed
    uint32_t threads = 32;            // of fragments and subgroup
};

// What a method brings for its picture.
struct FlowPicture {
    Flow (*simulate)(const ScanRig& rig, const FlowSettings& settings) = nullptr;  // null: it has none
    std::string_view note;                                                         // what the picture does not say
    bool has_blocks = false;
};

}  // namespace throng
