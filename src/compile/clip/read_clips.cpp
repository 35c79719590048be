#include "compile/clip/read_clips.h"

#include "base/failure.h"
#include "base/finite.h"
#include "compile/limits.h"
#include "compile/clip/source_track.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace throng {
namespace {

// As a part of the character's size. A rotation by this many radians moves no point further than that
constexpr double kRelativeBound = 1e-6;

constexpr size_t kUnitedAtOnce = 1 << 22;       // times, before equal ones become one
constexpr size_t kRefinedKeyLimit = 4'000'000;  // of cubic tracks: seconds of work, tens of MiB

// A track of the clip that varies, and where it comes from.
struct Column {
    SourceTrack source;
    size_t track;  // of ExactClip::tracks

    TrackTarget target() const { return source.track().target; }
    Interpolation interpolation() const { return source.track().interpolation; }
    bool is_arc() const { return target() == TrackTarget::kRotation && interpolation() == Interpolation::kLinear; }
};

// Two neighbouring keys half a turn apart.
struct HalfTurn {
    const Column* column;
    float middle_s;
};

class ClipReader {
public:
    // `key_count`: of the rest pose and the clips before.
    ClipReader(const Asset& asset, const RigMap& map, size_t index, uint64_t key_count, Character& character,
               const Progress& progress)
        : map_(map),
          source_(asset.clips[index]),
          place_(asset.name + ": animations[" + std::to_string(index) + "]"),
          keys_before_(key_count),
          character_(character),
          progress_(progress) {}

    ExactClip read() {
        clip_.facts.name = source_.name;
        clip_.facts.duration_s = static_cast<float>(source_.duration_s);
        read_tracks();
        unite_times();
        drop_rows();
        follow_cubic();
        evaluate();
        return std::move(clip_);
    }

private:
    // Constants are evaluated at once; what varies becomes a column.
    void read_tracks() {
        for (const AssetTrack& track : source_.tracks) {
            ++clip_.facts.channel_count;
            const uint32_t joint = map_.joint_of_node[track.node];
            if (joint == kNone) continue;  // moves nothing that is skinned or drawn
            clip_.facts.source_key_count += track.times_s.size();
            const SourceTrack source(track, map_.parent_from_prefix[joint]);
            const bool constant = source.is_constant();
            if (!constant) columns_.push_back({source, clip_.tracks.size()});
            clip_.tracks.push_back({joint, track.target, !constant && track.interpolation == Interpolation::kStep, {}});
            if (constant) clip_.tracks.back().keys.push_back(key_at(source, 0));
        }
        keys_before_ += clip_.tracks.size() - columns_.size();
    }

    // A cubic track may overshoot, and what lies above a joint may scale its track.
    TrackKey key_at(const SourceTrack& source, float time_s) const {
        const TrackKey key = key_of(source.evaluate(double{time_s}));
        if (!all_finite(key))
            throw Failure(ErrorCode::kInvalidFile, place_, "the track of node ", source.track().node,
                          " exceeds all floats at ", time_s, " s");
        return key;
    }

    void unite_times() {
        for (const Column& column : columns_) {
            const auto& times = column.source.track().times_s;
            times_s_.insert(times_s_.end(), times.begin(), times.end());
            if (times_s_.size() <= kUnitedAtOnce) continue;
            progress_.poll();
            unique_times();
            check_size(times_s_.size());
        }
        split_half_turns();
        unique_times();
        if (times_s_.empty()) times_s_.push_back(0);
        check_size(times_s_.size());
    }

    void split_half_turns() {
        for (const Column& column : columns_) {
            if (!column.is_arc()) continue;
            const auto& times = column.source.track().times_s;
            for (size_t key = 0; key + 1 < times.size(); ++key) {
                progress_.poll_at(key);
                if (!is_half_turn(column.source.evaluate(times[key]), column.source.evaluate(times[key + 1]))) continue;
                const float middle_s = times[key] + (times[key + 1] - times[key]) / 2;
                half_turns_.push_back({&column, middle_s});
                times_s_.push_back(middle_s);
            }
        }
    }

    void unique_times() {
        std::sort(times_s_.begin(), times_s_.end());
        times_s_.erase(std::unique(times_s_.begin(), times_s_.end()), times_s_.end());
    }

