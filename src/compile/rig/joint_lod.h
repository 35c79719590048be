// Fewer joints for characters far away.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

namespace throng {

// [palette_count]: the palette entry that replaces each one in a level of detail, by Character::joint_lods. If the
// joint of an entry moves in the level, that is the entry itself. Otherwise it is the entry, in the same skin, of the
// nearest joint above that moves; kNone if there is none.
std::vector<uint32_t> entries_of_lod(const Character& character, uint32_t lod);

// Fills joint_lods; call it after the levels of detail are made. In each level joints stop moving as long as that
// displaces no vertex by more than half of the level's error; the largest displacement is added to that error. Measured
// in the rest pose and in at least eight poses of each clip; without clips nothing is known, and joint_lods stay empty.
// Below a joint that does not move, no joint does.
void make_joint_lods(Character& character, const Progress& progress = {});

}  // namespace throng
