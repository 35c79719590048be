// Machine code as AMD's drivers print it: its instructions by class, in each loop and outside of all.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace throng::bench {

enum class InstructionClass {
    kVector,          // arithmetic of the lanes
    kTranscendental,  // of the lanes too, at a fraction of the rate: roots, reciprocals, sines, logarithms
    kShared,          // shared memory, and exchange between lanes by its unit
    kLoad,
    kStore,
    kScalar,      // arithmetic of the subgroup, and branches
    kMemoryWait,  // until loads have arrived; if several wait for parts of the same loads, only the first
    kSharedWait,  // the same for shared memory and scalar loads; barriers
    kHint,        // takes no time: hints, delays, waits that an earlier wait has covered
};
inline constexpr std::array kInstructionClasses{"vector", "transcendental", "shared",       "loads", "stores",
                                                "scalar", "memory_waits",   "shared_waits", "hints"};

struct InstructionCounts {
    std::array<double, kInstructionClasses.size()> of{};  // whole numbers, unless they are multiplied by trips

    double& operator[](InstructionClass c) { return of[static_cast<size_t>(c)]; }
    double operator[](InstructionClass c) const { return of[static_cast<size_t>(c)]; }
    void add(const InstructionCounts& other, double times = 1);
    double total() const;  // of all classes
};

struct MachineLoop {
    uint32_t depth = 0;       // loops around it
    bool over_lanes = false;  // one trip for each lane: how radv shuffles where the machine does not
    InstructionCounts own;    // without those of loops inside
};

struct MachineCode {
    InstructionCounts outside;       // of all loops
    std::vector<MachineLoop> loops;  // by the place of their first instruction

    InstructionCounts all() const;
};

// A label is a line "BB7:"; an instruction is an indented line; the second word of a branch is a label. A loop reaches
// from a label to the last branch back to it.
MachineCode read_machine_code(std::string_view assembly);

}  // namespace throng::bench
