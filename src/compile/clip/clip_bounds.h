// How far a clip takes the mesh.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

namespace throng {

// Fills the bounds of all clips, by the boxes of vertices around each joint (reference/influence_boxes.h): at every
// row and halfway to the next, which bounds what lies between but for what a joint that turns by a radian between rows
// bulges out, a hundredth of its reach.
void measure_clips(Character& character, const Progress& progress);

}  // namespace throng
