#include "compile/clip/root_motion.h"

#include "base/failure.h"
#include "base/message_name.h"
#include "compile/limits.h"
#include "compile/rig/rig.h"
#include "compile/clip/source_track.h"
#include "controller/controller_arrays.h"
#include "json/known_names.h"
#include "control/root_motion_reference.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace throng {
namespace {

constexpr double kRowsPerSecond = 60;
constexpr double kStill = 1e-6;         // of the character's size, or radians: less counts as no motion
constexpr double kFollowed = 1e-4;      // in the same units: how closely keys follow what is left of the joint's motion
constexpr double kUniformScale = 1e-5;  // relative: what converters leave of a uniform scale
// Squared cosine of half the swing: within 0.02 degrees of upside down there is no heading
constexpr double kUpsideDown = 1e-8;

Quaternion<double> conjugate(const Quaternion<double>& q) { return {-q.x, -q.y, -q.z, q.w}; }

Similarity inverse(const Similarity& a) {
    Similarity out{conjugate(a.rotation), {}, 1 / a.scale};
    out.translation = out.vector(a.translation) * -1.0;
    return out;
}

// A turn about +y, then a shift over the ground.
Similarity similarity_of(const GroundMove& move) {
    return {axis_angle(Vec3<double>{0, 1, 0}, std::atan2(move.sin, move.cos)), {move.x, 0, move.z}, 1};
}

// What is left of the joint's motion.
struct Remainder {
    std::vector<float> times_s;
    ExactTrack rotation, translation;
};

struct Extracted {
    std::vector<TrackKey> root_rows;
    Remainder rest;
};

// The joint's motion in one clip.
class JointMotion {
public:
    JointMotion(const ExactClip& clip, const Rig& rig, uint32_t joint, const Similarity& model_from_parent, double size,
                const Progress& progress)
        : progress_(progress),
          times_s_(clip.times_s),
          rotation_(clip.track(rig, joint, TrackTarget::kRotation)),
          translation_(clip.track(rig, joint, TrackTarget::kTranslation)),
          model_from_parent_(model_from_parent),
          parent_from_model_(inverse(model_from_parent)),
          size_(size),
          duration_s_(clip.facts.duration_s),
          begin_(at(0)) {}

    // Returns nothing if the joint does not move over the ground.
    std::optional<Extracted> extract(const std::string& place) {
        if (!moves()) return {};
        constexpr double kRounding = 1e-6;  // relative; the rounding of a float duration must not add a row
        const double row_count = std::max(2.0, std::ceil(duration_s_ * kRowsPerSecond * (1 - kRounding)) + 1);
        if (row_count * sizeof(TrackKey) > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, place,
                          std::to_string(duration_s_) + " s of root motion take more than the limit of " +
                              std::to_string(kKeyLimit_bytes >> 20) + " MiB of rows");
        row_interval_s_ = duration_s_ / (row_count - 1);
        GroundMove move;
        for (size_t row = 0; row < static_cast<size_t>(row_count); ++row) {
            progress_.poll_at(row);
            if (row > 0) move = move_to(at(row_time_s(row)), move);
            rows_.push_back(key_of(TrackValue{move.x, move.z, move.cos, move.sin}));
        }
        Remainder rest = remainder();
        return Extracted{std::move(rows_), std::move(rest)};
    }

private:
    struct Pose {
        Quaternion<double> rotation;  // model space
        Vec3<double> position;
    };

    Pose at(double time_s) const {
        const RowCursor rows = find_rows_reference(times_s_, time_s);
        return {normalized(model_from_parent_.rotation * quaternion_of(rotation_.between(rows))),
                model_from_parent_.point(vector_of(translation_.between(rows)))};
    }

