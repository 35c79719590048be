// What a scan method does with a skeleton, multiplication by multiplication: a simulation of its algorithm in which a
// transform is the list of joints that it is the product of. The pictures in docs/scan are drawn from it.
#pragma once

#include "scan/scan_rig.h"

#include <string>
#include <string_view>

namespace throng::bench {

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

enum class FlowBoundary { kNone, kBarrier, kShuffle };

struct FlowPhase {
    std::string label;
    FlowBoundary before = FlowBoundary::kNone;
};

struct Flow {
    std::vector<FlowPhase> phases;
    std::vector<FlowStep> steps;
    std::vector<Product> model;     // [joint_count]
    std::vector<uint32_t> writers;  // [joint_count], threads

    uint32_t rows(uint32_t phase) const;
    uint32_t longest_thread() const;  // the longest of each phase, summed, as ScanCounts has it
    uint32_t barriers() const;
};

struct FlowSettings {
    uint32_t block = 64, stride = 8;  // of blocks64 and compressed
    uint32_t threads = 32;            // of fragments and subgroup
};

struct FlowMethod {
    std::string_view name;
    Flow (*simulate)(const ScanRig& rig, const FlowSettings& settings);
    std::string_view note;  // what the picture does not say itself
    bool has_blocks = false;
};

// A row for each method of the scan table that has a data flow of its own (its variants for other formats and layouts
// share it).
std::span<const FlowMethod> flow_methods();

}  // namespace throng::bench
