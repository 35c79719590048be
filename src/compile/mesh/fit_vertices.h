// Moves the vertices of a level of detail closer to the fine mesh.
#pragma once

#include "base/progress.h"
#include "compile/mesh/coarse_mesh.h"

namespace throng {

struct FittedLevel {
    CoarseMesh mesh;
    float error = 0;     // the largest distance between the surfaces in any pose, model space
    uint64_t steps = 0;  // of the searches that measured it
};

// An edge collapse leaves a surface that touches the fine one at its vertices and is off on one side between them;
// where the fine one is round, that is the inside. Moving the vertices by half of that, to the other side, halves the
// error. Moves all points along the weighted mean of what they are off by, with weights so high a power of the distance
// that the largest one counts. Keeps the vertices where they are if they are close enough, or if this gains little.
FittedLevel fit_vertices(CoarseMesh mesh, const Progress& progress);

}  // namespace throng
