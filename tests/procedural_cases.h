// A character for procedural rules, and queries about its pose.
#pragma once

#include "procedural/procedural_reference.h"
#include "reference/reference.h"
#include "tests/test_rig.h"

#include <string>
#include <vector>

namespace throng::test {

using Locals = std::vector<Trs<double>>;  // parent_from_joint[joint_count]

// A straight chain along +y, one unit per bone, beside a first joint that is the parent of all.
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

inline Locals rest_of(const Character& character) {
    Locals local;
    for (const Trs<float>& rest : character.rig.rest) local.push_back(rest.as<double>());
    return local;
}

// The position of a joint in model space.
inline Vec3<double> place_of(const Character& character, const Locals& local, uint32_t joint) {
    return transform_point(pose_from_local(character, local).model_from_joint[joint], {});
}

// The wind's state after `at_s` seconds.
inline WindClock::Moment blowing(const Wind& wind, double at_s = 0) {
    WindClock clock;
    clock.set(wind);
    clock.advance(at_s);
    return clock.moment();
}

}  // namespace throng::test