    // The move from the clip's start to this pose. If the joint is upside down, no twist is defined, and the turn stays
    // as in `before`.
    GroundMove move_to(const Pose& pose, const GroundMove& before) const {
        const Quaternion<double> turn = pose.rotation * conjugate(begin_.rotation);
        const double squared = turn.w * turn.w + turn.y * turn.y;
        GroundMove move{.cos = before.cos, .sin = before.sin};
        if (squared > kUpsideDown) {
            move.cos = (turn.w * turn.w - turn.y * turn.y) / squared;
            move.sin = 2 * turn.w * turn.y / squared;
        }
        move.x = pose.position.x - (move.cos * begin_.position.x + move.sin * begin_.position.z);
        move.z = pose.position.z - (-move.sin * begin_.position.x + move.cos * begin_.position.z);
        return move;
    }

    bool moves() const {
        GroundMove move;
        return duration_s_ > 0 && std::ranges::any_of(times_s_, [&](float time_s) {
                   const Pose pose = at(time_s);
                   move = move_to(pose, move);
                   return std::hypot(pose.position.x - begin_.position.x, pose.position.z - begin_.position.z) >=
                              kStill * size_ ||
                          std::abs(std::atan2(move.sin, move.cos)) >= kStill;
               });
    }

    double row_time_s(size_t row) const { return static_cast<double>(row) * row_interval_s_; }

    bool steps() const { return rotation_.step || translation_.step; }

    // The move as it will be read from the rows, so that rows and keys together are exact at each key. STEP tracks
    // jump, so their exact move is taken out instead: rows take a sixtieth of a second for a jump, and a key in the
    // middle of that would hold a part of the jump until the next key.
    GroundMove move_at(double time_s, const Pose& pose) const {
        const GroundMove as_read = place_at(rows_, phase_at(time_s, duration_s_, false));
        return steps() ? move_to(pose, as_read) : as_read;
    }

    struct Residual {
        TrackValue rotation, translation;
    };

    Residual residual_at(double time_s) const {
        const Pose pose = at(time_s);
        const Similarity back = parent_from_model_ * similarity_of(throng::inverse(move_at(time_s, pose)));
        return {value_of(normalized(back.rotation * pose.rotation)), value_of(back.point(pose.position))};
    }

    Remainder remainder() const {
        std::vector<float> times_s;
        // At its first key, the joint also makes up for the interpolation between rows of root motion. Without a key at
        // 0, it would do so from the clip's start
        if (!steps() && times_s_.front() > 0) times_s.push_back(0);
        for (const float time_s : times_s_) {
            if (!times_s.empty() && !steps()) add_between(times_s.back(), time_s, times_s);
            times_s.push_back(time_s);
        }
        std::vector<TrackValue> rotations, translations;
        for (const float time_s : times_s) {
            progress_.poll_at(rotations.size());
            const Residual residual = residual_at(time_s);
            rotations.push_back(residual.rotation);
            translations.push_back(residual.translation);
        }
        join_hemispheres(rotations);
        return {std::move(times_s), track_of(rotation_, kStill, rotations),
                track_of(translation_, kStill * size_ / std::abs(model_from_parent_.scale), translations)};
    }

    // A track of the values; constant if they differ by no more than `bound`.
    static ExactTrack track_of(const ExactTrack& before, double bound, std::span<const TrackValue> values) {
        if (std::ranges::all_of(
                values, [&](const TrackValue& value) { return distance(before.target, values[0], value) <= bound; }))
            values = values.first(1);
        ExactTrack track{before.joint, before.target, before.step, {}};
        for (const TrackValue& value : values) track.keys.push_back(key_of(value));
        return track;
    }

    // Halves an interval between keys until they follow what is left of the motion. New keys lie at times of rows,
    // since between rows the motion hardly bends. Keys half a turn apart get one in the middle.
    void add_between(float from_s, float to_s, std::vector<float>& times_s) const {
        progress_.poll();
        const std::vector<float> rows_s = rows_between(from_s, to_s);
        const Residual from = residual_at(from_s), to = residual_at(to_s);
        float middle_s = from_s;
        if (is_half_turn(from.rotation, to.rotation))
            middle_s = from_s + (to_s - from_s) / 2;
        else if (!follows(from_s, from, to_s, to, rows_s))
            middle_s = rows_s[rows_s.size() / 2];
        if (!(middle_s > from_s && middle_s < to_s)) return;
        add_between(from_s, middle_s, times_s);
        times_s.push_back(middle_s);
        add_between(middle_s, to_s, times_s);
    }

