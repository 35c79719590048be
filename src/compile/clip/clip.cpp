#include "compile/clip/clip.h"

#include "base/failure.h"
#include "compile/limits.h"
#include "compile/clip/source_track.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr uint64_t kKey_bytes = 16;
constexpr uint64_t kRawPose_bytes = 10 * sizeof(float);  // rotation, translation, scale
// Of the character's size; a rotation by as many radians moves no point further
constexpr double kRelativeBound = 1e-6;

constexpr size_t kRefinedKeyLimit = 4'000'000;  // of cubic tracks: seconds of work, tens of MiB

// One animated track of the clip: its source, and where its flags go.
struct Column {
    SourceTrack source;
    uint32_t* word;

    TrackTarget target() const { return source.track().target; }
    Interpolation interpolation() const { return source.track().interpolation; }
};

// Two neighbouring keys half a turn apart.
struct HalfTurn {
    const Column* column;
    float middle_s;
};

class ClipCompiler {
public:
    ClipCompiler(const Asset& asset, const RigMap& map, const AssetClip& source, Character& character)
        : asset_(asset), map_(map), source_(source), character_(character) {}

    void run(size_t clip_index) {
        clip_.name = source_.name;
        clip_.duration_s = static_cast<float>(source_.duration_s);
        clip_.first_time = static_cast<uint32_t>(character_.times_s.size());
        place_ = asset_.name + ": animations[" + std::to_string(clip_index) + "]";
        const uint64_t keys_before = character_.keys.size();
        sort_tracks(clip_index);
        unite_times();
        drop_rows();
        follow_cubic();
        write_rows();
        clip_.size_bytes = (character_.keys.size() - keys_before) * kKey_bytes + times_s_.size() * sizeof(float) +
                           map_.rig.joint_count() * sizeof(JointTracks);
        clip_.raw_size_bytes = uint64_t{clip_.row_count} * map_.rig.joint_count() * kRawPose_bytes;
        character_.clips.push_back(clip_);
    }

private:
    // Constants go to the key pool at once; what varies becomes a column.
    void sort_tracks(size_t clip_index) {
        const uint32_t joint_count = map_.rig.joint_count();
        for (const AssetTrack& track : source_.tracks) {
            ++clip_.channel_count;
            const uint32_t joint = map_.joint_of_node[track.node];
            if (joint == kNone) continue;  // moves nothing that is skinned or drawn
            JointTracks& tracks = character_.tracks[clip_index * joint_count + joint];
            uint32_t& word = track.target == TrackTarget::kRotation      ? tracks.rotation
                             : track.target == TrackTarget::kTranslation ? tracks.translation
                                                                         : tracks.scale;
            clip_.source_key_count += track.times_s.size();
            const SourceTrack source(track, map_.parent_from_prefix[joint]);
            if (source.is_constant()) {
                word = static_cast<uint32_t>(character_.keys.size());
                append_key(source.evaluate(0));
            } else {
                columns_.push_back({source, &word});
            }
        }
        clip_.row_stride = clip_.animated_track_count = static_cast<uint32_t>(columns_.size());
    }

    void unite_times() {
        for (const Column& column : columns_) {
            const auto& times = column.source.track().times_s;
            times_s_.insert(times_s_.end(), times.begin(), times.end());
            if (times_s_.size() > (size_t{1} << 22)) unique_times();  // bounded, however many tracks
        }
        split_half_turns();
        unique_times();
        if (times_s_.empty()) times_s_.push_back(0);
        check_size(times_s_.size());
    }

    // Between rotations half a turn apart, a float's rounding would decide which way round the arc goes: a row in the
    // middle does.
    void split_half_turns() {
        for (const Column& column : columns_) {
            if (column.target() != TrackTarget::kRotation || column.interpolation() != Interpolation::kLinear) continue;
            const auto& times = column.source.track().times_s;
            for (size_t key = 0; key + 1 < times.size(); ++key) {
                if (!is_half_turn(column, column.source.evaluate(times[key]), column.source.evaluate(times[key + 1])))
                    continue;
                const float middle_s = times[key] + (times[key + 1] - times[key]) / 2;
                half_turns_.push_back({&column, middle_s});
                times_s_.push_back(middle_s);
            }
        }
    }

