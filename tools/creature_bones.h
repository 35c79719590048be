// Which joints move a point of a limb, and how much.
#pragma once

#include "creature_body.h"

#include <vector>

namespace throng::creature {

struct Influence {
    uint32_t joint;
    double weight;
};
using Influences = std::vector<Influence>;

// Joints along a limb and the interval of the outline that each moves; bounds ascend, one more than joints.
struct Bones {
    std::vector<uint32_t> joints;
    std::vector<double> bounds;
    Influences base;  // where not empty, it stands for joints[0]: the limb grows out of flesh that several joints move
};

// The joints at t of the outline, with weights that sum to `scale`.
Influences influences_at(const Bones& bones, double t, double scale = 1);

Bones bones_of_axis(const Body& body);
// The joint that the limb hangs from comes first, so that the skin does not tear there.
Bones bones_of_limb(const Chain& chain, const Bones& axis);

}  // namespace throng::creature
