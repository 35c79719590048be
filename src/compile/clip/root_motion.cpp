#include "compile/clip/root_motion.h"

#include "base/failure.h"
#include "compile/limits.h"
#include "compile/rig/rig.h"
#include "compile/clip/source_track.h"
#include "control/control_reference.h"
#include "controller/controller_arrays.h"
#include "json/known_names.h"
#include "control/root_motion_reference.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace throng {
namespace {

constexpr double kRowsPerSecond = 60;
constexpr double kStill = 1e-6;           // of the character's size, and radians: less is no motion
constexpr double kFollowed = 1e-4;        // likewise: how closely keys follow what is left of the joint's motion
constexpr double kUniformScale = 1e-5;    // relative: what converters leave of a uniform scale
constexpr double kHalfTurnCosine = 1e-4;  // as in clip.cpp
// Squared cosine of half the swing: within 0.02 degrees of upside down there is no heading
constexpr double kUpsideDown = 1e-8;
constexpr uint64_t kRow_bytes = 16;

using Key = std::array<float, 4>;

Quaternion<double> conjugate(const Quaternion<double>& q) { return {-q.x, -q.y, -q.z, q.w}; }
Quaternion<double> rotation_of(const TrackValue& v) { return {v[0], v[1], v[2], v[3]}; }
TrackValue value_of(const Quaternion<double>& q) { return {q.x, q.y, q.z, q.w}; }
Vec3<double> point_of(const TrackValue& v) { return {v[0], v[1], v[2]}; }
TrackValue value_of(const Vec3<double>& v) { return {v.x, v.y, v.z, 0}; }
Key key_of(const TrackValue& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(v[3])};
}
TrackValue value_of(const Key& key) { return {key[0], key[1], key[2], key[3]}; }

Similarity operator*(const Similarity& a, const Similarity& b) {
    return {normalized(a.rotation * b.rotation), a.point(b.translation), a.scale * b.scale};
}
Similarity inverse(const Similarity& a) {
    Similarity out{conjugate(a.rotation), {}, 1 / a.scale};
    out.translation = out.vector(a.translation) * -1.0;
    return out;
}

// A turn about +y, then a shift over the ground.
Similarity similarity_of(const GroundMove& move) {
    return {axis_angle(Vec3<double>{0, 1, 0}, std::atan2(move.sin, move.cos)), {move.x, 0, move.z}, 1};
}

// A clip's exact keys, at any time.
class ExactClip {
public:
    ExactClip(const Character& character, size_t index)
        : character_(character),
          clip_(character.clips[index]),
          times_s_(std::span(character.times_s).subspan(clip_.first_time, clip_.row_count)),
          tracks_(
              std::span(character.tracks).subspan(index * character.rig.joint_count(), character.rig.joint_count())) {}

    const Clip& clip() const { return clip_; }
    std::span<const float> times_s() const { return times_s_; }
    const JointTracks& tracks(size_t joint) const { return tracks_[joint]; }
    Key key(uint32_t word, uint32_t row) const {
        return character_.keys[(word & kTrackPosition) + (word & kTrackAnimated ? size_t{row} * clip_.row_stride : 0)];
    }

    TrackValue at(TrackTarget target, uint32_t word, double time_s) const {
        const RowCursor rows = find_rows_reference(times_s_, time_s);
        const TrackValue earlier = value_of(key(word, rows.earlier)), later = value_of(key(word, rows.later));
        if (rows.fraction == 0) return earlier;
        return interpolate_rows(target, word & kTrackStep ? Interpolation::kStep : Interpolation::kLinear, earlier,
                                later, rows.fraction);
    }

private:
    const Character& character_;
    const Clip& clip_;
    std::span<const float> times_s_;
    std::span<const JointTracks> tracks_;
};

// What is left of the joint's motion; its keys at all rows, or one where it is constant.
struct Remainder {
    std::vector<float> times_s;
    std::vector<TrackValue> rotations, translations;
};

struct Extracted {
    std::vector<Key> root_rows;
    Remainder rest;
};

// The joint's motion in one clip.
class JointMotion {
public:
    JointMotion(const ExactClip& clip, uint32_t joint, const Similarity& model_from_parent, double size)
        : clip_(clip),
          tracks_(clip.tracks(joint)),
          model_from_parent_(model_from_parent),
          parent_from_model_(inverse(model_from_parent)),
          size_(size),
          duration_s_(clip.clip().duration_s),
          begin_(at(0)) {}

