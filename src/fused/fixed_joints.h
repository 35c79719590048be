// Finds joints that only rotate.
#pragma once

#include <throng/character.h>

#include <vector>

namespace throng {

// [joint_count]: whether translation and scale equal the rest pose's in every clip.
std::vector<bool> fixed_joints(const Character& character);

}  // namespace throng