    static bool is_half_turn(const Column& column, const TrackValue& a, const TrackValue& b) {
        constexpr double kCosine = 1e-4;  // between the quaternions; a float's rounding is a thousand times less
        return column.target() == TrackTarget::kRotation && column.interpolation() == Interpolation::kLinear &&
               std::abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]) < kCosine;
    }

    void unique_times() {
        std::sort(times_s_.begin(), times_s_.end());
        times_s_.erase(std::unique(times_s_.begin(), times_s_.end()), times_s_.end());
    }

    void check_size(size_t row_count) const {
        const uint64_t bytes = (character_.keys.size() + uint64_t{row_count} * columns_.size()) * kKey_bytes;
        if (bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, place_,
                          std::to_string(row_count) + " key times x " + std::to_string(columns_.size()) +
                              " tracks make " + std::to_string(bytes >> 20) +
                              " MiB of keys with the clips before; the limit is 256 MiB a character");
    }

    double bound(TrackTarget target) const {
        return target == TrackTarget::kTranslation ? relative_bound_ * character_.size : relative_bound_;
    }

    // Rows between the keys of cubic tracks. A track that swings too wildly for the bound is followed less closely,
    // with a warning.
    void follow_cubic() {
        std::vector<const Column*> cubic;
        for (const Column& column : columns_)
            if (column.interpolation() == Interpolation::kCubicSpline) cubic.push_back(&column);
        if (cubic.empty()) return;
        constexpr double kLoosest = 1e-2;
        for (double done = refine(cubic); done < 1; done = refine(cubic)) {
            relative_bound_ *= std::pow(1.2 / done, 2);  // rows go with the inverse square root of the bound
            if (!(relative_bound_ <= kLoosest))
                throw Failure(ErrorCode::kLimit, place_,
                              "its cubic tracks would need more than the limit of " + std::to_string(kRefinedKeyLimit) +
                                  " keys to be followed within 1 % of the character's size");
        }
        if (relative_bound_ > kRelativeBound)
            character_.warnings.push_back(place_ + ": its cubic tracks are followed within " +
                                          std::to_string(relative_bound_) +
                                          " of the character's size, not 0.000001; that would take more than " +
                                          std::to_string(kRefinedKeyLimit) + " keys");
        relative_bound_ = kRelativeBound;
    }

    // Halves intervals until straight lines (and arcs) between rows follow the cubic tracks. Returns the part of the
    // clip for which the limit of keys was enough; below 1, nothing is changed.
    double refine(const std::vector<const Column*>& cubic) {
        const auto fits = [&](double from_s, double to_s) {
            return std::all_of(cubic.begin(), cubic.end(), [&](const Column* column) {
                const TrackValue from = column->source.evaluate(from_s), to = column->source.evaluate(to_s);
                for (const double w : {0.25, 0.5, 0.75}) {
                    const TrackValue row = interpolate_rows(column->target(), Interpolation::kLinear, from, to, w);
                    if (!(distance(column->target(), row, column->source.evaluate(from_s + w * (to_s - from_s))) <=
                          bound(column->target())))
                        return false;
                }
                return true;
            });
        };
        std::vector<float> refined;
        for (size_t row = 0; row + 1 < times_s_.size(); ++row) {
            std::vector<float> ends{times_s_[row + 1]};  // of the intervals still to look at, the nearest last
            float from_s = times_s_[row];
            refined.push_back(from_s);
            while (!ends.empty()) {
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
        clip_.refined_row_count = static_cast<uint32_t>(refined.size() - times_s_.size());
        times_s_ = std::move(refined);
        check_size(times_s_.size());
        return 1;
    }

    // Where tracks have few keys at many different times, the union repeats most of them: leave out rows that their
    // neighbours reproduce. Looks ahead a bounded number of rows, so that the work stays linear.
    void drop_rows() {
        constexpr uint64_t kFarLarger = 4, kWorthIt = 1 << 16, kLookAhead = 32;
        const uint64_t union_keys = uint64_t{times_s_.size()} * columns_.size();
        if (union_keys < kWorthIt || union_keys < kFarLarger * clip_.source_key_count) return;
        const std::vector<std::vector<const Column*>> bends = bends_by_row();
        std::vector<float> kept{times_s_.front()};
        size_t from = 0;
        while (from + 1 < times_s_.size()) {
            size_t to = from + 1;
            while (to + 1 < times_s_.size() && to - from < kLookAhead && reproduces(bends, from, to + 1)) ++to;
            kept.push_back(times_s_[to]);
            from = to;
        }
        clip_.dropped_row_count = static_cast<uint32_t>(times_s_.size() - kept.size());
        times_s_ = std::move(kept);
    }

    // For each row the columns that may bend or jump there: those with a key of their own, or half a turn around it,
    // and cubic ones everywhere. The others go straight through it.
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
                if (is_half_turn(*column, a, b)) return false;
                const TrackValue between = interpolate_rows(column->target(), column->interpolation(), a, b, w);
                if (!(distance(column->target(), between, column->source.evaluate(times_s_[row])) <=
                      bound(column->target())))
                    return false;
            }
        }
        return true;
    }

    void write_rows() {
        check_size(times_s_.size());
        const size_t first = character_.keys.size();
        for (size_t i = 0; i < columns_.size(); ++i)
            *columns_[i].word = static_cast<uint32_t>(first + i) | kTrackAnimated |
                                (columns_[i].interpolation() == Interpolation::kStep ? kTrackStep : 0);
        for (float time_s : times_s_)
            for (const Column& column : columns_) append_key(column.source.evaluate(time_s));
        for (size_t i = 0; i < columns_.size(); ++i)
            if (columns_[i].target() == TrackTarget::kRotation) join_hemispheres(first + i);
        clip_.row_count = static_cast<uint32_t>(times_s_.size());
        character_.times_s.insert(character_.times_s.end(), times_s_.begin(), times_s_.end());
    }

    // q and -q are one rotation; the sample stage expects neighbours in one hemisphere.
    void join_hemispheres(size_t first) {
        for (size_t row = 1; row < times_s_.size(); ++row) {
            const auto& earlier = character_.keys[first + (row - 1) * columns_.size()];
            auto& later = character_.keys[first + row * columns_.size()];
            double cosine = 0;
            for (size_t i = 0; i < 4; ++i) cosine += double{earlier[i]} * later[i];
            if (cosine < 0)
                for (float& component : later) component = -component;
        }
    }

    void append_key(const TrackValue& v) {
        character_.keys.push_back(
            {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(v[3])});
    }

    const Asset& asset_;
    const RigMap& map_;
    const AssetClip& source_;
    Character& character_;
    Clip clip_;
    std::string place_;
    std::vector<Column> columns_;
    std::vector<float> times_s_;
    std::vector<HalfTurn> half_turns_;
    double relative_bound_ = kRelativeBound;
};

}  // namespace

