// The dragon: a long axis from the snout to the tip of the tail, four legs, two wings, tendrils.
#pragma once

#include "tools/creatures/bones.h"
#include "tools/creatures/model.h"

namespace throng::creature {

// Where a wing's membrane meets the body.
struct Flank {
    Vec shoulder, hip;
};

// The axis goes from the snout at 0 to the tip of the tail at 1. The root joint stands on it, at the hips; the trunk
// goes from there forward to the head, the tail backward. A creature with no joints left for a trunk is a snake: its
// root is its head.
struct Dragon {
    Body body;  // the tail and the trunk (either may be missing) come first
    Outline axis;
    Bones axis_bones;
    Flank left_flank, right_flank;
};

Dragon make_dragon_body(const CreatureSettings& settings);
std::vector<Piece> make_dragon_flesh(const Dragon& dragon, const CreatureSettings& settings);

}  // namespace throng::creature
