#include "compile/clip/clip_packer.h"

#include "base/failure.h"
#include "compile/clip/row_encoder.h"
#include "compile/clip/packed_track.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace throng {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr size_t kSampledRows = 16;  // for sensitivities
// A search measures about this many points between rows; its result is measured at all of them
constexpr size_t kSearchPoints = 1024;
constexpr double kArcShare = 0.1;  // of the bound: for interpolating arcs linearly when all rows are kept
// Parts of the bound that dropping rows may use up; the rest is for quantising. The smaller result is kept
constexpr std::array kRowShares{0.4, 0.75};
constexpr double kMargin = 0.99;     // the points of the grid may miss the largest displacement by a little
constexpr double kFirstScale = 0.3;  // of tolerances, where a search begins
// If a bound cannot be kept: allowing this many times the error of the finest keys saves most of their bits
constexpr double kAboveFinest = 1.2;

// The first pose, with each joint's largest components of scale and translation of all rows. So no pose reaches
// further, and parts that a scale of 0 hides in the sampled rows count too.
std::vector<Trs<double>> extended_pose(const ExactClip& clip, const Rig& rig) {
    std::vector<Trs<double>> pose = sample_exact(clip, rig, 0);
    for (const ExactTrack& track : clip.tracks) {
        if (track.target == TrackTarget::kRotation) continue;
        TrackValue value = component(pose[track.joint], track.target);
        for (size_t row = 0; track.varies() && row < track.keys.size(); ++row)
            for (size_t c = 0; c < 3; ++c)
                if (const double other = double{track.keys[row][c]}; std::abs(value[c]) < std::abs(other))
                    value[c] = other;
        set_component(pose[track.joint], track.target, value);
    }
    return pose;
}

// Poses of some rows; the last one is the extended pose.
std::vector<std::vector<Trs<double>>> sample_poses(const ExactClip& clip, const Rig& rig) {
    const size_t row_count = clip.times_s.size(), count = std::min(row_count, kSampledRows);
    std::vector<std::vector<Trs<double>>> poses;
    for (size_t i = 0; i < count; ++i) {
        const size_t row = count == 1 ? 0 : i * (row_count - 1) / (count - 1);
        poses.push_back(sample_exact(clip, rig, double{clip.times_s[row]}));
    }
    poses.push_back(extended_pose(clip, rig));
    return poses;
}

class ClipPacker {
public:
    ClipPacker(const Character& character, const ExactClip& clip, std::span<const Box> boxes,
               const PackSettings& settings, const Progress& progress)
        : character_(character),
          progress_(progress),
          boxes_(boxes),
          bound_(settings.bound),
          poses_(sample_poses(clip, character.rig)),
          grid_(make_clip_grid(clip, character.rig, joint_reaches(character, boxes, poses_.back()),
                               {kArcShare * bound_, settings.joint_rows})),
          meter_(character, grid_, boxes, progress),
          encoder_(character, grid_, meter_) {}

    PackedClip run() {
        for (const double share : kRowShares) {
            std::vector<size_t> rows = meter_.keep_rows(share * bound_);
            if (rows == rows_) continue;
            take(std::move(rows));
            search(kMargin * bound_);
        }
        if (!best_) {
            double finest = take_finest(kArcShare * bound_);
            if (finest > bound_) finest = take_finest(0);
            if (finest > bound_) finest = take_finest(kArcShare * bound_);  // all rows do not help either
            if (!(finest < kInfinity)) {
                const std::string name = printable(grid_.clip.facts.name);
                throw Failure(ErrorCode::kInvalidFile, printable(character_.name, 120),
                              "clip '" + name + "': its poses are not finite");
            }
            keep(finest);
            scale_ = kFirstScale;  // the failed searches left it so small that all bits are used
            search(finest <= bound_ ? std::max(kMargin * bound_, finest) : kAboveFinest * finest);
        }
        return std::move(*best_);
    }

private:
    void take(std::vector<size_t> rows) {
        rows_ = std::move(rows);
        shapes_ = track_shapes(character_, grid_, rows_);
        for (const auto& pose : poses_) {
            progress_.poll();
            add_sensitivity(shapes_, character_, boxes_, pose, bound_);
        }
        weights_.assign(boxes_.size(), 1);
    }

    // Takes the finest keys, leaving out rows within `row_bound`. Returns the largest displacement.
    double take_finest(double row_bound) {
        take(meter_.keep_rows(row_bound));
        return evaluate(0, 1, kInfinity);
    }

    // The largest displacement in the rows if every track may displace the skin by scale * weight * bound.
    double encode(double scale) {
        std::vector<double> tolerances = weights_;
        for (double& tolerance : tolerances) tolerance *= scale * bound_;
        encoder_.plan(shapes_, tolerances);
        meter_.reset_peaks();
        return encoder_.encode(shapes_, rows_);
    }