    // Nothing where the joint does not move over the ground.
    std::optional<Extracted> extract(const std::string& place) {
        if (!moves()) return {};
        constexpr double kRounding = 1e-6;  // of a float's duration makes no row
        const double row_count = std::max(2.0, std::ceil(duration_s_ * kRowsPerSecond * (1 - kRounding)) + 1);
        if (row_count * kRow_bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, place,
                          std::to_string(duration_s_) + " s of root motion; the limit is " +
                              std::to_string(kKeyLimit_bytes >> 20) + " MiB of rows");
        row_interval_s_ = duration_s_ / (row_count - 1);
        GroundMove move;
        for (size_t row = 0; row < static_cast<size_t>(row_count); ++row) {
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
        return {normalized(model_from_parent_.rotation *
                           rotation_of(clip_.at(TrackTarget::kRotation, tracks_.rotation, time_s))),
                model_from_parent_.point(point_of(clip_.at(TrackTarget::kTranslation, tracks_.translation, time_s)))};
    }

    // From the begin to here; upside down, where no twist is defined, it is turned as before.
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
        return duration_s_ > 0 && std::any_of(clip_.times_s().begin(), clip_.times_s().end(), [&](float time_s) {
                   const Pose pose = at(time_s);
                   move = move_to(pose, move);
                   return std::hypot(pose.position.x - begin_.position.x, pose.position.z - begin_.position.z) >=
                              kStill * size_ ||
                          std::abs(std::atan2(move.sin, move.cos)) >= kStill;
               });
    }

    double row_time_s(size_t row) const { return static_cast<double>(row) * row_interval_s_; }

    bool steps() const { return ((tracks_.rotation | tracks_.translation) & kTrackStep) != 0; }

    // As it will be read from the rows, so that the two together are exact at each key. What jumps is taken out as it
    // is: the rows need a sixtieth of a second for that, and a key in the middle would stay.
    GroundMove move_at(double time_s, const Pose& pose) const {
        const GroundMove as_read = place_at(rows_, phase_at(time_s, duration_s_, false));
        return steps() ? move_to(pose, as_read) : as_read;
    }

    struct Left {
        TrackValue rotation, translation;
    };

    Left left_at(double time_s) const {
        const Pose pose = at(time_s);
        const Similarity back = parent_from_model_ * similarity_of(throng::inverse(move_at(time_s, pose)));
        return {value_of(normalized(back.rotation * pose.rotation)), value_of(back.point(pose.position))};
    }

    Remainder remainder() const {
        Remainder out;
        // How it stands before the first key is no row's rounding
        if (!steps() && clip_.times_s().front() > 0) out.times_s.push_back(0);
        for (const float time_s : clip_.times_s()) {
            if (!out.times_s.empty() && !steps()) add_between(out.times_s.back(), time_s, out.times_s);
            out.times_s.push_back(time_s);
        }
        for (const float time_s : out.times_s) {
            const Left left = left_at(time_s);
            out.rotations.push_back(left.rotation);
            out.translations.push_back(left.translation);
        }
        // Q and -q are one rotation; the sample stage expects neighbours in one hemisphere
        for (size_t row = 1; row < out.rotations.size(); ++row)
            if (dot(rotation_of(out.rotations[row - 1]), rotation_of(out.rotations[row])) < 0)
                out.rotations[row] = value_of(-rotation_of(out.rotations[row]));
        drop_constant(TrackTarget::kRotation, kStill, out.rotations);
        drop_constant(TrackTarget::kTranslation, kStill * size_ / std::abs(model_from_parent_.scale), out.translations);
        return out;
    }

    static void drop_constant(TrackTarget target, double bound, std::vector<TrackValue>& values) {
        if (std::all_of(values.begin(), values.end(),
                        [&](const TrackValue& value) { return distance(target, values[0], value) <= bound; }))
            values.resize(1);
    }

    // Halves an interval between keys, at times of rows (between them the motion hardly bends), until the keys follow
    // what is left of it. Keys half a turn apart get one in the middle, as in clip.cpp.
    void add_between(float from_s, float to_s, std::vector<float>& times_s) const {
        const std::vector<float> rows_s = rows_between(from_s, to_s);
        const Left from = left_at(from_s), to = left_at(to_s);
        float middle_s = from_s;
        if (std::abs(dot(rotation_of(from.rotation), rotation_of(to.rotation))) < kHalfTurnCosine)
            middle_s = from_s + (to_s - from_s) / 2;
        else if (!follows(from_s, from, to_s, to, rows_s))
            middle_s = rows_s[rows_s.size() / 2];
        if (!(middle_s > from_s && middle_s < to_s)) return;
        add_between(from_s, middle_s, times_s);
        times_s.push_back(middle_s);
        add_between(middle_s, to_s, times_s);
    }

    // Times of rows that are no keys.
    std::vector<float> rows_between(float from_s, float to_s) const {
        const double apart_s = 0.01 * row_interval_s_;
        std::vector<float> times_s;
        for (auto row = static_cast<size_t>(from_s / row_interval_s_);
             row < rows_.size() && row_time_s(row) < to_s - apart_s; ++row)
            if (row_time_s(row) > from_s + apart_s) times_s.push_back(static_cast<float>(row_time_s(row)));
        return times_s;
    }

