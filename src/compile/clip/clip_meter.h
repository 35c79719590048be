// How far the skin is displaced when a clip is read from fewer rows, or from quantised ones.
#pragma once

#include "base/progress.h"
#include "compile/clip/clip_grid.h"
#include "reference/influence_boxes.h"

namespace throng {

// Keeps references. Polls `progress` at each point that it looks at. Between two rows it does what the sample stage
// does: interpolates linearly, then normalises rotations.
class ClipMeter {
public:
    ClipMeter(const Character& character, const ClipGrid& grid, std::span<const Box> boxes, const Progress& progress);

    // [joint_count], model_from_joint of the exact tracks at a point of the grid.
    std::span<const AffineT<double>> exact(size_t point);

    // The rows to keep so that those between are reproduced within a displacement of `bound`. Greedy: from each kept
    // row it goes as far as it can.
    std::vector<size_t> keep_rows(double bound);

    // Sets a joint's model transform from its local one and its parent's model transform. Returns how far this
    // displaces its skin from where `wanted` would put it.
    double place(size_t joint, const Trs<double>& parent_from_joint, std::span<const AffineT<double>> wanted);
    const AffineT<double>& model_from_joint(size_t joint) const { return models_[joint]; }

    // Tracks with a key in each row, and the pose of everything else.
    struct Rows {
        std::span<const size_t> of_grid;        // [row_count]: rows of the grid
        std::span<const ExactTrack> tracks;     // with keys [row_count]; a track without keys stays as in `still`
        const std::vector<Trs<double>>& still;  // [joint_count]
    };
    // Largest displacement at the points between rows, looking at every `interval`-th pair of rows. May stop once it is
    // above `enough`.
    double largest_between(const Rows& rows, size_t interval, double enough);

    // [joint_count]: the largest that place() has returned since reset_peaks().
    const std::vector<double>& peaks() const { return peaks_; }
    void reset_peaks() { peaks_.assign(peaks_.size(), 0); }

private:
    std::span<const AffineT<double>> compute_exact(size_t point);
    bool reproduces(size_t from_row, size_t to_row, double bound);
    void mix(std::span<const ExactTrack> tracks, size_t earlier, size_t later, double fraction);
    double fraction(size_t from_row, size_t to_row, size_t point) const;

    const Character& character_;
    const ClipGrid& grid_;
    std::span<const Box> boxes_;
    const Progress& progress_;
    std::vector<AffineT<double>> cache_;  // [point][joint_count]; empty if that would be too much
    std::vector<AffineT<double>> models_, exact_models_;
    std::vector<Trs<double>> pose_, exact_pose_;
    std::vector<double> peaks_;
};

}  // namespace throng
