#include "compile/clip/pack.h"

#include "base/failure.h"
#include "compile/clip/clip_grid.h"
#include "compile/clip/clip_packer.h"
#include "compile/limits.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdio>
#include <future>
#include <map>
#include <mutex>
#include <thread>

namespace throng {
namespace {

constexpr uint64_t kKey_bytes = 16;

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

std::string percent(double part) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.4g %%", part * 100);
    return text;
}

// The clips, put together in their order.
class Packing {
public:
    Packing(Character& character, double error) : character_(character), error_(error) {
        for (const Trs<float>& joint : character.rig.rest)
            rest_.push_back(
                {.rotation = headers_.add(constant_track(TrackTarget::kRotation, key_of(joint.rotation))),
                 .translation = headers_.add(constant_track(TrackTarget::kTranslation, key_of(joint.translation))),
                 .scale = headers_.add(constant_track(TrackTarget::kScale, key_of(joint.scale)))});
    }

    // May come in any order and from any thread; what comes too early waits here.
    void add(uint32_t index, PackedClip packed) {
        const std::lock_guard lock(mutex_);
        waiting_.emplace(index, std::move(packed));
        for (auto next = waiting_.begin(); next != waiting_.end() && next->first == clips_.size();
             next = waiting_.erase(next))
            append(next->second);
    }

    void finish() {
        words_.insert(words_.end(), kPackedWordsBehind, 0);
        tracks_.insert(tracks_.end(), rest_.begin(), rest_.end());
        character_.packed = true;
        character_.clips = std::move(clips_);
        character_.times_s = std::move(times_s_);
        character_.words = std::move(words_);
        character_.tracks = std::move(tracks_);
        character_.keys = headers_.take();
    }

private:
    void append(const PackedClip& packed) {
        Clip clip = character_.clips[clips_.size()];
        const size_t headers_before_bytes = headers_.size_bytes();
        clip.animated_track_count = 0;
        for (const PackedTrack& track : packed.tracks) clip.animated_track_count += packed_row_bits(track) > 0;
        for (uint32_t joint = 0; joint < character_.rig.joint_count(); ++joint) {
            const auto position = [&](TrackTarget target) {
                return headers_.add(packed.tracks[joint * 3 + static_cast<size_t>(target)]);
            };
            JointTracks& row = tracks_.emplace_back();
            row.rotation = position(TrackTarget::kRotation);
            row.translation = position(TrackTarget::kTranslation);
            row.scale = position(TrackTarget::kScale);
        }
        const auto exact_times_s = std::span(character_.times_s).subspan(clip.first_time, clip.row_count);
        clip.dropped_row_count += static_cast<uint32_t>(std::count_if(
            exact_times_s.begin(), exact_times_s.end(),
            [&](float time_s) { return !std::binary_search(packed.times_s.begin(), packed.times_s.end(), time_s); }));
        clip.first_time = static_cast<uint32_t>(times_s_.size());
        clip.row_count = static_cast<uint32_t>(packed.times_s.size());
        clip.row_stride = packed.row_stride;
        clip.first_row = static_cast<uint32_t>(words_.size());
        clip.error = packed.error / double{character_.size};
        clip.size_bytes = packed.words.size() * sizeof(uint32_t) + packed.times_s.size() * sizeof(float) +
                          headers_.size_bytes() - headers_before_bytes +
                          character_.rig.joint_count() * sizeof(JointTracks) +
                          clip.root_row_count * sizeof(character_.root_rows[0]);
        times_s_.insert(times_s_.end(), packed.times_s.begin(), packed.times_s.end());
        words_.insert(words_.end(), packed.words.begin(), packed.words.end());
        check_limit("packed words", (words_.size() + kPackedWordsBehind) * sizeof(uint32_t));
        check_limit("the headers of packed tracks", headers_.size_bytes());
        if (clip.error > error_)
            character_.warnings.push_back("clip '" + printable(clip.name) + "': its packed keys displace the skin by " +
                                          percent(clip.error) + " of the character's size, not " + percent(error_) +
                                          "; finer keys would hardly help");
        clips_.push_back(std::move(clip));
    }

    void check_limit(const char* of, uint64_t size_bytes) const {
        if (size_bytes > kKeyLimit_bytes)
            throw Failure(
                ErrorCode::kLimit, printable(character_.name, 120),
                std::to_string(size_bytes) + " bytes of " + of + "; the limit is " + std::to_string(kKeyLimit_bytes));
    }

    Character& character_;
    const double error_;
    std::mutex mutex_;
    std::map<uint32_t, PackedClip> waiting_;
    HeaderPool headers_;
    std::vector<JointTracks> rest_, tracks_;
    std::vector<Clip> clips_;
    std::vector<float> times_s_;
    std::vector<uint32_t> words_;
};

}  // namespace

void check_error_bound(double error, const std::string& place) {
    if (error == 0 || (error >= 1e-6 && error <= 0.1)) return;
    char text[32];
    std::snprintf(text, sizeof(text), "%g", error);
    throw Failure(
        ErrorCode::kInvalidArgument, place,
        std::string("an error bound of ") + text + "; it is 0 (exact) or 1e-6 to 0.1 of the character's size");
}

void pack_clips(Character& character, double error) {
    uint64_t joint_rows = 0;
    for (const Clip& clip : character.clips) joint_rows += uint64_t{clip.row_count} * character.rig.joint_count();
    if (joint_rows > kPackingLimit)
        throw Failure(ErrorCode::kLimit, printable(character.name, 120),
                      std::to_string(joint_rows) + " poses of a joint in its clips, and the limit of compressing is " +
                          std::to_string(kPackingLimit) + "; exact keys have no such limit (--error exact)");

    // Clips do not depend on each other: the result is the same with any number of threads.
    constexpr size_t kMostThreads = 4;  // each may hold some 100 MiB
    const std::vector<Box> boxes = influence_boxes(character);
    const size_t clip_count = character.clips.size();
    const PackSettings settings{error * double{character.size},
                                std::min(GridSettings().joint_rows, kPackingLimit / std::max<size_t>(1, clip_count))};
    Packing packing(character, error);
    std::atomic<uint32_t> next = 0;
    const auto work = [&] {
        for (uint32_t clip = next++; clip < clip_count; clip = next++)
            packing.add(clip, pack_clip(character, clip, boxes, settings));
    };
    std::vector<std::future<void>> threads;
    const size_t thread_count = std::min(
        {clip_count, kMostThreads, size_t{std::max(1u, std::thread::hardware_concurrency())}});
    for (size_t i = 0; i + 1 < thread_count; ++i) threads.push_back(std::async(std::launch::async, work));
    work();
    for (std::future<void>& thread : threads) thread.get();
    packing.finish();
}

}  // namespace throng
