// Exact counts, made on the CPU, of the work of a scan method for one character. They explain why a method is fast or
// slow.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace throng {

// The number of iterations of a loop of the kernel, summed over all times that a subgroup reaches the loop, and
// averaged over the workgroup's subgroups.
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
    // Iterations over all loops, of the subgroup that has the most; errs on the high side, except that the loops over
    // slots on software devices (scan/slots.glsl) are not counted
    uint64_t loop_iterations = 0;
    // Whether the lanes of a subgroup load and store rows that lie a piece or a whole character apart
    bool scattered = false;
    // Whether cache lines are partly written by one store and completed by a later one
    bool splits_lines = false;
    // Number of adjacent joints that are stored at once; 0: all of a character
    double run_joints = 0;
    // Extra memory traffic per joint due to splits_lines and run_joints. The former was measured on an H100, whose
    // subgroups together write more than its cache holds. The latter counts for runs shorter than 32 joints and was
    // measured on an H200, where runs of 8 joints take 1.06 to 1.10 times as long (docs/scan.md)
    double split_bytes() const;
    // 16-byte rows that a subgroup loads or stores, idle lanes or not, in any memory; a link counts as half a row
    double issue_rows = 0;
    // The loops of scan() and the functions it calls, in source order; empty: not counted. `throng bench isa` finds
    // the instructions of each loop in machine code.
    std::vector<LoopTrips> loops = {};
};

inline constexpr double kRowsOfAffine = 3, kRowsOfSimilarity = 2, kRowsOfLink = 0.5;

// Sums the counts of phases. A phase distributes items (joints, leaves, pieces) over `threads` invocations in strides.
// Items of the same stride and subgroup run in parallel, and take as long as the longest of them.
class ScanCounter {
public:
    ScanCounter(uint32_t threads, uint32_t subgroup_size);

    // Loop trips of a phase, averaged over the workgroup's subgroups.
    struct Trips {
        double strides = 0;          // strides in which some item moves or multiplies a transform
        double multiplications = 0;  // in all strides
    };

    // Adds a phase. Each of an item's multiplications[item] follows a link and loads an operand. Besides, the item
    // loads or stores moves[item] transforms.
    Trips phase(std::span<const uint32_t> multiplications, std::span<const uint32_t> moves);
    Trips phase(std::span<const uint32_t> multiplications, uint32_t fixed_moves);
    void barrier() { ++counts_.barriers; }
    void shared_bytes(uint64_t bytes) { counts_.shared_bytes = static_cast<uint32_t>(bytes); }
    // Append to ScanCounts::loops. Call them in the order of the loops in the shader.
    void loop(std::string_view name, double trips) { counts_.loops.push_back({name, trips}); }
    void loops(std::string_view strides, std::string_view multiplications, const Trips& trips);
    const ScanCounts& counts() const { return counts_; }

private:
    uint32_t threads_, subgroup_size_;
    std::vector<uint64_t> loop_iterations_;  // [subgroup]
    ScanCounts counts_;
};

}  // namespace throng
