// Agents, and the ground they stand on.
#pragma once

#include <throng/index.h>

#include <cstdint>
#include <vector>

namespace throng {

// How instances move as agents over the ground, the plane of world x and z, with y up: they walk to their destinations
// and keep out of each other's way (docs/steering.md). An agent looks and walks along +z of its model space, and stands
// at that space's origin.
struct Steering {
    // World units, 1e-6 to 1e6; two agents do not come nearer to each other than the sum of their radii, or three
    // quarters of it after having been held up
    float radius = 0.3f;
    // World units a second, at most; 0 to 1e6. In one update an agent goes no further than its radius
    float speed = 1.4f;
    float turn = 3;  // radians a second, at most; 0 to 1e6
    // Parameter of the controller that each update sets to the speed at which the agent wants to walk, in units of its
    // model space a second; 0: it stands
    ParameterIndex speed_parameter = kNone;
};

// Heights of the ground over a grid of points, bilinear between them; beyond the edges, the height of the nearest
// point.
struct Terrain {
    float x = 0, z = 0;              // of the first point, world space; finite
    float spacing = 1;               // of neighbouring points along x and z, world units; above 0, finite
    uint32_t columns = 0, rows = 0;  // points along x, along z; at least 1 each
    std::vector<float> heights{};    // [rows][columns], world y; finite
};

}  // namespace throng