void compile_clips(const Asset& asset, const RigMap& map, Character& character) {
    const uint32_t joint_count = map.rig.joint_count();
    const uint64_t table_bytes = (asset.clips.size() + 1) * uint64_t{joint_count} * sizeof(JointTracks);
    if (table_bytes > kKeyLimit_bytes)
        throw Failure(ErrorCode::kLimit, asset.name,
                      std::to_string(asset.clips.size()) + " clips x " + std::to_string(joint_count) +
                          " joints make a track table of " + std::to_string(table_bytes >> 20) +
                          " MiB; the limit is 256 MiB");

    std::vector<JointTracks> rest_tracks;
    rest_tracks.reserve(joint_count);
    for (const Trs<float>& rest : map.rig.rest) {
        const auto first = static_cast<uint32_t>(character.keys.size());
        character.keys.push_back({rest.rotation.x, rest.rotation.y, rest.rotation.z, rest.rotation.w});
        character.keys.push_back({rest.translation.x, rest.translation.y, rest.translation.z, 0});
        character.keys.push_back({rest.scale.x, rest.scale.y, rest.scale.z, 0});
        rest_tracks.push_back({.rotation = first, .translation = first + 1, .scale = first + 2});
    }
    character.tracks.reserve(static_cast<size_t>(table_bytes / sizeof(JointTracks)));
    for (size_t clip = 0; clip <= asset.clips.size(); ++clip)
        character.tracks.insert(character.tracks.end(), rest_tracks.begin(), rest_tracks.end());
    for (size_t clip = 0; clip < asset.clips.size(); ++clip)
        ClipCompiler(asset, map, asset.clips[clip], character).run(clip);
}

}  // namespace throng