    // The largest displacement in the rows and between them. If above `enough`, it need not be the largest.
    double evaluate(double scale, size_t row_interval, double enough) {
        const double in_rows = encode(scale);
        if (in_rows > enough) return in_rows;
        return std::max(in_rows,
                        meter_.largest_between({rows_, encoder_.decoded(), encoder_.still()}, row_interval, enough));
    }

    // Searches for the largest scale that keeps the goal. The error grows about linearly with it, in small steps.
    void search(double goal) {
        constexpr int kWeighings = 3, kRounds = 5;
        for (int round = 0; round < kWeighings; ++round) {
            const double error = encode(scale_);
            weigh();
            scale_ *= std::clamp(0.8 * goal / std::max(error, 1e-6 * goal), 0.05, 8.0);
        }
        const size_t row_interval = std::max<size_t>(1, grid_.point_count() / kSearchPoints);
        double good = 0, bad = 0;
        for (int round = 0; round < kRounds && !(good > 0 && bad > 0 && bad < 1.05 * good); ++round) {
            const double error = evaluate(scale_, row_interval, good > 0 ? goal : 4 * goal);
            if (error <= goal && row_interval == 1) keep(error);
            (error <= goal ? good : bad) = scale_;
            const double ratio = goal / std::max(error, 1e-6 * goal);
            if (good > 0 && bad > 0)
                scale_ = std::sqrt(good * bad);
            else
                scale_ *= error <= goal ? std::clamp(ratio, 1.05, 8.0) : std::clamp(0.97 * ratio, 0.05, 0.95);
        }
        if (good > 0) scale_ = good;
        for (int round = 0; round < 4 && row_interval > 1; ++round) {
            const double error = evaluate(scale_, 1, 4 * goal);
            if (error <= goal) return keep(error);
            scale_ *= 0.97 * goal / error;
        }
    }

    // Raises the weights of joints below which the error stays less than elsewhere: they may be coarser.
    void weigh() {
        std::vector<double> below = meter_.peaks();
        for (size_t joint = below.size(); joint-- > 0;) {
            const uint32_t parent = character_.rig.parents[joint];
            if (parent != kNone) below[parent] = std::max(below[parent], below[joint]);
        }
        const double largest = *std::max_element(below.begin(), below.end());
        if (!(largest < kInfinity)) return;
        for (size_t joint = 0; joint < below.size(); ++joint)
            if (below[joint] > 0) weights_[joint] *= std::min(std::sqrt(largest / below[joint]), 4.0);
    }

    size_t size_bytes(size_t row_count) const {
        size_t bytes = row_count * (encoder_.row_stride() + 1) * sizeof(uint32_t);
        for (size_t slot = 0; slot < shapes_.size(); ++slot) {
            const PackedTrack& track = encoder_.tracks()[slot];
            // The header of the rest pose is stored already
            const bool rest = track.minimum == constant_track(shapes_[slot].target, shapes_[slot].rest).minimum;
            bytes += packed_row_bits(track) > 0 ? sizeof(PackedTrack) : rest ? 0 : sizeof(PackedTrack) / 2;
        }
        return bytes;
    }

    void keep(double error) {
        const size_t row_count = encoder_.row_stride() == 0 ? 1 : rows_.size();
        const size_t bytes = size_bytes(row_count);
        if (best_ && bytes >= best_bytes_) return;
        best_bytes_ = bytes;
        best_ = PackedClip{.tracks = encoder_.tracks(),
                           .words = encoder_.words(),
                           .row_stride = encoder_.row_stride(),
                           .error = error};
        for (size_t row = 0; row < row_count; ++row) best_->times_s.push_back(grid_.times_s[rows_[row]]);
    }

    const Character& character_;
    const Progress& progress_;
    const std::span<const Box> boxes_;
    const double bound_;
    const std::vector<std::vector<Trs<double>>> poses_;  // [sampled row][joint_count], exact
    const ClipGrid grid_;
    ClipMeter meter_;
    RowEncoder encoder_;
    std::vector<size_t> rows_;        // those of the grid that are kept
    std::vector<TrackShape> shapes_;  // [joint_count][3]
    std::vector<double> weights_;     // [joint_count]
    double scale_ = kFirstScale;
    std::optional<PackedClip> best_;
    size_t best_bytes_ = 0;
};

}  // namespace

PackedClip pack_clip(const Character& character, const ExactClip& clip, std::span<const Box> boxes,
                     const PackSettings& settings, const Progress& progress) {
    return ClipPacker(character, clip, boxes, settings, progress).run();
}

}  // namespace throng