    void check_size(size_t row_count) const {
        const uint64_t bytes = (keys_before_ + uint64_t{row_count} * columns_.size()) * kKey_bytes;
        if (bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, place_,
                          std::to_string(row_count) + " key times x " + std::to_string(columns_.size()) +
                              " tracks and the clips before make " + std::to_string(bytes >> 20) +
                              " MiB of keys; the limit is 256 MiB per character");
    }

    // Whether interpolating by `w` between two rows gives a value that is near enough to the source.
    bool follows(const Column& column, const TrackValue& earlier, const TrackValue& later, double w,
                 double time_s) const {
        const TrackTarget target = column.target();
        const bool step = column.interpolation() == Interpolation::kStep;
        const double bound = target == TrackTarget::kTranslation ? relative_bound_ * character_.size : relative_bound_;
        return distance(target, step ? earlier : interpolate_reference(target, earlier, later, w),
                        column.source.evaluate(time_s)) <= bound;
    }

    // Adds rows between the keys of cubic tracks. If that would take too many keys, follows the tracks less closely,
    // with a warning.
    void follow_cubic() {
        std::vector<const Column*> cubic;
        for (const Column& column : columns_)
            if (column.interpolation() == Interpolation::kCubicSpline) cubic.push_back(&column);
        if (cubic.empty()) return;
        constexpr double kLoosest = 1e-2;
        for (double done = refine(cubic); done < 1; done = refine(cubic)) {
            relative_bound_ *= std::pow(1.2 / done, 2);  // row count goes with the inverse square root of the bound
            if (!(relative_bound_ <= kLoosest))
                throw Failure(ErrorCode::kLimit, place_,
                              "approximating its cubic tracks within 1 % of the character's size takes more than the "
                              "limit of " +
                                  std::to_string(kRefinedKeyLimit) + " keys");
        }
        if (relative_bound_ <= kRelativeBound) return;
        char bound[32];
        std::snprintf(bound, sizeof bound, "%.2g", relative_bound_);
        character_.warnings.push_back(joined(place_, ": its cubic tracks are approximated within ", bound,
                                             " of the character's size; 1e-06 would take more than ", kRefinedKeyLimit,
                                             " keys"));
    }

    // Halves intervals until interpolation between rows follows the cubic tracks. Returns the part of the clip for
    // which the limit of keys was enough. If that is less than 1, nothing is changed.
    double refine(const std::vector<const Column*>& cubic) {
        const auto fits = [&](double from_s, double to_s) {
            return std::all_of(cubic.begin(), cubic.end(), [&](const Column* column) {
                const TrackValue from = column->source.evaluate(from_s), to = column->source.evaluate(to_s);
                return std::ranges::all_of(std::array{0.25, 0.5, 0.75}, [&](double w) {
                    return follows(*column, from, to, w, from_s + w * (to_s - from_s));
                });
            });
        };
        std::vector<float> refined;
        for (size_t row = 0; row + 1 < times_s_.size(); ++row) {
            std::vector<float> ends{times_s_[row + 1]};  // of the intervals still to check, the nearest last
            float from_s = times_s_[row];
            refined.push_back(from_s);
            while (!ends.empty()) {
                progress_.poll();  // a step evaluates all cubic tracks
                const float to_s = ends.back(), middle_s = from_s + (to_s - from_s) / 2;
                if (middle_s > from_s && middle_s < to_s && !fits(from_s, to_s)) {
                    ends.push_back(middle_s);
                    if ((refined.size() + ends.size()) * cubic.size() >
                        std::max<size_t>(kRefinedKeyLimit, times_s_.size() * cubic.size()))
                        return (double{from_s} - times_s_.front()) / (double{times_s_.back()} - times_s_.front());
                } else {
                    ends.pop_back();
                    from_s = to_s;
                    if (!ends.empty()) refined.push_back(to_s);
                }
            }
        }
        refined.push_back(times_s_.back());
        clip_.facts.refined_row_count = static_cast<uint32_t>(refined.size() - times_s_.size());
        times_s_ = std::move(refined);
        check_size(times_s_.size());
        return 1;
    }

