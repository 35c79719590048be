#include "compile/clip/pack.h"

#include "base/failure.h"
#include "base/processor.h"
#include "compile/clip/clip_grid.h"
#include "compile/clip/clip_packer.h"
#include "compile/clip/packed_track.h"
#include "compile/limits.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstdio>
#include <future>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>

namespace throng {
namespace {

// Headers of tracks. Equal ones are stored once.
class HeaderPool {
public:
    explicit HeaderPool(std::vector<TrackKey>& keys) : keys_(keys) {}

    uint32_t add(const PackedTrack& track) {
        auto pattern = std::bit_cast<std::array<uint32_t, 8>>(track);
        const bool constant = packed_row_bits(track) == 0;
        if (constant) std::fill(pattern.begin() + 4, pattern.end(), 0);
        const auto [at, is_new] = positions_.try_emplace(pattern, static_cast<uint32_t>(keys_.size()));
        if (is_new) {
            const auto both = std::bit_cast<std::array<TrackKey, 2>>(track);
            keys_.insert(keys_.end(), both.begin(), both.end() - (constant ? 1 : 0));
        }
        return at->second;
    }

    uint64_t size_bytes() const { return keys_.size() * kKey_bytes; }

private:
    std::vector<TrackKey>& keys_;
    std::map<std::array<uint32_t, 8>, uint32_t> positions_;
};

std::string percent(double part) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.4g %%", part * 100);
    return text;
}

// Appends the packed clips to the character, in the order of `clips`.
class Packing {
public:
    Packing(std::span<const ExactClip> clips, double error, Character& character)
        : clips_(clips), error_(error), character_(character), headers_(character.keys) {
        character.packed = true;
        for (const Trs<float>& rest : character.rig.rest) {
            Trs<double> joint = rest.as<double>();
            joint.rotation = normalized(joint.rotation);
            JointTracks& tracks = rest_.emplace_back();
            for (const TrackTarget target : kTrackTargets)
                tracks.*word_of(target) = headers_.add(constant_track(target, key_of(component(joint, target))));
        }
    }

    // Can be called in any order and from any thread. A clip waits here until those before it are added.
    void add(uint32_t index, PackedClip packed) {
        const std::lock_guard lock(mutex_);
        waiting_.emplace(index, std::move(packed));
        for (auto next = waiting_.begin(); next != waiting_.end() && next->first == character_.clips.size();
             next = waiting_.erase(next))
            append(clips_[next->first], next->second);
    }

    void finish() {
        character_.words.insert(character_.words.end(), kPackedWordsBehind, 0);
        character_.tracks.insert(character_.tracks.end(), rest_.begin(), rest_.end());
    }

private:
    void append(const ExactClip& exact, const PackedClip& packed) {
        const uint64_t headers_before_bytes = headers_.size_bytes();
        for (uint32_t joint = 0; joint < character_.rig.joint_count(); ++joint) {
            JointTracks& tracks = character_.tracks.emplace_back();
            for (const TrackTarget target : kTrackTargets)
                tracks.*word_of(target) = headers_.add(packed.tracks[joint * 3 + static_cast<size_t>(target)]);
        }
        const uint64_t size_bytes = packed.words.size() * sizeof(uint32_t) + headers_.size_bytes() -
                                    headers_before_bytes;
        Clip& clip = append_clip(exact, packed.times_s, size_bytes, character_);
        clip.animated_track_count = static_cast<uint32_t>(
            std::ranges::count_if(packed.tracks, [](const PackedTrack& track) { return packed_row_bits(track) > 0; }));
        clip.dropped_row_count += static_cast<uint32_t>(std::ranges::count_if(
            exact.times_s, [&](float time_s) { return !std::ranges::binary_search(packed.times_s, time_s); }));
        std::vector<uint32_t>& words = character_.words;
        clip.row_stride = packed.row_stride;
        clip.first_row = static_cast<uint32_t>(words.size());
        clip.error = packed.error / double{character_.size};
        words.insert(words.end(), packed.words.begin(), packed.words.end());
        check_limit("packed words", (words.size() + kPackedWordsBehind) * sizeof(uint32_t));
        check_limit("the headers of packed tracks", headers_.size_bytes());
        if (clip.error > error_)
            character_.warnings.push_back(joined(printable(character_.name, 120), ": clip '", printable(clip.name),
                                                 "': its packed keys displace the skin by ", percent(clip.error),
                                                 " of the character's size, more than the error bound of ",
                                                 percent(error_),
                                                 "; finer keys would hardly help, exact keys (error 0) would"));
    }

    void check_limit(const char* of, uint64_t size_bytes) const {
        if (size_bytes > kKeyLimit_bytes)
            throw Failure(ErrorCode::kLimit, printable(character_.name, 120), of, " take ", size_bytes,
                          " bytes; the limit is ", kKeyLimit_bytes);
    }

    const std::span<const ExactClip> clips_;
    const double error_;
    Character& character_;
    std::mutex mutex_;
    std::map<uint32_t, PackedClip> waiting_;
    HeaderPool headers_;
    std::vector<JointTracks> rest_;
};

}  // namespace

void check_error_bound(double error, const std::string& place) {
    if (error == 0 || (error >= 1e-6 && error <= 0.1)) return;
    char text[32];
    std::snprintf(text, sizeof(text), "%g", error);
    throw Failure(
        ErrorCode::kInvalidArgument, place,
        std::string("the error bound is ") + text + "; it must be 0 (exact) or 1e-6 to 0.1 of the character's size");
}

void pack_clips(std::span<const ExactClip> clips, double error, Character& character, const Progress& progress) {
    uint64_t row_count = 0;
    for (const ExactClip& clip : clips) row_count += clip.times_s.size();
    const uint64_t joint_rows = row_count * character.rig.joint_count();
    if (joint_rows > kPackingLimit)
        throw Failure(ErrorCode::kLimit, printable(character.name, 120), "its clips have ", joint_rows,
                      " poses of a joint (rows times joints); the limit for packing is ", kPackingLimit,
                      "; exact keys have no such limit (error 0, or --error exact)");

    // Clips do not depend on each other: the result is the same with any number of threads.
    constexpr size_t kMaxThreads = 4;  // each may hold some 100 MiB
    constexpr std::chrono::milliseconds kReportInterval(10);
    const std::vector<Box> boxes = influence_boxes(character);
    const size_t clip_count = clips.size();
    const PackSettings settings{error * double{character.size},
                                std::min(GridSettings().joint_rows, kPackingLimit / std::max<size_t>(1, clip_count))};
    Packing packing(clips, error, character);
    std::atomic<size_t> next = 0, rows_done = 0;
    const auto report = [&] { progress.report(rows_done, row_count); };
    const auto work = [&] {
        try {
            for (size_t clip = next++; clip < clip_count; clip = next++) {
                report();
                packing.add(static_cast<uint32_t>(clip), pack_clip(character, clips[clip], boxes, settings, progress));
                rows_done += clips[clip].times_s.size();
            }
        } catch (...) {
            next = clip_count;  // the other threads need not begin more
            throw;
        }
    };
    std::vector<std::future<void>> threads;
    const size_t thread_count = std::min({clip_count, kMaxThreads, size_t{processor_threads()}});
    try {
        for (size_t i = 0; i + 1 < thread_count; ++i) threads.push_back(std::async(std::launch::async, work));
    } catch (const std::system_error&) {
        // The system can start no more threads: those that run do all of the work
    }
    work();
    for (std::future<void>& thread : threads) {
        while (thread.wait_for(kReportInterval) != std::future_status::ready) report();
        thread.get();
    }
    packing.finish();
}

}  // namespace throng
