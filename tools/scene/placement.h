// Where characters stand on the ground; the same for the same random numbers everywhere.
#pragma once

#include "tools/creatures/creature_math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace throng::tools {

enum class Formation {
    kGrid,    // square, row by row
    kDisc,    // a sunflower's seeds, facing outwards
    kPath,    // in lanes along a closed curve, facing along it
    kRandom,  // anywhere within about a disc, but apart
};

// Characters that need the same room: `pitch` is the diameter of the ground that one takes, world units.
struct PlacementKind {
    uint32_t count = 0;
    double pitch = 1;
};

// World space; a heading of 0 looks along +z, a quarter turn along +x.
struct Place {
    double x = 0, z = 0;
    double heading_turns = 0;
};

// Places around the origin, [sum of counts], kinds one after the other but mixed on the ground. Two are at least half
// the sum of their pitches apart. Kinds that need more room are placed first, at random over the whole formation; the
// others fill what is left. At most about 1 s for 100,000. Throws CommandError if their area is not finite.
std::vector<Place> place(Formation formation, std::span<const PlacementKind> kinds, creature::Random& random);

// How far a character can leave its place without spoiling the formation: either way along x and z, in pitches, and how
// far it can turn.
struct Freedom {
    double shift = 0, turn_rad = 0;
};
Freedom freedom(Formation formation);

}  // namespace throng::tools
