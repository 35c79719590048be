// Which joints move a point of a limb, and how much.
#pragma once

#include "tools/creatures/body.h"

namespace throng::creature {

// Joints along a limb, and the interval of the outline that each moves. The bounds ascend; there is one more of them
// than joints. By default the root moves everything.
struct Bones {
    std::vector<uint32_t> joints{0};
    std::vector<double> bounds{0, 1};
    // If not empty, takes the place of joints[0]: the limb grows out of flesh that several joints move
    Influences base{};
    double blend = 1;  // the part of a bone, at each of its ends, in which its neighbour's weight sets in
};

// The joints at t of the outline, with weights that sum to `scale`.
Influences influences_at(const Bones& bones, double t, double scale = 1);

// The joint that the limb hangs from comes first, so that the skin does not tear there.
Bones bones_of(const Chain& chain);
// Bones for a piece that does not bend by itself.
Bones stiff(Influences base);

// All influences of both, whose weights together already sum to 1.
Influences joined(Influences a, const Influences& b);
Influences scaled(Influences influences, double scale);

}  // namespace throng::creature