    // If tracks have few keys at many different times, most keys at the union of these times are redundant. Leaves out
    // rows that their neighbours reproduce. Looks ahead a bounded number of rows, so that the work stays linear.
    void drop_rows() {
        constexpr uint64_t kMinRatio = 4, kMinUnionKeys = 1 << 16, kLookAhead = 32;
        const uint64_t union_keys = uint64_t{times_s_.size()} * columns_.size();
        if (union_keys < kMinUnionKeys || union_keys < kMinRatio * clip_.facts.source_key_count) return;
        const std::vector<std::vector<const Column*>> bends = bends_by_row();
        std::vector<float> kept{times_s_.front()};
        size_t from = 0;
        while (from + 1 < times_s_.size()) {
            progress_.poll();
            size_t to = from + 1;
            while (to + 1 < times_s_.size() && to - from < kLookAhead && reproduces(bends, from, to + 1)) ++to;
            kept.push_back(times_s_[to]);
            from = to;
        }
        clip_.facts.dropped_row_count = static_cast<uint32_t>(times_s_.size() - kept.size());
        times_s_ = std::move(kept);
    }

    // For each row, the columns that may bend or jump there: those with a key there, or with the middle of a half turn,
    // and cubic ones everywhere. The other columns are straight lines or arcs there.
    std::vector<std::vector<const Column*>> bends_by_row() const {
        std::vector<std::vector<const Column*>> bends(times_s_.size());
        const auto at = [&](float time_s) -> std::vector<const Column*>& {
            return bends[static_cast<size_t>(std::lower_bound(times_s_.begin(), times_s_.end(), time_s) -
                                             times_s_.begin())];
        };
        for (const HalfTurn& half_turn : half_turns_) at(half_turn.middle_s).push_back(half_turn.column);
        for (const Column& column : columns_) {
            if (column.interpolation() == Interpolation::kCubicSpline) {
                for (auto& columns : bends) columns.push_back(&column);
                continue;
            }
            for (float time_s : column.source.track().times_s) at(time_s).push_back(&column);
        }
        return bends;
    }

    // Whether rows `from` and `to` alone give every row between them.
    bool reproduces(const std::vector<std::vector<const Column*>>& bends, size_t from, size_t to) const {
        for (size_t row = from + 1; row < to; ++row) {
            const double w = (double{times_s_[row]} - times_s_[from]) / (double{times_s_[to]} - times_s_[from]);
            for (const Column* column : bends[row]) {
                const TrackValue a = column->source.evaluate(times_s_[from]), b = column->source.evaluate(times_s_[to]);
                if (column->is_arc() && is_half_turn(a, b)) return false;
                if (!follows(*column, a, b, w, times_s_[row])) return false;
            }
        }
        return true;
    }

    void evaluate() {
        check_size(times_s_.size());
        for (const Column& column : columns_) {
            ExactTrack& track = clip_.tracks[column.track];
            track.keys.reserve(times_s_.size());
            for (const float time_s : times_s_) {
                progress_.poll_at(track.keys.size());
                track.keys.push_back(key_at(column.source, time_s));
            }
            if (track.target == TrackTarget::kRotation) join_hemispheres(track.keys);
        }
        clip_.times_s = std::move(times_s_);
    }

    const RigMap& map_;
    const AssetClip& source_;
    const std::string place_;
    uint64_t keys_before_;  // of the rest pose, the clips before, and constants
    Character& character_;
    const Progress& progress_;
    ExactClip clip_;
    std::vector<Column> columns_;
    std::vector<float> times_s_;
    std::vector<HalfTurn> half_turns_;
    double relative_bound_ = kRelativeBound;
};

}  // namespace

std::vector<ExactClip> read_clips(const Asset& asset, const RigMap& map, Character& character,
                                  const Progress& progress) {
    const uint32_t joint_count = map.rig.joint_count();
    const uint64_t table_bytes = (asset.clips.size() + 1) * uint64_t{joint_count} * sizeof(JointTracks);
    if (table_bytes > kKeyLimit_bytes)
        throw Failure(ErrorCode::kLimit, asset.name,
                      std::to_string(asset.clips.size()) + " clips x " + std::to_string(joint_count) +
                          " joints make a track table of " + std::to_string(table_bytes >> 20) +
                          " MiB; the limit is 256 MiB");
    std::vector<ExactClip> clips;
    uint64_t keys = uint64_t{3} * joint_count;
    for (size_t index = 0; index < asset.clips.size(); ++index) {
        progress.report(index, asset.clips.size());
        clips.push_back(ClipReader(asset, map, index, keys, character, progress).read());
        keys += key_count(clips.back(), clips.back().times_s.size());
    }
    return clips;
}

}  // namespace throng
