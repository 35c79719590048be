#include "compile/clip.h"

#include "base/failure.h"
#include "compile/source_track.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint64_t kKeyLimit_bytes = uint64_t{1} << 30;
constexpr uint64_t kKey_bytes = 16;
constexpr double kRelativeBound = 1e-6;  // of the character's size; a rotation by as many radians moves no point further

// One animated track of the clip: its source, and where its flags go.
struct Column {
    SourceTrack source;
    uint32_t* word;

    TrackTarget target() const { return source.track().target; }
    Interpolation interpolation() const { return source.track().interpolation; }
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
        refine_cubic();
        drop_rows();
        write_rows();
        clip_.size_bytes = (character_.keys.size() - keys_before) * kKey_bytes + times_s_.size() * sizeof(float) +
                           map_.rig.joint_count() * sizeof(JointTracks);
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
        clip_.column_count = static_cast<uint32_t>(columns_.size());
    }

    void unite_times() {
        for (const Column& column : columns_) {
            const auto& times = column.source.track().times_s;
            times_s_.insert(times_s_.end(), times.begin(), times.end());
            if (times_s_.size() > (size_t{1} << 22)) unique_times();  // bounded, however many tracks
        }
        unique_times();
        if (times_s_.empty()) times_s_.push_back(0);
        check_size(times_s_.size());
    }

    void unique_times() {
        std::sort(times_s_.begin(), times_s_.end());
        times_s_.erase(std::unique(times_s_.begin(), times_s_.end()), times_s_.end());
    }

    void check_size(size_t row_count) const {
        const uint64_t bytes = (character_.keys.size() + uint64_t{row_count} * columns_.size()) * kKey_bytes;
        if (bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, place_, std::to_string(row_count) + " key times x " + std::to_string(columns_.size()) +
                                                         " tracks make " + std::to_string(bytes >> 20) + " MiB of keys with the clips before; the limit is 1024 MiB a character");
    }

    double bound(TrackTarget target) const {
        return target == TrackTarget::kTranslation ? kRelativeBound * character_.size : kRelativeBound;
    }

    // Halves intervals until straight lines (and arcs) between rows follow the cubic tracks.
    void refine_cubic() {
        std::vector<const Column*> cubic;
        for (const Column& column : columns_)
            if (column.interpolation() == Interpolation::kCubicSpline) cubic.push_back(&column);
        if (cubic.empty()) return;
        const auto fits = [&](double from_s, double to_s) {
            return std::all_of(cubic.begin(), cubic.end(), [&](const Column* column) {
                const TrackValue from = column->source.evaluate(from_s), to = column->source.evaluate(to_s);
                for (const double w : {0.25, 0.5, 0.75}) {
                    const TrackValue row = interpolate_rows(column->target(), Interpolation::kLinear, from, to, w);
                    if (distance(column->target(), row, column->source.evaluate(from_s + w * (to_s - from_s))) > bound(column->target())) return false;
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
                    check_size(refined.size() + ends.size());
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
    }

    // Where tracks have few keys at many different times, the union repeats most of them: leave out rows that their neighbours
    // reproduce. Looks ahead a bounded number of rows, so that the work stays linear.
    void drop_rows() {
        constexpr uint64_t kFarLarger = 4, kWorthIt = 1 << 16, kLookAhead = 32;
        const uint64_t union_keys = uint64_t{times_s_.size()} * columns_.size();
        if (union_keys < kWorthIt || union_keys < kFarLarger * clip_.source_key_count) return;
        std::vector<float> kept{times_s_.front()};
        size_t from = 0;
        while (from + 1 < times_s_.size()) {
            size_t to = from + 1;
            while (to + 1 < times_s_.size() && to - from < kLookAhead && reproduces(from, to + 1)) ++to;
            kept.push_back(times_s_[to]);
            from = to;
        }
        clip_.dropped_row_count = static_cast<uint32_t>(times_s_.size() - kept.size());
        times_s_ = std::move(kept);
    }

    // Whether rows `from` and `to` alone give every row between them.
    bool reproduces(size_t from, size_t to) const {
        for (const Column& column : columns_) {
            const TrackValue a = column.source.evaluate(times_s_[from]), b = column.source.evaluate(times_s_[to]);
            for (size_t row = from + 1; row < to; ++row) {
                const double w = (double{times_s_[row]} - times_s_[from]) / (double{times_s_[to]} - times_s_[from]);
                const TrackValue between = interpolate_rows(column.target(), column.interpolation(), a, b, w);
                if (distance(column.target(), between, column.source.evaluate(times_s_[row])) > bound(column.target())) return false;
            }
        }
        return true;
    }

    void write_rows() {
        check_size(times_s_.size());
        const size_t first = character_.keys.size();
        for (size_t i = 0; i < columns_.size(); ++i)
            *columns_[i].word = static_cast<uint32_t>(first + i) | kTrackAnimated | (columns_[i].interpolation() == Interpolation::kStep ? kTrackStep : 0);
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
            if (earlier[0] * later[0] + earlier[1] * later[1] + earlier[2] * later[2] + earlier[3] * later[3] < 0)
                for (float& component : later) component = -component;
        }
    }

    void append_key(const TrackValue& v) {
        character_.keys.push_back({static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(v[3])});
    }

    const Asset& asset_;
    const RigMap& map_;
    const AssetClip& source_;
    Character& character_;
    Clip clip_;
    std::string place_;
    std::vector<Column> columns_;
    std::vector<float> times_s_;
};

}  // namespace

void compile_clips(const Asset& asset, const RigMap& map, Character& character) {
    const uint32_t joint_count = map.rig.joint_count();
    const uint64_t table_bytes = (asset.clips.size() + 1) * uint64_t{joint_count} * sizeof(JointTracks);
    if (table_bytes > kKeyLimit_bytes)
        throw Failure(ErrorCode::kLimit, asset.name, std::to_string(asset.clips.size()) + " clips x " + std::to_string(joint_count) + " joints make a track table of " + std::to_string(table_bytes >> 20) + " MiB; the limit is 1024 MiB");

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
    for (size_t clip = 0; clip < asset.clips.size(); ++clip) ClipCompiler(asset, map, asset.clips[clip], character).run(clip);
}

}  // namespace throng
