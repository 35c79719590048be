// Puts packed clips into a character.
#pragma once

#include "compile/clip/clip_packer.h"
#include "compile/clip/exact_clip.h"
#include "compile/clip/packed_track.h"

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

namespace throng {

// Headers of tracks. Equal ones are stored once.
class TrackHeaders {
public:
    explicit TrackHeaders(std::vector<TrackKey>& keys) : keys_(keys) {}

    uint32_t add(const PackedTrack& track);  // returns its position in the keys
    uint64_t size_bytes() const { return keys_.size() * kKey_bytes; }

private:
    std::vector<TrackKey>& keys_;
    std::map<std::array<uint32_t, 8>, uint32_t> positions_;
};

// Completes the clips of a character with packed keys, in the order of `clips`. Keeps the references.
class PackedClipWriter {
public:
    PackedClipWriter(std::span<const ExactClip> clips, double error, Character& character);

    // Can be called in any order and from any thread. A clip waits here until those before it are added.
    void add(uint32_t index, PackedClip packed);
    void finish();

private:
    void append(uint32_t index, const PackedClip& packed);
    void check_limit(const char* of, uint64_t size_bytes) const;

    const std::span<const ExactClip> clips_;
    const double error_;
    Character& character_;
    std::mutex mutex_;
    std::map<uint32_t, PackedClip> waiting_;
    uint32_t written_ = 0;  // clips
    TrackHeaders headers_;
    std::vector<JointTracks> rest_;
};

}  // namespace throng
