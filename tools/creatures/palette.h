// Colours, linear.
#pragma once

#include "tools/creatures/creature_math.h"

#include <functional>

namespace throng::creature {

// The colour at t of a piece's length, 0 … 1, and `across` it: of a tube 1 at the top, -1 below; of a sheet 0 … 1.
using Paint = std::function<Vec(double t, double across)>;

// Hue in turns from red over green and blue.
Vec color_of(double hue, double saturation, double value);

Paint plain(const Vec& color);
Paint fading(const Vec& start, const Vec& end);

// An eye looks out of the end of its tube.
Paint eye(const Vec& iris);

}  // namespace throng::creature
