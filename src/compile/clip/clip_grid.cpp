#include "compile/clip/clip_grid.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr uint32_t kMostHalvings = 8;

uint32_t track_word(const JointTracks& tracks, TrackTarget target) {
    return target == TrackTarget::kRotation      ? tracks.rotation
           : target == TrackTarget::kTranslation ? tracks.translation
                                                 : tracks.scale;
}

TrackSample sample_of(const TrackKey& key, TrackTarget target) {
    if (target != TrackTarget::kRotation) return {key[0], key[1], key[2], 0};
    const Quaternion<double> q = normalized(Quaternion<double>{key[0], key[1], key[2], key[3]});
    return {q.x, q.y, q.z, q.w};
}

Quaternion<double> quaternion(const TrackSample& v) { return {v[0], v[1], v[2], v[3]}; }

// How far, in radians of rotation, the straight line between two quaternions lags behind their arc. It does most at
// 0.2113 of the way.
double chord_lag_rad(const TrackSample& a, const TrackSample& b) {
    constexpr double kWorst = 0.2113;
    double cosine = 0;
    for (size_t c = 0; c < 4; ++c) cosine += a[c] * b[c];
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    return 2 * std::abs(kWorst * angle - std::atan2(kWorst * std::sin(angle), 1 - kWorst + kWorst * std::cos(angle)));
}

class GridBuilder {
public:
    GridBuilder(const Character& character, uint32_t clip) : character_(character), clip_(character.clips[clip]) {
        const uint32_t joint_count = character.rig.joint_count();
        grid_.clip = clip;
        times_s_ = std::span(character.times_s).subspan(clip_.first_time, clip_.row_count);
        grid_.still.resize(joint_count);
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            const JointTracks& tracks = character.tracks[size_t{clip} * joint_count + joint];
            for (const TrackTarget target : {TrackTarget::kTranslation, TrackTarget::kRotation, TrackTarget::kScale}) {
                const uint32_t word = track_word(tracks, target);
                set_component(grid_.still[joint], target, sample_of(character.keys[word & kTrackPosition], target));
                if (!(word & kTrackAnimated)) continue;
                grid_.tracks.push_back({joint, target, (word & kTrackStep) != 0});
                words_.push_back(word);
            }
        }
    }

    ClipGrid run(std::span<const double> reaches, const GridSettings& settings) {
        const uint64_t most_rows = std::max<uint64_t>(settings.joint_rows / grid_.still.size(), times_s_.size());
        std::vector<uint32_t> halvings = halvings_by_interval(reaches, settings.bound);
        for (double looser = 8; row_count_of(halvings) > most_rows; looser *= 8)
            halvings = halvings_by_interval(reaches, settings.bound * looser);
        add_rows(halvings);
        // Between rows only arcs can be further off than in the rows; at 1/4 they nearly are as far as they get.
        constexpr double kNegligible = 0.1;
        if (!(largest_lag_ * character_.rig.level_count <= kNegligible * settings.bound)) grid_.points_per_row = 4;
        evaluate();
        return std::move(grid_);
    }

