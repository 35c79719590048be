#include "compile/clip/exact_clip.h"

#include <algorithm>

namespace throng {
namespace {

// Appends the clip's keys to those of the character.
void write_keys(const ExactClip& clip, std::span<JointTracks> tracks, Character& character) {
    const auto word = [&](const ExactTrack& of) -> uint32_t& { return tracks[of.joint].*word_of(of.target); };
    std::vector<TrackKey>& keys = character.keys;
    std::vector<const ExactTrack*> columns;
    for (const ExactTrack& track : clip.tracks) {
        if (track.varies()) {
            columns.push_back(&track);
        } else {
            word(track) = static_cast<uint32_t>(keys.size());
            keys.push_back(track.keys[0]);
        }
    }
    for (size_t i = 0; i < columns.size(); ++i)
        word(*columns[i]) = static_cast<uint32_t>(keys.size() + i) | kTrackAnimated |
                            (columns[i]->step ? kTrackStep : 0);
    for (size_t row = 0; row < clip.times_s.size(); ++row)
        for (const ExactTrack* column : columns) keys.push_back(column->keys[row]);
}

}  // namespace

TrackValue ExactTrack::between(const RowCursor& rows) const {
    const TrackValue earlier = at_row(rows.earlier);
    if (step || rows.fraction == 0) return earlier;
    return interpolate_reference(target, earlier, at_row(rows.later), rows.fraction);
}

ExactTrack ExactClip::track(const Rig& rig, uint32_t joint, TrackTarget target) const {
    for (const ExactTrack& of : tracks)
        if (of.joint == joint && of.target == target) return of;
    return {joint, target, false, {key_of(component(rig.rest[joint].as<double>(), target))}};
}

std::vector<Trs<double>> sample_exact(const ExactClip& clip, const Rig& rig, double time_s) {
    const RowCursor rows = find_rows_reference(clip.times_s, time_s);
    std::vector<Trs<double>> pose(rig.joint_count());
    const auto set = [&](size_t joint, TrackTarget target, const TrackValue& earlier, const TrackValue& later) {
        set_component(pose[joint], target, interpolate_reference(target, earlier, later, rows.fraction));
    };
    for (size_t joint = 0; joint < pose.size(); ++joint)
        for (const TrackTarget target : kTrackTargets) {
            const TrackValue rest = component(rig.rest[joint].as<double>(), target);
            set(joint, target, rest, rest);
        }
    for (const ExactTrack& track : clip.tracks)
        set(track.joint, track.target, track.at_row(rows.earlier),
            track.at_row(track.step ? rows.earlier : rows.later));
    return pose;
}

bool is_half_turn(const TrackValue& a, const TrackValue& b) {
    constexpr double kCosine = 1e-4;  // between the quaternions; a float's rounding is a thousand times less
    return std::abs(dot(quaternion_of(a), quaternion_of(b))) < kCosine;
}

uint64_t key_count(const ExactClip& clip, size_t row_count) {
    uint64_t count = 0;
    for (const ExactTrack& track : clip.tracks) count += track.varies() ? row_count : 1;
    return count;
}

Clip& complete_clip(uint32_t index, const ExactClip& from, std::span<const float> times_s, uint64_t size_bytes,
                    Character& character) {
    constexpr uint64_t kRawPose_bytes = 10 * sizeof(float);  // rotation, translation, scale
    const uint64_t joint_count = character.rig.joint_count();
    Clip& clip = character.clips[index];
    clip.first_time = static_cast<uint32_t>(character.times_s.size());
    clip.row_count = static_cast<uint32_t>(times_s.size());
    clip.size_bytes = size_bytes + times_s.size() * sizeof(float) + joint_count * sizeof(JointTracks) +
                      from.root_rows.size() * sizeof(TrackKey);
    clip.raw_size_bytes = from.times_s.size() * joint_count * kRawPose_bytes;
    clip.root_row_count = static_cast<uint32_t>(from.root_rows.size());
    if (clip.root_row_count > 0) clip.first_root_row = static_cast<uint32_t>(character.root_rows.size());
    character.times_s.insert(character.times_s.end(), times_s.begin(), times_s.end());
    character.root_rows.insert(character.root_rows.end(), from.root_rows.begin(), from.root_rows.end());
    return clip;
}

void write_exact(std::span<const ExactClip> clips, Character& character) {
    const uint32_t joint_count = character.rig.joint_count();
    std::vector<JointTracks> rest_tracks(joint_count);
    for (uint32_t joint = 0; joint < joint_count; ++joint)
        for (const TrackTarget target : kTrackTargets) {
            rest_tracks[joint].*word_of(target) = static_cast<uint32_t>(character.keys.size());
            character.keys.push_back(key_of(component(character.rig.rest[joint].as<double>(), target)));
        }
    character.tracks.reserve((clips.size() + 1) * joint_count);
    for (uint32_t index = 0; index < clips.size(); ++index) {
        const ExactClip& clip = clips[index];
        const size_t keys_before = character.keys.size();
        auto& tracks = character.tracks;
        tracks.insert(tracks.end(), rest_tracks.begin(), rest_tracks.end());
        write_keys(clip, std::span(tracks).last(joint_count), character);
        Clip& written = complete_clip(index, clip, clip.times_s, (character.keys.size() - keys_before) * kKey_bytes,
                                      character);
        written.row_stride = written.animated_track_count = static_cast<uint32_t>(
            std::ranges::count_if(clip.tracks, &ExactTrack::varies));
    }
    character.tracks.insert(character.tracks.end(), rest_tracks.begin(), rest_tracks.end());
}

}  // namespace throng
