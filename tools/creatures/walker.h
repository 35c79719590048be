// The walker: a person with a cloak and long hair.
#pragma once

#include "tools/creatures/model.h"

namespace throng::creature {

// Places on the spine's outline, which goes from the hips to the crown.
constexpr double kHipsAt = 2.0 / 13, kChestAt = 6.0 / 13, kHeadAt = 9.5 / 13;
constexpr Vec kBehind{0, 0, -1};  // "up" along the spine

Body make_walker_body(const CreatureSettings& settings);
std::vector<Piece> make_walker_flesh(const Body& body, const CreatureSettings& settings);

}  // namespace throng::creature
