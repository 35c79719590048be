// The bounds of the mesh in each clip.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

namespace throng {

// Fills the bounds of all clips from the boxes of vertices around each joint (reference/influence_boxes.h), at every
// row and halfway to the next. This bounds the poses in between too, with one exception: a joint that turns by a radian
// between rows can leave the bounds by a hundredth of its reach.
void measure_clips(Character& character, const Progress& progress);

}  // namespace throng
