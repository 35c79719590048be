#include "compile/pack.h"

#include "base/failure.h"
#include "compile/clip_packer.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdio>
#include <future>
#include <map>
#include <thread>

namespace throng {
namespace {

constexpr uint64_t kKey_bytes = 16;
constexpr uint32_t kWordsBehind = 3;  // decoding reads three words from the one in which a track begins

// Headers, each once.
class HeaderPool {
public:
    uint32_t add(const PackedTrack& track) {
        auto pattern = std::bit_cast<std::array<uint32_t, 8>>(track);
        const bool constant = packed_row_bits(track) == 0;
        if (constant) std::fill(pattern.begin() + 4, pattern.end(), 0);
        const auto [at, is_new] = positions_.try_emplace(pattern, static_cast<uint32_t>(keys_.size()));
        if (is_new) {
            const auto both = std::bit_cast<std::array<std::array<float, 4>, 2>>(track);
            keys_.insert(keys_.end(), both.begin(), both.end() - (constant ? 1 : 0));
        }
        return at->second;
    }

    size_t size_bytes() const { return keys_.size() * kKey_bytes; }
    std::vector<std::array<float, 4>> take() { return std::move(keys_); }

private:
    std::map<std::array<uint32_t, 8>, uint32_t> positions_;
    std::vector<std::array<float, 4>> keys_;
};

TrackKey key_of(const Quaternion<float>& q) {
    const Quaternion<float> unit = normalized(q.as<double>()).as<float>();
    return {unit.x, unit.y, unit.z, unit.w};
}
TrackKey key_of(const Vec3<float>& v) { return {v.x, v.y, v.z, 0}; }

// Clips do not depend on each other: the result is the same with any number of threads.
std::vector<PackedClip> pack_all(const Character& character, double bound) {
    constexpr size_t kMostThreads = 4;  // each may hold some 100 MiB
    const std::vector<Box> boxes = influence_boxes(character);
    std::vector<PackedClip> packed(character.clips.size());
    std::atomic<uint32_t> next = 0;
    const auto work = [&] {
        for (uint32_t clip = next++; clip < packed.size(); clip = next++) packed[clip] = pack_clip(character, clip, boxes, bound);
    };
    std::vector<std::future<void>> threads;
    const size_t thread_count = std::min({packed.size(), kMostThreads, size_t{std::max(1u, std::thread::hardware_concurrency())}});
    for (size_t i = 0; i + 1 < thread_count; ++i) threads.push_back(std::async(std::launch::async, work));
    work();
    for (std::future<void>& thread : threads) thread.get();
    return packed;
}

std::string percent(double part) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.4g %%", part * 100);
    return text;
}

}  // namespace

void check_error_bound(double error, const std::string& place) {
    if (error == 0 || (error >= 1e-6 && error <= 0.1)) return;
    char text[32];
    std::snprintf(text, sizeof(text), "%g", error);
    throw Failure(ErrorCode::kInvalidArgument, place, std::string("an error bound of ") + text + "; it is 0 (exact) or 1e-6 to 0.1 of the character's size");
}

void pack_clips(Character& character, double error) {
    const std::vector<PackedClip> packed_clips = pack_all(character, error * double{character.size});
    HeaderPool headers;
    std::vector<JointTracks> rest;
    for (const Trs<float>& joint : character.rig.rest)
        rest.push_back({.rotation = headers.add(constant_track(TrackTarget::kRotation, key_of(joint.rotation))),
                        .translation = headers.add(constant_track(TrackTarget::kTranslation, key_of(joint.translation))),
                        .scale = headers.add(constant_track(TrackTarget::kScale, key_of(joint.scale)))});

    std::vector<JointTracks> tracks;
    std::vector<Clip> clips = character.clips;
    std::vector<float> times_s;
    std::vector<uint32_t> words;
    for (uint32_t index = 0; index < clips.size(); ++index) {
        Clip& clip = clips[index];
        const PackedClip& packed = packed_clips[index];
        const size_t headers_before_bytes = headers.size_bytes();
        clip.animated_track_count = 0;
        for (const PackedTrack& track : packed.tracks) clip.animated_track_count += packed_row_bits(track) > 0;
        for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
            const auto position = [&](TrackTarget target) { return headers.add(packed.tracks[joint * 3 + static_cast<size_t>(target)]); };
            JointTracks& row = tracks.emplace_back();
            row.rotation = position(TrackTarget::kRotation);
            row.translation = position(TrackTarget::kTranslation);
            row.scale = position(TrackTarget::kScale);
        }
        const auto exact_times_s = std::span(character.times_s).subspan(clip.first_time, clip.row_count);
        clip.dropped_row_count += static_cast<uint32_t>(std::count_if(exact_times_s.begin(), exact_times_s.end(), [&](float time_s) {
            return !std::binary_search(packed.times_s.begin(), packed.times_s.end(), time_s);
        }));
        clip.first_time = static_cast<uint32_t>(times_s.size());
        clip.row_count = static_cast<uint32_t>(packed.times_s.size());
        clip.row_stride = packed.row_stride;
        clip.first_row = static_cast<uint32_t>(words.size());
        clip.error = packed.error / double{character.size};
        clip.size_bytes = packed.words.size() * sizeof(uint32_t) + packed.times_s.size() * sizeof(float) + headers.size_bytes() - headers_before_bytes +
                          character.rig.joint_count() * sizeof(JointTracks);
        times_s.insert(times_s.end(), packed.times_s.begin(), packed.times_s.end());
        words.insert(words.end(), packed.words.begin(), packed.words.end());
        if (clip.error > error)
            character.warnings.push_back("clip '" + clip.name + "': its packed keys displace the skin by " + percent(clip.error) +
                                         " of the character's size, not " + percent(error) + "; they cannot be finer");
    }
    words.insert(words.end(), kWordsBehind, 0);
    tracks.insert(tracks.end(), rest.begin(), rest.end());
    character.packed = true;
    character.clips = std::move(clips);
    character.times_s = std::move(times_s);
    character.words = std::move(words);
    character.tracks = std::move(tracks);
    character.keys = headers.take();
}

}  // namespace throng
