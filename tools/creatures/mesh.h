// Flesh on bones: tubes along limbs, sheets of skin or cloth, leaves.
#pragma once

#include "tools/creatures/bones.h"
#include "tools/creatures/palette.h"

#include <variant>

namespace throng::creature {

// A limb's skin: rings of `sides` vertices, the ends drawn together to a point; the start open where it is inside
// another piece.
struct Tube {
    Outline outline;
    double from = 0, to = 1;  // the part of the outline that it covers
    Bones bones;
    Vec up{0, 1, 0};
    Paint paint;
    bool open_start = true;
    double wanted_sides = 3, wanted_segments = 1;  // at the kind's usual number of faces
    uint32_t least_sides = 3, least_segments = 1;
    uint32_t segments_per_step = 1;  // segments come in multiples of it
    bool segments_fixed = false;     // its rings meet another piece's edge
    uint32_t sides = 0, segments = 0;
};

struct SkinPoint {
    Vec position;
    Influences influences;
};

// A single layer of skin or cloth: (u, v) in 0 … 1.
struct Sheet {
    std::function<SkinPoint(double u, double v)> at;
    Paint paint;            // of u and v
    bool mirrored = false;  // its outside is where u × v points away from
    double wanted_along = 1, wanted_across = 1;
    uint32_t least_along = 1, least_across = 1;
    uint32_t across_per_step = 1;
    uint32_t along = 0, across = 0;
};

// A diamond from `base` to `base + along`, `across` to each side, lit as if it faced along `normal`: leaves on their
// own would glitter, lit like the crown that they are part of they give it a shape.
struct Leaf {
    Vec base, along, across, normal, color;
    Influences influences;
};
struct Leaves {
    std::function<Leaf(uint32_t index, uint32_t count)> at;
    double wanted_count = 1;
    uint32_t count = 0;
};

using Piece = std::variant<Tube, Sheet, Leaves>;

// Most important pieces first: what does not fit is left out from the end. About `face_count` triangles.
AssetMesh make_mesh(std::vector<Piece> pieces, uint32_t face_count);

}  // namespace throng::creature
