// A plan in the form that the kernel reads (procedural_io.h).
#pragma once

#include "procedural/procedural_plan.h"

namespace throng {

struct ProceduralTables {
    // Chains of one rank and kind. Ranks ascend.
    struct Dispatch {
        uint32_t rank = 0;
        uint32_t kind = 0;
        uint32_t first_chain = 0;  // word
        uint32_t chain_count = 0;
    };
    std::vector<uint32_t> words;
    std::vector<Dispatch> dispatches;
    uint32_t spring_count = 0, target_count = 0;  // per instance
    uint64_t max_steps = 0;                       // loop iterations of the chain that has the most
};

// Throws what plan_procedural() throws.
ProceduralTables make_procedural_tables(const ProceduralRules& rules, const Character& character);

}  // namespace throng