    // The times of the rows between two keys, without those that are nearly at a key.
    std::vector<float> rows_between(float from_s, float to_s) const {
        const double apart_s = 0.01 * row_interval_s_;
        std::vector<float> times_s;
        for (auto row = static_cast<size_t>(from_s / row_interval_s_);
             row < rows_.size() && row_time_s(row) < to_s - apart_s; ++row)
            if (row_time_s(row) > from_s + apart_s) times_s.push_back(static_cast<float>(row_time_s(row)));
        return times_s;
    }

    bool follows(float from_s, const Residual& from, float to_s, const Residual& to,
                 const std::vector<float>& rows_s) const {
        return std::all_of(rows_s.begin(), rows_s.end(), [&](float time_s) {
            const double w = (double{time_s} - from_s) / (double{to_s} - from_s);
            const Residual wanted = residual_at(time_s);
            const auto error = [&](TrackTarget target, TrackValue Residual::*track) {
                return distance(target, interpolate_reference(target, from.*track, to.*track, w), wanted.*track);
            };
            return error(TrackTarget::kRotation, &Residual::rotation) <= kFollowed &&
                   error(TrackTarget::kTranslation, &Residual::translation) * std::abs(model_from_parent_.scale) <=
                       kFollowed * size_;
        });
    }

    const Progress& progress_;
    std::span<const float> times_s_;
    ExactTrack rotation_, translation_;
    Similarity model_from_parent_, parent_from_model_;
    double size_, duration_s_, row_interval_s_ = 0;
    Pose begin_;
    std::vector<TrackKey> rows_;  // of root motion
};

class Extraction {
public:
    Extraction(std::vector<ExactClip>& clips, std::string_view joint_name, Character& character)
        : clips_(clips), character_(character), place_(message_name(character.name) + ": root motion") {
        KnownNames names("joint");
        for (const std::string& name : character.rig.names) names.add(name);
        joint_ = names.require(joint_name, place_);
        for (uint32_t up = character.rig.parents[joint_]; up != kNone; up = character.rig.parents[up])
            ancestors_.insert(ancestors_.begin(), up);
        check_ancestors();
        key_count_ = uint64_t{3} * character.rig.joint_count();
    }

    void run(const Progress& progress) {
        bool moves = false;
        size_t done = 0;
        for (ExactClip& clip : clips_) {
            progress.report(done++, clips_.size());
            JointMotion motion(clip, character_.rig, joint_, model_from_parent(clip), character_.size, progress);
            std::optional<Extracted> extracted = motion.extract(place_);
            if (extracted)
                replace_tracks(clip, std::move(*extracted), progress);
            else
                count_keys(clip, key_count(clip, clip.times_s.size()));
            moves = moves || extracted;
        }
        if (!moves)
            character_.warnings.push_back(printable(character_.name, 120) + ": root motion: joint " + quoted(joint_) +
                                          " does not move over the ground in any clip");
        for (ExactClip& clip : clips_)
            if (moves) std::ranges::stable_sort(clip.tracks, {}, place_in_table);
    }

private:
    std::string quoted(uint32_t joint) const { return "'" + printable(character_.rig.names[joint], 120) + "'"; }

    static std::pair<uint32_t, ptrdiff_t> place_in_table(const ExactTrack& track) {
        return {track.joint, std::ranges::find(kTrackTargets, track.target) - kTrackTargets.begin()};
    }

    void check_ancestors() const {
        std::vector<const ExactClip*> animated_in(character_.rig.joint_count());  // the first clip, or null
        for (const ExactClip& clip : clips_)
            for (const ExactTrack& track : clip.tracks)
                if (track.varies() && !animated_in[track.joint]) animated_in[track.joint] = &clip;
        for (const uint32_t joint : ancestors_)
            if (animated_in[joint])
                throw Failure(ErrorCode::kUnsupported, place_,
                              quoted(joint) + ", above " + quoted(joint_) + ", is animated in clip '" +
                                  printable(animated_in[joint]->facts.name, 120) +
                                  "'; joints above that of root motion must not be animated");
    }

