#include "compile/clip/packed_clip_writer.h"

#include "base/failure.h"
#include "compile/limits.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <string>
#include <utility>

namespace throng {
namespace {

std::string percent(double part) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.4g %%", part * 100);
    return text;
}

}  // namespace

uint32_t TrackHeaders::add(const PackedTrack& track) {
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

PackedClipWriter::PackedClipWriter(std::span<const ExactClip> clips, double error, Character& character)
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

void PackedClipWriter::add(uint32_t index, PackedClip packed) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace(index, std::move(packed));
    for (auto next = waiting_.begin(); next != waiting_.end() && next->first == written_; next = waiting_.erase(next))
        append(written_++, next->second);
}

void PackedClipWriter::finish() {
    character_.words.insert(character_.words.end(), kPackedWordsBehind, 0);
    character_.tracks.insert(character_.tracks.end(), rest_.begin(), rest_.end());
}

void PackedClipWriter::append(uint32_t index, const PackedClip& packed) {
    const ExactClip& exact = clips_[index];
    const uint64_t headers_before_bytes = headers_.size_bytes();
    for (uint32_t joint = 0; joint < character_.rig.joint_count(); ++joint) {
        JointTracks& tracks = character_.tracks.emplace_back();
        for (const TrackTarget target : kTrackTargets)
            tracks.*word_of(target) = headers_.add(packed.tracks[joint * 3 + static_cast<size_t>(target)]);
    }
    const uint64_t size_bytes = packed.words.size() * sizeof(uint32_t) + headers_.size_bytes() - headers_before_bytes;
    Clip& clip = complete_clip(index, exact, packed.times_s, size_bytes, character_);
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
                                             " of the character's size, more than the error bound of ", percent(error_),
                                             "; finer keys would hardly help, exact keys (error 0) would"));
}

void PackedClipWriter::check_limit(const char* of, uint64_t size_bytes) const {
    if (size_bytes > kKeyLimit_bytes)
        throw Failure(ErrorCode::kLimit, printable(character_.name, 120), of, " take ", size_bytes,
                      " bytes; the limit is ", kKeyLimit_bytes);
}

}  // namespace throng
