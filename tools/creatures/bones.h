// Which joints move a point of a limb, and how much.
#pragma once

#include "tools/creatures/body.h"

namespace throng::creature {

// Joints along a limb and the interval of the outline that each moves; bounds ascend, one more than joints. By default
// the root alone.
struct Bones {
    std::vector<uint32_t> joints{0};
    std::vector<double> bounds{0, 1};
    // If not empty, it takes the place of joints[0]: the limb grows out of flesh that several joints move
    Influences base{};
    double blend = 1;  // the part of a bone over which it gives way to its neighbour, at each of its ends
};

// The joints at t of the outline, with weights that sum to `scale`.
Influences influences_at(const Bones& bones, double t, double scale = 1);

// The joint that the limb hangs from comes first, so that the skin does not tear there.
Bones bones_of(const Chain& chain);
// Bones for a piece that does not bend by itself.
Bones stiff(Influences base);

// Both together; their weights already sum to 1.
Influences joined(Influences a, const Influences& b);
Influences scaled(Influences influences, double scale);

}  // namespace throng::creature
