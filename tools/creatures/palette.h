// Colours, linear.
#pragma once

#include "tools/creatures/creature_math.h"

#include <functional>

namespace throng::creature {

// The colour at t of a piece's length, 0 … 1, and `across` it: for a tube 1 at the top, -1 below; for a sheet 0 … 1.
using Paint = std::function<Vec(double t, double across)>;

// Hue in turns: red, then green, then blue.
Vec color_of(double hue, double saturation, double value);

Paint plain(const Vec& color);
Paint fading(const Vec& start, const Vec& end);

// A smooth change to the next colour between two places of the length.
struct Change {
    double from, to;
    Vec color;
};
Paint changing(const Vec& start, std::vector<Change> changes);

}  // namespace throng::creature
