// How far a clip takes the mesh.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

namespace throng {

// Fills the bounds of all clips from the boxes of vertices around each joint (reference/influence_boxes.h), at every
// row and halfway to the next. That bounds what lies between too, except that a joint that turns by a radian between
// rows can bulge out by a hundredth of its reach.
void measure_clips(Character& character, const Progress& progress);

}  // namespace throng
