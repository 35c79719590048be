// Fewer joints for characters far away.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

namespace throng {

// [palette_count]: the palette entry that stands for each one in a level of detail, by Character::joint_lods: its
// own, or that of the same skin of the nearest joint above that moves in the level; kNone where there is none.
std::vector<uint32_t> entries_of_lod(const Character& character, uint32_t lod);

// Fills joint_lods, after the levels of detail: in each one so few joints move that the others displace no vertex by
// more than half of the level's error, and adds how far they do to that error. Measured in the rest pose and in poses
// of all clips; of a character without clips nothing is known, and joint_lods stay empty. Where a joint does not
// move, nothing below it does.
void make_joint_lods(Character& character, const Progress& progress = {});

}  // namespace throng
