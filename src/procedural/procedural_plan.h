// Turns rules into chains of joints with ranks. Chains of the same rank are independent and can be moved in parallel.
#pragma once

#include "base/error_place.h"

#include <throng/character.h>
#include <throng/procedural.h>

#include <cstdint>
#include <vector>

namespace throng {

// Joints moved by one rule; each one is the parent of the next. For a ReachRule: grandparent, parent, joint.
struct PlannedChain {
    uint32_t rule = 0;
    uint32_t rank = 0;
    std::vector<uint32_t> joints;
    std::vector<Vec3<float>> bones;  // [joint], in joint space; zero if it has none
    uint32_t first_generation = 0;   // generations from the rule's joint to the first joint
    uint32_t first_spring = 0;       // for SpringRules: index in an instance's springs
    uint64_t steps = 0;              // loop iterations of an invocation, at most
};

struct ProceduralPlan {
    std::vector<PlannedChain> chains;  // in the order of the rules; after the chains that it branches off
    uint32_t rank_count = 0;
    uint32_t spring_count = 0;
};

// Throws kInvalidArgument for unknown joints and targets and for numbers out of range, kLimit if a rule has more than
// 16 colliders.
ProceduralPlan plan_procedural(const ProceduralRules& rules, const Character& character);

// Checks the arguments of Crowd::set_target(). Throws kInvalidArgument at `place`.
void check_target(uint32_t target, uint32_t target_count, const TargetPlace& value, const ErrorPlace& place);

}  // namespace throng
