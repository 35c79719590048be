// What the packed form of a track depends on: the range of its values, and how far an error of each component moves the
// skin.
#pragma once

#include "compile/clip/clip_grid.h"
#include "reference/influence_boxes.h"

#include <vector>

namespace throng {

// A track over the rows that are kept.
struct TrackShape {
    TrackTarget target = TrackTarget::kTranslation;
    bool step = false;
    bool full = false;                    // a rotation whose components all get near 0 or change their sign
    uint32_t left_out = 3;                // of a rotation; `low` and `high` are for its positive sign
    TrackKey rest{};                      // the value of the rest pose
    TrackValue first{};                   // the first value of the track
    std::array<double, 3> low{}, high{};  // of the components that are stored
    // The largest difference between the track's components and those of `rest`
    std::array<double, 3> rest_deviation{};
    // Displacement of the skin per unit of a component, in the unit of the character
    std::array<double, 3> sensitivity{};

    bool varies() const { return low != high; }
};

// [joint_count][3], in the order of TrackTarget. `rows` are those of the grid that are kept.
std::vector<TrackShape> track_shapes(const Character& character, const ClipGrid& grid, std::span<const size_t> rows);

// Raises `sensitivity` to its value in a pose. Call it for several poses to get the largest. An error of a joint's
// rotation moves its own skin and the joints below it. What is below one of these joints counts only if that joint's
// own rotation moves the skin by less than `bound`. Otherwise its rotation makes up for the error (RowEncoder::aim).
void add_sensitivity(std::vector<TrackShape>& shapes, const Character& character, std::span<const Box> boxes,
                     std::span<const Trs<double>> pose, double bound);

// [joint_count]: the furthest that rotating the joint by 1 rad, or raising its scale by 1, moves any point below it.
std::vector<double> joint_reaches(const Character& character, std::span<const Box> boxes,
                                  std::span<const Trs<double>> pose);

// The header of the track, planned so that quantising displaces the skin by about `tolerance`; 0: as fine as the format
// can.
PackedTrack plan_track(const TrackShape& shape, double tolerance);

}  // namespace throng
