#include "compile/clip/clip_meter.h"

#include <algorithm>

namespace throng {
namespace {

constexpr size_t kLookAhead = 64;          // rows; keeps the work linear
constexpr size_t kCachedModels = 1 << 18;  // exact transforms that are kept: 24 MiB

}  // namespace

ClipMeter::ClipMeter(const Character& character, const ClipGrid& grid, std::span<const Box> boxes,
                     const Progress& progress)
    : character_(character),
      grid_(grid),
      boxes_(boxes),
      progress_(progress),
      models_(boxes.size()),
      exact_models_(boxes.size()),
      exact_pose_(grid.still),
      peaks_(boxes.size()) {
    if (grid.point_count() * boxes.size() > kCachedModels) return;
    std::vector<AffineT<double>> all;
    all.reserve(grid.point_count() * boxes.size());
    for (size_t point = 0; point < grid.point_count(); ++point) {
        progress.poll();
        const std::span<const AffineT<double>> models = compute_exact(point);
        all.insert(all.end(), models.begin(), models.end());
    }
    cache_ = std::move(all);
}

std::span<const AffineT<double>> ClipMeter::compute_exact(size_t point) {
    if (point % grid_.points_per_row != 0)
        exact_pose_ = sample_exact(grid_.clip, character_.rig, grid_.time_s(point));
    else
        for (const ExactTrack& track : grid_.tracks)
            set_component(exact_pose_[track.joint], track.target, track.at_row(point / grid_.points_per_row));
    const std::vector<uint32_t>& parents = character_.rig.parents;
    for (size_t joint = 0; joint < parents.size(); ++joint) {
        const AffineT<double> parent_from_joint = to_affine(exact_pose_[joint]);
        exact_models_[joint] = parents[joint] == kNone ? parent_from_joint
                                                       : exact_models_[parents[joint]] * parent_from_joint;
    }
    return exact_models_;
}

std::span<const AffineT<double>> ClipMeter::exact(size_t point) {
    progress_.poll();
    return cache_.empty() ? compute_exact(point)
                          : std::span<const AffineT<double>>(cache_).subspan(point * boxes_.size(), boxes_.size());
}

double ClipMeter::place(size_t joint, const Trs<double>& trs, std::span<const AffineT<double>> wanted) {
    const uint32_t parent = character_.rig.parents[joint];
    const AffineT<double> parent_from_joint = to_affine(trs);
    AffineT<double>& model = models_[joint];
    model = parent == kNone ? parent_from_joint : models_[parent] * parent_from_joint;
    AffineT<double> difference;
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 4; ++c) difference.row[r][c] = model.row[r][c] - wanted[joint].row[r][c];
    const double d = displacement(difference, boxes_[joint]);
    peaks_[joint] = std::max(peaks_[joint], d);
    return d;
}

// Doubles the distance to the next row as long as the rows between are reproduced, then bisects.
std::vector<size_t> ClipMeter::keep_rows(double bound) {
    std::vector<size_t> kept{0};
    while (kept.back() + 1 < grid_.row_count()) {
        const size_t from = kept.back();
        size_t furthest = 1;  // distance
        while (!grid_.fixed[from + furthest] && furthest < kLookAhead) ++furthest;
        size_t good = 1, bad = furthest + 1;
        while (good < furthest && bad > furthest) {
            const size_t next = std::min(2 * good, furthest);
            (reproduces(from, from + next, bound) ? good : bad) = next;
        }
        while (bad - good > 1) {
            const size_t middle = (good + bad) / 2;
            (reproduces(from, from + middle, bound) ? good : bad) = middle;
        }
        kept.push_back(from + good);
    }
    return kept;
}

bool ClipMeter::reproduces(size_t from_row, size_t to_row, double bound) {
    const size_t parts = grid_.points_per_row;
    pose_ = grid_.still;
    for (size_t row = from_row + 1; row < to_row; ++row) {
        mix(grid_.tracks, from_row, to_row, fraction(from_row, to_row, row * parts));
        const std::span<const AffineT<double>> wanted = exact(row * parts);
        for (size_t joint = 0; joint < boxes_.size(); ++joint)
            if (!(place(joint, pose_[joint], wanted) <= bound)) return false;
    }
    return true;
}

// Sets the pose to what the sample stage computes from packed keys.
void ClipMeter::mix(std::span<const ExactTrack> tracks, size_t earlier, size_t later, double fraction) {
    for (const ExactTrack& track : tracks) {
        if (track.keys.empty()) continue;
        Trs<double>& joint = pose_[track.joint];
        set_component(joint, track.target,
                      lerp(value_of(track.keys[earlier]), value_of(track.keys[later]), track.step ? 0 : fraction));
        if (track.target == TrackTarget::kRotation) joint.rotation = normalized(joint.rotation);
    }
}

double ClipMeter::fraction(size_t from_row, size_t to_row, size_t point) const {
    const double from_s = grid_.times_s[from_row];
    return (grid_.time_s(point) - from_s) / (double{grid_.times_s[to_row]} - from_s);
}

double ClipMeter::largest_between(const Rows& rows, size_t interval, double enough) {
    const size_t row_count = rows.of_grid.size(), parts = grid_.points_per_row;
    double largest = 0;
    pose_ = rows.still;
    for (size_t row = 0; row + 1 < row_count && largest <= enough; row += interval)
        for (size_t point = rows.of_grid[row] * parts + 1; point < rows.of_grid[row + 1] * parts; ++point) {
            if (grid_.jumps_after(point / parts)) continue;
            mix(rows.tracks, row, row + 1, fraction(rows.of_grid[row], rows.of_grid[row + 1], point));
            const std::span<const AffineT<double>> wanted = exact(point);
            for (size_t joint = 0; joint < boxes_.size(); ++joint)
                largest = std::max(largest, place(joint, pose_[joint], wanted));
        }
    return largest;
}

}  // namespace throng