    bool follows(float from_s, const Left& from, float to_s, const Left& to, const std::vector<float>& rows_s) const {
        return std::all_of(rows_s.begin(), rows_s.end(), [&](float time_s) {
            const double w = (double{time_s} - from_s) / (double{to_s} - from_s);
            const Left wanted = left_at(time_s);
            const auto error = [&](TrackTarget target, TrackValue Left::*track) {
                return distance(target, interpolate_rows(target, Interpolation::kLinear, from.*track, to.*track, w),
                                wanted.*track);
            };
            return error(TrackTarget::kRotation, &Left::rotation) <= kFollowed &&
                   error(TrackTarget::kTranslation, &Left::translation) * std::abs(model_from_parent_.scale) <=
                       kFollowed * size_;
        });
    }

    const ExactClip& clip_;
    const JointTracks& tracks_;
    Similarity model_from_parent_, parent_from_model_;
    double size_, duration_s_, row_interval_s_ = 0;
    Pose begin_;
    std::vector<Key> rows_;  // of root motion
};

// Writes the clips anew, with the joint's keys replaced: a track that was constant may have rows now.
class Rewriting {
public:
    Rewriting(Character& character, uint32_t joint)
        : character_(character), joint_(joint), rest_key_count_(3 * character.rig.joint_count()) {
        keys_.assign(character.keys.begin(), character.keys.begin() + rest_key_count_);
        tracks_.reserve(character.tracks.size());
    }

    void add(const ExactClip& from, const Extracted* extracted) {
        Clip clip = from.clip();
        const size_t keys_before = keys_.size();
        const std::span<const float> times_s = extracted ? std::span<const float>(extracted->rest.times_s)
                                                         : from.times_s();
        std::vector<Column> columns;
        for (uint32_t joint = 0; joint < character_.rig.joint_count(); ++joint) {
            JointTracks tracks = from.tracks(joint);
            const Remainder* rest = extracted && joint == joint_ ? &extracted->rest : nullptr;
            const auto at = static_cast<uint32_t>(tracks_.size());
            tracks_.push_back(tracks);
            sort(from,
                 {at, &JointTracks::rotation, TrackTarget::kRotation, tracks.rotation,
                  rest ? &rest->rotations : nullptr},
                 columns);
            sort(from,
                 {at, &JointTracks::translation, TrackTarget::kTranslation, tracks.translation,
                  rest ? &rest->translations : nullptr},
                 columns);
            sort(from, {at, &JointTracks::scale, TrackTarget::kScale, tracks.scale, nullptr}, columns);
        }
        if ((keys_.size() + uint64_t{times_s.size()} * columns.size()) * kRow_bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, printable(character_.name, 120),
                          "clip '" + printable(clip.name, 120) + "' has too many keys with root motion; the limit is " +
                              std::to_string(kKeyLimit_bytes >> 20) + " MiB a character");
        write_rows(from, times_s, columns);
        clip.refined_row_count += static_cast<uint32_t>(times_s.size()) - clip.row_count;
        clip.raw_size_bytes = clip.raw_size_bytes / clip.row_count * times_s.size();
        clip.first_time = static_cast<uint32_t>(times_s_.size());
        clip.row_count = static_cast<uint32_t>(times_s.size());
        clip.row_stride = clip.animated_track_count = static_cast<uint32_t>(columns.size());
        clip.size_bytes = (keys_.size() - keys_before) * kRow_bytes + times_s.size() * sizeof(float) +
                          character_.rig.joint_count() * sizeof(JointTracks);
        times_s_.insert(times_s_.end(), times_s.begin(), times_s.end());
        if (extracted) add_root_rows(clip, extracted->root_rows);
        clips_.push_back(std::move(clip));
    }

    void finish() {
        tracks_.insert(tracks_.end(), character_.tracks.end() - character_.rig.joint_count(), character_.tracks.end());
        character_.clips = std::move(clips_);
        character_.times_s = std::move(times_s_);
        character_.keys = std::move(keys_);
        character_.tracks = std::move(tracks_);
        character_.root_rows = std::move(root_rows_);
    }

private:
    struct Column {
        uint32_t tracks_index;
        uint32_t JointTracks::*word;
        TrackTarget target;
        uint32_t old_word;
        const std::vector<TrackValue>* values;  // instead of those of old_word; one: a constant
    };

    // Constants go to the keys at once; what varies becomes a column.
    void sort(const ExactClip& from, const Column& column, std::vector<Column>& columns) {
        const bool animated = column.values ? column.values->size() > 1 : (column.old_word & kTrackAnimated) != 0;
        if (animated) {
            columns.push_back(column);
        } else if (column.values || column.old_word >= rest_key_count_) {
            tracks_[column.tracks_index].*column.word = static_cast<uint32_t>(keys_.size());
            keys_.push_back(column.values ? key_of(column.values->front()) : from.key(column.old_word, 0));
        }
    }

