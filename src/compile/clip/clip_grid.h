// The exact tracks of a clip on a grid of times: its rows, and rows added where linear interpolation would not follow
// the arcs of rotations. The error of a packed clip is measured at the rows and at points between them.
#pragma once

#include "compile/clip/exact_clip.h"

namespace throng {

// Whether no float lies between the times of two rows, so that no time between them is ever shown. The importer writes
// keys of equal times this way.
bool is_jump(float from_s, float to_s);

struct ClipGrid {
    const ExactClip& clip;
    std::vector<float> times_s{};      // [row_count]
    std::vector<bool> fixed{};         // [row_count], rows where a STEP track changes
    uint32_t points_per_row = 1;       // from one row to the next; point p is at or after row p / points_per_row
    std::vector<ExactTrack> tracks{};  // that vary, at these times; rotations of unit length
    std::vector<Trs<double>> still{};  // [joint_count], of the tracks that do not vary

    size_t row_count() const { return times_s.size(); }
    size_t point_count() const { return (row_count() - 1) * points_per_row + 1; }
    double time_s(size_t point) const;
    bool jumps_after(size_t row) const { return is_jump(times_s[row], times_s[row + 1]); }
};

// The index of a track in arrays [joint_count][3], in the order of TrackTarget.
inline size_t slot_of(const ExactTrack& track) { return track.joint * size_t{3} + static_cast<size_t>(track.target); }

struct GridSettings {
    double bound = 0;  // the displacement in model space that linear interpolation of arcs may cause
    // The limit of rows * joints (at most 192 MB of values); ignored if the clip's own rows are more
    uint64_t joint_rows = 4'000'000;
};

// Keeps a reference to the clip. `reaches[joint_count]`: how far in model space a rotation of the joint by 1 rad moves
// a point at most.
ClipGrid make_clip_grid(const ExactClip& clip, const Rig& rig, std::span<const double> reaches,
                        const GridSettings& settings);

}  // namespace throng
