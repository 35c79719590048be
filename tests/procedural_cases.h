// A character for rules that move joints.
#pragma once

#include "tests/test_rig.h"

namespace throng::test {

// A straight chain up along +y, a unit a bone, beside a first joint that all hang on.
inline Character chain(uint32_t joint_count) {
    Asset asset = make_asset(
        {.joint_count = joint_count, .shape = RigShape::kChain, .scale_spread = 0, .clip_count = 0});
    Character character = *compile_character(asset);
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        character.rig.names[joint] = "joint " + std::to_string(joint);
        character.rig.rest[joint] = {.translation = {0, joint == 0 ? 0.0f : 1.0f, 0}};
    }
    return character;
}

}  // namespace throng::test
