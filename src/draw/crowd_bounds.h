// Where crowds stand. The picture's ground, fog and shadow map are fitted to this, and so are cameras.
#pragma once

#include "crowd/crowd_state.h"

#include <throng/draw.h>

#include <span>

namespace throng {

// One crowd, or several that are drawn in one picture.
using Crowds = std::span<CrowdState* const>;

// Outliers are the few instances (at most a hundredth of all, or one if there are fewer than a hundred) that stand so
// far away that in a picture fitted to include them all others would be too small to see.
enum class Outliers { kIncluded, kLeftOut };

// World space, from the instances' placements. If no instance is there, everything except `size` is zero.
struct CrowdBounds {
    Bounds rest;   // of their rest poses
    Bounds posed;  // of all their poses as far as culling knows them
    // Where they stand: at the lowest point of their rest poses, or at the origin of their model space where that is a
    // little lower, since a rest pose may float above the floor that the clips walk on.
    float ground = 0;
    float size = 0;  // character_size()
};
// Goes through all instances; what draws a frame calls it once.
CrowdBounds bounds_of(Crowds crowds, Outliers outliers);

// Diagonal of a character's box at rest: in model space, and as placed in the world.
float size_at_rest(const Group& group);
float placed_size(float size_at_rest, const Affine& placement);

// The world size of the largest character that is there; if none is, of the largest character of the crowds. The first
// instance of a batch gives the scale of the whole batch.
float character_size(Crowds crowds);

}  // namespace throng