    // Replaces the joint's rotation and translation. The other tracks are sampled at the new rows.
    void replace_tracks(ExactClip& clip, Extracted extracted, const Progress& progress) {
        auto& [times_s, rotation, translation] = extracted.rest;
        std::erase_if(clip.tracks, [&](const ExactTrack& track) {
            return track.joint == joint_ && track.target != TrackTarget::kScale;
        });
        count_keys(clip, key_count(clip, times_s.size()) + rotation.keys.size() + translation.keys.size());
        for (ExactTrack& track : clip.tracks) {
            if (!track.varies()) continue;
            std::vector<TrackKey> keys;
            for (const float time_s : times_s) {
                progress.poll_at(keys.size());
                keys.push_back(key_of(track.between(find_rows_reference(clip.times_s, time_s))));
            }
            track.keys = std::move(keys);
        }
        clip.tracks.push_back(std::move(rotation));
        clip.tracks.push_back(std::move(translation));
        clip.facts.refined_row_count += static_cast<uint32_t>(times_s.size() - clip.times_s.size());
        clip.times_s = std::move(times_s);
        clip.root_rows = std::move(extracted.root_rows);
        root_row_count_ += clip.root_rows.size();
        if (root_row_count_ * sizeof(TrackKey) > kKeyLimit_bytes)
            throw Failure(
                ErrorCode::kLimit, printable(character_.name, 120),
                "root motion takes more than the limit of " + std::to_string(kKeyLimit_bytes >> 20) + " MiB of rows");
    }

    void count_keys(const ExactClip& clip, uint64_t count) {
        key_count_ += count;
        if (key_count_ * kKey_bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, printable(character_.name, 120),
                          "with root motion, clip '" + printable(clip.facts.name, 120) +
                              "' and the clips before have too many keys; the limit is " +
                              std::to_string(kKeyLimit_bytes >> 20) + " MiB per character");
    }

    // Constant in a clip, since nothing above the joint moves.
    Similarity model_from_parent(const ExactClip& clip) const {
        std::vector<Trs<double>> first_pose;
        for (const Trs<float>& rest : character_.rig.rest) first_pose.push_back(rest.as<double>());
        for (const ExactTrack& track : clip.tracks)
            set_component(first_pose[track.joint], track.target, track.at_row(0));
        Similarity out;
        for (const uint32_t joint : ancestors_) {
            const auto value = [&](TrackTarget target) { return component(first_pose[joint], target); };
            const Vec3<double> s = vector_of(value(TrackTarget::kScale));
            const double tolerance = kUniformScale * std::abs(s.x);
            if (s.x == 0 || !(std::abs(s.y - s.x) <= tolerance) || !(std::abs(s.z - s.x) <= tolerance))
                throw Failure(ErrorCode::kUnsupported, place_,
                              quoted(joint) + ", above " + quoted(joint_) + ", is scaled by " + std::to_string(s.x) +
                                  ", " + std::to_string(s.y) + ", " + std::to_string(s.z) +
                                  "; scales above the joint of root motion must be uniform, and not 0");
            out = out * Similarity{normalized(quaternion_of(value(TrackTarget::kRotation))),
                                   vector_of(value(TrackTarget::kTranslation)), s.x};
        }
        return out;
    }

    std::vector<ExactClip>& clips_;
    Character& character_;
    const std::string place_;
    uint32_t joint_ = 0;
    uint64_t key_count_ = 0, root_row_count_ = 0;
    std::vector<uint32_t> ancestors_;  // from the root down
};

}  // namespace

void extract_root_motion(std::vector<ExactClip>& clips, std::string_view joint_name, Character& character,
                         const Progress& progress) {
    Extraction(clips, joint_name, character).run(progress);
}

}  // namespace throng
