#include "native/row_cursors.h"

#include "sample/sample_reference.h"

#include <algorithm>

namespace throng::native {
namespace {

constexpr double kArcError = 1e-6;  // parts of the character's size: how far an arc may be from its chord
constexpr uint32_t kMaxPieces = 256;

// How the joints go from one row of keys to the next.
struct Interval {
    double pieces = 1;     // into which the longest arc is cut; a whole number
    bool is_left = false;  // a track steps: its end differs from the start of the next interval

    uint32_t row_count() const { return static_cast<uint32_t>(pieces) + (is_left ? 1 : 0); }
};

bool differ(TrackTarget target, const TrackValue& a, const TrackValue& b) {
    double straight = 0, opposite = 0;
    for (size_t c = 0; c < 4; ++c) {
        straight = std::max(straight, std::abs(a[c] - b[c]));
        opposite = std::max(opposite, std::abs(a[c] + b[c]));
    }
    return (target == TrackTarget::kRotation ? std::min(straight, opposite) : straight) > 1e-9;
}

// Quaternions that are `angle` apart and interpolated along their chord are off by up to sqrt(3) / 216 * angle^3 (the
// cubic term of atan(w tan(angle)) - w angle). A point at a distance of 1 is off by twice that.
double pieces_for(double angle, double reach, double size) {
    const double most = std::cbrt(kArcError * size / (2 * std::sqrt(3.0) / 216 * std::max(reach, 1e-12 * size)));
    return std::clamp(std::ceil(angle / most), 1.0, double{kMaxPieces});
}

std::vector<Interval> intervals_of(const Character& character, size_t clip, std::span<const RowJoint> joints) {
    std::vector<Interval> intervals(character.clips[clip].row_count - 1);
    for (const RowJoint& joint : joints)
        for (const TrackTarget target : kTrackTargets) {
            const TrackReader track(character, clip, joint.joint, target);
            if (!track.varies()) continue;
            const bool has_arcs = target == TrackTarget::kRotation && !character.packed;
            TrackValue from = track.between({});
            for (uint32_t i = 0; i < intervals.size(); ++i) {
                const TrackValue to = track.between({i, i + 1, 1}), next = track.between({i + 1, i + 1, 0});
                intervals[i].is_left |= differ(target, to, next);
                if (has_arcs) {
                    const double cosine = std::abs(dot(quaternion_of(from), quaternion_of(to)));
                    const double angle = std::acos(std::min(cosine, 1.0));
                    intervals[i].pieces = std::max(intervals[i].pieces, pieces_for(angle, joint.reach, character.size));
                }
                from = next;
            }
        }
    return intervals;
}

}  // namespace

std::optional<std::vector<ClipRowCursors>> row_cursors(const Character& character, std::span<const RowJoint> joints,
                                                       uint64_t max_rows) {
    std::vector<ClipRowCursors> cursors;
    uint64_t row_count = 1;  // of the rest pose
    for (size_t clip = 0; clip < character.clips.size(); ++clip) {
        const std::vector<Interval> intervals = intervals_of(character, clip, joints);
        for (const Interval& interval : intervals) row_count += interval.row_count();
        ++row_count;  // that of the last key
        if (row_count > max_rows) return std::nullopt;
        ClipRowCursors& of = cursors.emplace_back();
        uint32_t key = 0;
        for (const Interval& interval : intervals) {
            of.spans.push_back({static_cast<uint32_t>(of.rows.size()), static_cast<float>(interval.pieces)});
            for (uint32_t piece = 0; piece < interval.row_count(); ++piece)
                of.rows.push_back({key, key + 1, static_cast<double>(piece) / interval.pieces});
            ++key;
        }
        of.spans.push_back({static_cast<uint32_t>(of.rows.size()), 1});
        of.rows.push_back({key, key, 0});
    }
    cursors.push_back({.rows = {{}}, .spans = {{}}});
    return cursors;
}

}  // namespace throng::native