private:
    TrackSample key(size_t track, size_t row) const {
        return sample_of(character_.keys[(words_[track] & kTrackPosition) + row * clip_.row_stride],
                         grid_.tracks[track].target);
    }

    // A third power: each halving leaves an eighth.
    std::vector<uint32_t> halvings_by_interval(std::span<const double> reaches, double bound) {
        std::vector<uint32_t> halvings(times_s_.size() - 1);
        largest_lag_ = 0;
        for (size_t track = 0; track < grid_.tracks.size(); ++track) {
            if (grid_.tracks[track].target != TrackTarget::kRotation || grid_.tracks[track].step) continue;
            for (size_t row = 0; row + 1 < times_s_.size(); ++row) {
                if (is_jump(times_s_[row], times_s_[row + 1])) continue;
                double lag = chord_lag_rad(key(track, row), key(track, row + 1)) * reaches[grid_.tracks[track].joint];
                uint32_t count = 0;
                for (; lag > bound && count < kMostHalvings; lag /= 8) ++count;
                halvings[row] = std::max(halvings[row], count);
                largest_lag_ = std::max(largest_lag_, lag);
            }
        }
        return halvings;
    }

    static size_t row_count_of(const std::vector<uint32_t>& halvings) {
        size_t count = 1;
        for (const uint32_t h : halvings) count += size_t{1} << h;
        return count;
    }

    void add_rows(const std::vector<uint32_t>& halvings) {
        for (size_t row = 0; row + 1 < times_s_.size(); ++row) {
            const double from_s = times_s_[row], length_s = double{times_s_[row + 1]} - from_s;
            for (uint32_t part = 0; part < 1u << halvings[row]; ++part) {
                const auto time_s = static_cast<float>(from_s + length_s * part / (1u << halvings[row]));
                // Finer than floats
                if (part > 0 && (time_s <= grid_.times_s.back() || time_s >= times_s_[row + 1])) continue;
                grid_.times_s.push_back(time_s);
                grid_.fixed.push_back(part == 0 && row > 0 && steps_at(row));
            }
        }
        grid_.times_s.push_back(times_s_.back());
        grid_.fixed.push_back(true);
    }

    bool steps_at(size_t row) const {
        for (size_t track = 0; track < grid_.tracks.size(); ++track)
            if (grid_.tracks[track].step && key(track, row - 1) != key(track, row)) return true;
        return false;
    }

    void evaluate() {
        const size_t row_count = grid_.row_count();
        std::vector<RowCursor> cursors;
        for (const float time_s : grid_.times_s) cursors.push_back(find_rows_reference(times_s_, double{time_s}));
        grid_.values.resize(grid_.tracks.size() * row_count);
        for (size_t track = 0; track < grid_.tracks.size(); ++track) {
            const GridTrack& of = grid_.tracks[track];
            for (size_t row = 0; row < row_count; ++row) {
                const RowCursor& rows = cursors[row];
                TrackSample value = key(track, rows.earlier);
                if (!of.step && rows.fraction > 0) {
                    const TrackSample later = key(track, rows.later);
                    if (of.target == TrackTarget::kRotation) {
                        const Quaternion<double> q = slerp_reference(quaternion(value), quaternion(later),
                                                                     rows.fraction);
                        value = {q.x, q.y, q.z, q.w};
                    } else {
                        for (size_t c = 0; c < 3; ++c)
                            value[c] = value[c] * (1 - rows.fraction) + later[c] * rows.fraction;
                    }
                }
                for (size_t c = 0; c < 4; ++c) grid_.values[track * row_count + row][c] = static_cast<float>(value[c]);
            }
        }
    }

    const Character& character_;
    const Clip& clip_;
    std::span<const float> times_s_;
    std::vector<uint32_t> words_;  // [track], of Character::tracks
    double largest_lag_ = 0;       // displacement, of all intervals after their halvings
    ClipGrid grid_;
};

}  // namespace

bool is_jump(float from_s, float to_s) { return std::nextafter(from_s, to_s) == to_s; }

double ClipGrid::time_s(size_t point) const {
    const size_t row = point / points_per_row, part = point % points_per_row;
    if (part == 0) return times_s[row];
    return times_s[row] + (double{times_s[row + 1]} - times_s[row]) * static_cast<double>(part) / points_per_row;
}

TrackSample ClipGrid::value(size_t track, size_t row) const {
    const TrackKey& key = values[track * row_count() + row];
    return {key[0], key[1], key[2], key[3]};
}

void set_component(Trs<double>& trs, TrackTarget target, const TrackSample& value) {
    if (target == TrackTarget::kRotation)
        trs.rotation = {value[0], value[1], value[2], value[3]};
    else
        (target == TrackTarget::kTranslation ? trs.translation : trs.scale) = {value[0], value[1], value[2]};
}

TrackSample component(const Trs<double>& trs, TrackTarget target) {
    if (target == TrackTarget::kRotation) return {trs.rotation.x, trs.rotation.y, trs.rotation.z, trs.rotation.w};
    const Vec3<double>& v = target == TrackTarget::kTranslation ? trs.translation : trs.scale;
    return {v.x, v.y, v.z, 0};
}

ClipGrid make_clip_grid(const Character& character, uint32_t clip, std::span<const double> reaches,
                        const GridSettings& settings) {
    return GridBuilder(character, clip).run(reaches, settings);
}

}  // namespace throng
