// What a scan method does for one character, counted exactly on the CPU: why a method is fast or slow.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace throng {

// How often a subgroup runs a loop of the kernel, summed over all times that it reaches it; an average over a
// workgroup's subgroups.
struct LoopTrips {
    std::string_view loop;
    double trips = 0;
};

struct ScanCounts {
    uint64_t multiplications = 0;  // of all invocations
    uint32_t longest_thread = 0;   // multiplications on the critical path: the longest invocation of each phase, summed
    uint32_t barriers = 0;         // of the workgroup
    uint32_t shared_bytes = 0;     // a character
    double issue_steps = 0;        // multiplications that a subgroup issues, idle lanes or not
    // Iterations of the subgroup that has the most, over all its loops; errs on the high side
    uint64_t loop_iterations = 0;
    // The lanes of a subgroup load and store rows that lie a piece or a whole character apart
    bool scattered = false;
    // Lines of the cache are begun by one store and completed by a later one
    bool splits_lines = false;
    // Adjacent joints that are stored at once, if these are not all of a character
    double run_joints = 0;
    // What splits_lines and run_joints add to the memory that a joint moves: the former on an H100, whose subgroups
    // together write more than its cache holds; the latter for each run beyond those of 32 joints, on an H200, where
    // runs of 8 take 1.06 to 1.10 times as long (docs/scan.md)
    double split_bytes() const;
    // 16-byte rows that a subgroup loads or stores, likewise, wherever they lie; a link counts as half a row
    double issue_rows = 0;
    // The loops of scan() and what it calls, in source order; none: not counted. `throng bench isa` finds the
    // instructions of each in machine code.
    std::vector<LoopTrips> loops = {};
};

inline constexpr double kRowsOfAffine = 3, kRowsOfSimilarity = 2, kRowsOfLink = 0.5;

// Adds up phases. A phase hands items (joints, leaves, pieces) to `threads` invocations in strides; items of one stride
// and one subgroup run side by side, as long as the longest of them.
class ScanCounter {
public:
    ScanCounter(uint32_t threads, uint32_t subgroup_size);

    // Trips of a phase, on average over the workgroup's subgroups.
    struct Trips {
        double strides = 0;          // in which some item moves or multiplies anything
        double multiplications = 0;  // of all strides
    };

    // multiplications[item], each with a link followed and an operand loaded; besides, an item moves moves[item]
    // transforms.
    Trips phase(std::span<const uint32_t> multiplications, std::span<const uint32_t> moves);
    Trips phase(std::span<const uint32_t> multiplications, uint32_t fixed_moves);
    void barrier() { ++counts_.barriers; }
    void shared_bytes(uint64_t bytes) { counts_.shared_bytes = static_cast<uint32_t>(bytes); }
    // Add ScanCounts::loops, in the order that these have in the shader.
    void loop(std::string_view name, double trips) { counts_.loops.push_back({name, trips}); }
    void loops(std::string_view strides, std::string_view multiplications, const Trips& trips);
    const ScanCounts& counts() const { return counts_; }

private:
    uint32_t threads_, subgroup_size_;
    std::vector<uint64_t> loop_iterations_;  // [subgroup]
    ScanCounts counts_;
};

}  // namespace throng
