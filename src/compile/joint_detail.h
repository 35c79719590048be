// Fewer joints for characters far away.
#pragma once

#include <throng/character.h>

namespace throng {

// [palette_count]: the palette entry that stands for each one in a level of detail, by Character::joint_details: its own, or that of the same skin of the nearest joint above that moves in the level; kNone where there is none.
std::vector<uint32_t> entries_of_detail(const Character& character, uint32_t detail);

// Fills joint_details, after the levels of detail: in each one as few joints move as keep all that lies around the others (compile/influence_boxes.h) within the level's error of where it is with all of
// them, in poses of all clips. Where a joint does not move, nothing below it does.
void make_joint_details(Character& character);

}  // namespace throng
