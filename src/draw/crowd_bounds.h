// Where crowds are: what their picture's ground, fog and shadow map are fitted to, and cameras.
#pragma once

#include "crowd/crowd_state.h"

#include <throng/draw.h>

#include <span>

namespace throng {

// One crowd, or several that are drawn in one picture.
using Crowds = std::span<CrowdState* const>;

// Of whom: all, or all but strays, a hundredth of them at most (one of fewer than a hundred), which stand so far away
// from all others that what is fitted to them would fit nobody else.
enum class Whom { kAll, kAllButStrays };

// World space, by the instances' placements; all zero where nobody is there.
struct CrowdBounds {
    Bounds rest;   // of their rest poses
    Bounds posed;  // of all their poses as far as culling knows them
    // Where they stand: at the lowest point of their rest poses, or at the origin of their model space where that is a
    // little lower, since a rest pose may float above the floor that the clips walk on.
    float ground = 0;
};
CrowdBounds bounds_of(Crowds crowds, Whom whom);

// Of the largest character, as the first of its instances is placed.
float character_size(Crowds crowds);

}  // namespace throng
