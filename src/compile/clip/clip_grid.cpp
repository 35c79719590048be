#include "compile/clip/clip_grid.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr uint32_t kMaxHalvings = 8;

// Normalises the value if it is a rotation.
TrackValue unit(TrackTarget target, const TrackValue& value) {
    return target == TrackTarget::kRotation ? value_of(normalized(quaternion_of(value))) : value;
}

// How far, in radians of rotation, the straight line between two quaternions lags behind their arc. The lag is largest
// at 0.2113 of the way.
double chord_lag_rad(const TrackValue& a, const TrackValue& b) {
    constexpr double kWorst = 0.2113;
    const double angle = std::acos(std::clamp(dot(quaternion_of(a), quaternion_of(b)), -1.0, 1.0));
    return 2 * std::abs(kWorst * angle - std::atan2(kWorst * std::sin(angle), 1 - kWorst + kWorst * std::cos(angle)));
}

class GridBuilder {
public:
    GridBuilder(const ExactClip& clip, const Rig& rig) : clip_(clip), rig_(rig), grid_{clip} {
        for (const Trs<float>& rest : rig.rest) {
            grid_.still.push_back(rest.as<double>());
            grid_.still.back().rotation = normalized(grid_.still.back().rotation);
        }
        for (const ExactTrack& track : clip.tracks) {
            set_component(grid_.still[track.joint], track.target, unit(track.target, track.at_row(0)));
            if (track.varies()) tracks_.push_back(&track);
        }
    }

    ClipGrid run(std::span<const double> reaches, const GridSettings& settings) {
        const uint64_t max_rows = std::max<uint64_t>(settings.joint_rows / grid_.still.size(), clip_.times_s.size());
        std::vector<uint32_t> halvings = halvings_by_interval(reaches, settings.bound);
        for (double looser = 8; row_count_of(halvings) > max_rows; looser *= 8)
            halvings = halvings_by_interval(reaches, settings.bound * looser);
        add_rows(halvings);
        // Only arcs can be further off between rows than at rows, and at 1/4 of the way they are nearly at their
        // furthest.
        constexpr double kNegligible = 0.1;
        if (!(largest_lag_ * rig_.level_count <= kNegligible * settings.bound)) grid_.points_per_row = 4;
        resample();
        return std::move(grid_);
    }

private:
    // The lag grows with the third power of the angle, so each halving leaves an eighth.
    std::vector<uint32_t> halvings_by_interval(std::span<const double> reaches, double bound) {
        std::vector<uint32_t> halvings(clip_.times_s.size() - 1);
        largest_lag_ = 0;
        for (const ExactTrack* track : tracks_) {
            if (track->target != TrackTarget::kRotation || track->step) continue;
            for (size_t row = 0; row + 1 < clip_.times_s.size(); ++row) {
                if (is_jump(clip_.times_s[row], clip_.times_s[row + 1])) continue;
                double lag = chord_lag_rad(unit(track->target, track->at_row(row)),
                                           unit(track->target, track->at_row(row + 1))) *
                             reaches[track->joint];
                uint32_t count = 0;
                for (; lag > bound && count < kMaxHalvings; lag /= 8) ++count;
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
        for (size_t row = 0; row + 1 < clip_.times_s.size(); ++row) {
            const double from_s = clip_.times_s[row], length_s = double{clip_.times_s[row + 1]} - from_s;
            for (uint32_t part = 0; part < 1u << halvings[row]; ++part) {
                const auto time_s = static_cast<float>(from_s + length_s * part / (1u << halvings[row]));
                // Floats cannot hold a time this fine
                if (part > 0 && (time_s <= grid_.times_s.back() || time_s >= clip_.times_s[row + 1])) continue;
                grid_.times_s.push_back(time_s);
                grid_.fixed.push_back(part == 0 && row > 0 && steps_at(row));
            }
        }
        grid_.times_s.push_back(clip_.times_s.back());
        grid_.fixed.push_back(true);
    }

    bool steps_at(size_t row) const {
        return std::ranges::any_of(
            tracks_, [&](const ExactTrack* track) { return track->step && track->keys[row - 1] != track->keys[row]; });
    }

    void resample() {
        std::vector<RowCursor> cursors;
        for (const float time_s : grid_.times_s) cursors.push_back(find_rows_reference(clip_.times_s, time_s));
        for (const ExactTrack* from : tracks_) {
            ExactTrack& track = grid_.tracks.emplace_back(ExactTrack{from->joint, from->target, from->step});
            track.keys.reserve(cursors.size());
            for (const RowCursor& rows : cursors) {
                const TrackValue value = from->between(rows);
                const bool is_key = from->step || rows.fraction == 0;
                track.keys.push_back(key_of(is_key ? unit(from->target, value) : value));
            }
        }
    }

    const ExactClip& clip_;
    const Rig& rig_;
    std::vector<const ExactTrack*> tracks_{};  // that vary
    double largest_lag_ = 0;                   // displacement, of all intervals after their halvings
    ClipGrid grid_;
};

}  // namespace

bool is_jump(float from_s, float to_s) { return std::nextafter(from_s, to_s) == to_s; }

double ClipGrid::time_s(size_t point) const {
    const size_t row = point / points_per_row, part = point % points_per_row;
    if (part == 0) return times_s[row];
    return times_s[row] + (double{times_s[row + 1]} - times_s[row]) * static_cast<double>(part) / points_per_row;
}

ClipGrid make_clip_grid(const ExactClip& clip, const Rig& rig, std::span<const double> reaches,
                        const GridSettings& settings) {
    return GridBuilder(clip, rig).run(reaches, settings);
}

}  // namespace throng