    void write_rows(const ExactClip& from, std::span<const float> times_s, const std::vector<Column>& columns) {
        for (size_t i = 0; i < columns.size(); ++i)
            tracks_[columns[i].tracks_index].*columns[i].word = static_cast<uint32_t>(keys_.size() + i) |
                                                                kTrackAnimated | (columns[i].old_word & kTrackStep);
        for (size_t row = 0; row < times_s.size(); ++row)
            for (const Column& column : columns)
                keys_.push_back(key_of(column.values ? (*column.values)[row]
                                                     : from.at(column.target, column.old_word, times_s[row])));
    }

    void add_root_rows(Clip& clip, const std::vector<Key>& rows) {
        clip.first_root_row = static_cast<uint32_t>(root_rows_.size());
        clip.root_row_count = static_cast<uint32_t>(rows.size());
        clip.size_bytes += rows.size() * kRow_bytes;
        root_rows_.insert(root_rows_.end(), rows.begin(), rows.end());
        if (root_rows_.size() * kRow_bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, printable(character_.name, 120),
                          "more than " + std::to_string(kKeyLimit_bytes >> 20) + " MiB of rows of root motion");
    }

    Character& character_;
    const uint32_t joint_;
    const uint32_t rest_key_count_;
    std::vector<Key> keys_, root_rows_;
    std::vector<float> times_s_;
    std::vector<JointTracks> tracks_;
    std::vector<Clip> clips_;
};

class Extraction {
public:
    Extraction(Character& character, std::string_view joint_name)
        : character_(character), place_(printable(character.name, 120) + ": root motion") {
        KnownNames names("joint");
        for (const std::string& name : character.rig.names) names.add(name);
        joint_ = names.require(joint_name, place_);
        for (uint32_t up = character.rig.parents[joint_]; up != kNone; up = character.rig.parents[up])
            ancestors_.insert(ancestors_.begin(), up);
        check_ancestors();
    }

    void run() {
        Rewriting rewriting(character_, joint_);
        bool moves = false;
        for (size_t index = 0; index < character_.clips.size(); ++index) {
            const ExactClip clip(character_, index);
            const std::optional<Extracted> extracted =
                JointMotion(clip, joint_, model_from_parent(clip), character_.size).extract(place_);
            moves = moves || extracted;
            rewriting.add(clip, extracted ? &*extracted : nullptr);
        }
        if (moves)
            rewriting.finish();
        else
            character_.warnings.push_back("root motion: joint " + quoted(joint_) + " moves over the ground in no clip");
    }

private:
    std::string quoted(uint32_t joint) const { return "'" + printable(character_.rig.names[joint], 120) + "'"; }

    void check_ancestors() const {
        for (const uint32_t joint : ancestors_)
            for (size_t index = 0; index < character_.clips.size(); ++index) {
                const JointTracks& tracks = ExactClip(character_, index).tracks(joint);
                if ((tracks.rotation | tracks.translation | tracks.scale) & kTrackAnimated)
                    throw Failure(ErrorCode::kUnsupported, place_,
                                  quoted(joint) + ", above " + quoted(joint_) + ", is animated in clip '" +
                                      printable(character_.clips[index].name, 120) +
                                      "'; the joint of root motion has nothing animated above it");
            }
    }

    // What is above the joint does not move.
    Similarity model_from_parent(const ExactClip& clip) const {
        Similarity out;
        for (const uint32_t joint : ancestors_) {
            const JointTracks& tracks = clip.tracks(joint);
            const Vec3<double> s = point_of(value_of(clip.key(tracks.scale, 0)));
            const double tolerance = kUniformScale * std::abs(s.x);
            if (s.x == 0 || !(std::abs(s.y - s.x) <= tolerance) || !(std::abs(s.z - s.x) <= tolerance))
                throw Failure(ErrorCode::kUnsupported, place_,
                              quoted(joint) + ", above " + quoted(joint_) + ", is scaled by " + std::to_string(s.x) +
                                  ", " + std::to_string(s.y) + ", " + std::to_string(s.z) +
                                  "; above the joint of root motion, scales are the same along x, y and z, and not 0");
            out = out * Similarity{normalized(rotation_of(value_of(clip.key(tracks.rotation, 0)))),
                                   point_of(value_of(clip.key(tracks.translation, 0))), s.x};
        }
        return out;
    }

    Character& character_;
    const std::string place_;
    uint32_t joint_ = 0;
    std::vector<uint32_t> ancestors_;  // from the root down
};

}  // namespace

void extract_root_motion(Character& character, std::string_view joint_name) { Extraction(character, joint_name).run(); }

}  // namespace throng
