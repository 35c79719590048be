// Rules as chains of joints, in ranks: chains of one rank are independent of each other and can be moved side by side.
#pragma once

#include "base/error_place.h"

#include <throng/character.h>
#include <throng/procedural.h>

#include <cstdint>
#include <vector>

namespace throng {

// Joints each of which is the parent of the next, moved by one rule. Of a ReachRule: grandparent, parent, joint.
struct PlannedChain {
    uint32_t rule = 0;
    uint32_t rank = 0;
    std::vector<uint32_t> joints;
    std::vector<Vec3<float>> bones;  // [joint], space of the joint; zero where it has none
    uint32_t first_generation = 0;   // of the first joint below the rule's
    uint32_t first_spring = 0;       // of SpringRules, in an instance's springs
    uint64_t steps = 0;              // rounds of loops that an invocation goes, at most
};

struct ProceduralPlan {
    std::vector<PlannedChain> chains;  // in the order of the rules; a chain comes after those that it hangs on
    uint32_t rank_count = 0;
    uint32_t spring_count = 0;
};

// Throws kInvalidArgument for joints and targets that are not there and numbers out of range, kLimit for more than 16
// colliders of a rule.
ProceduralPlan plan_procedural(const ProceduralRules& rules, const Character& character);

// Checks what Crowd::set_target() is given. Throws kInvalidArgument at `place`.
void check_target(uint32_t target, uint32_t target_count, const TargetPlace& value, const ErrorPlace& place);

}  // namespace throng
