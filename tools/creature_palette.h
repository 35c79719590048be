// The creature's colours.
#pragma once

#include "creature_math.h"

namespace throng::creature {

enum class Paint { kBody, kJaw, kLeg, kWing, kFinger, kClaw, kHorn, kEye, kTendril };

// Linear colours that go together, by the seed.
class Palette {
public:
    explicit Palette(uint64_t seed);
    // t along the piece, 0 … 1; dorsal 1 at the top, -1 below.
    Vec at(Paint paint, double t, double dorsal) const;

private:
    Vec back_, stripe_, flank_, belly_, accent_, membrane_, horn_, eye_;
};

}  // namespace throng::creature
