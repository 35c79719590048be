#include "bench/baselines/baselines.h"

#include "bench/value_of.h"
#include "control/control_reference.h"

#include <algorithm>

namespace throng::bench {
namespace {

constexpr uint32_t kPlain[] = {
#include "bench/baked.inc"
};
constexpr uint32_t kSoftware[] = {
#include "bench/baked.software.inc"
};

using Matrices = std::vector<AffineT<double>>;

// Divides the clip's duration into equal parts, so that a loop closes on a frame.
uint32_t frame_count(const Clip& clip, double rate) {
    constexpr double kRounding = 1e-6;  // of a frame: durations are floats
    return clip.duration_s > 0 ? 1 + std::max(1u, static_cast<uint32_t>(std::ceil(clip.duration_s * rate - kRounding)))
                               : 1;
}

// A matrix takes three keys; Clip::row_stride and the tracks, one per clip, count matrices.
void append_frame(Character& baked, const Character& character, const ClipPlayback& play) {
    const ReferencePose pose = value_of(reference_pose(character, {.first = play}));
    for (const AffineT<double>& model_from_bind : pose.model_from_bind)
        for (const auto& row : model_from_bind.as<float>().row) baked.keys.push_back(row);
}

Character bake(const Character& character, const BakeSettings& settings) {
    const auto palette_count = static_cast<uint32_t>(character.palette.size());
    uint64_t frames = 1;
    for (const Clip& clip : character.clips) frames += frame_count(clip, settings.rate);
    check_key_bytes(character, "baked", frames * palette_count * sizeof(Affine), settings);

    Character baked{.name = character.name + ", baked", .palette = character.palette, .size = character.size};
    for (uint32_t c = 0; c < character.clips.size(); ++c) {
        const Clip& from = character.clips[c];
        Clip clip{.name = from.name,
                  .duration_s = from.duration_s,
                  .first_time = static_cast<uint32_t>(baked.times_s.size()),
                  .row_count = frame_count(from, settings.rate),
                  .row_stride = palette_count};
        clip.size_bytes = uint64_t{clip.row_count} * (palette_count * sizeof(Affine) + sizeof(float)) +
                          sizeof(JointTracks);
        baked.tracks.push_back({.rotation = static_cast<uint32_t>(baked.keys.size() / 3)});
        for (uint32_t frame = 0; frame < clip.row_count; ++frame) {
            const auto time_s = static_cast<float>(
                clip.row_count > 1 ? double{clip.duration_s} * frame / (clip.row_count - 1) : 0);
            baked.times_s.push_back(time_s);
            append_frame(baked, character, {.clip = c, .time_s = time_s, .loop = false});
        }
        baked.clips.push_back(std::move(clip));
    }
    baked.tracks.push_back({.rotation = static_cast<uint32_t>(baked.keys.size() / 3)});
    append_frame(baked, character, {});
    return baked;
}

AffineT<double> mix(const AffineT<double>& a, const AffineT<double>& b, double w) {
    AffineT<double> out;
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 4; ++column)
            out.row[row][column] = (1 - w) * a.row[row][column] + w * b.row[row][column];
    return out;
}

Matrices sample(const Character& baked, const ClipPlayback& play) {
    RowCursor frames;
    const size_t palette_count = baked.palette.size();
    if (play.clip != kNone) {
        const Clip& clip = baked.clips[play.clip];
        frames = find_rows_reference(std::span(baked.times_s).subspan(clip.first_time, clip.row_count),
                                     local_time_reference(play.time_s, clip.duration_s, play.loop));
    }
    const size_t first = play.clip == kNone ? baked.tracks.back().rotation : baked.tracks[play.clip].rotation;
    const auto matrix = [&](uint32_t frame, size_t entry) {
        const size_t key = 3 * (first + frame * palette_count + entry);
        return Affine{{baked.keys[key], baked.keys[key + 1], baked.keys[key + 2]}}.as<double>();
    };
    Matrices out;
    for (size_t entry = 0; entry < palette_count; ++entry)
        out.push_back(mix(matrix(frames.earlier, entry), matrix(frames.later, entry), frames.fraction));
    return out;
}

Matrices skin_matrices(const Character& baked, const Playback& playback) {
    Matrices out = sample(baked, playback.first);
    const Matrices second = sample(baked, playback.second);
    for (size_t entry = 0; entry < out.size(); ++entry) out[entry] = mix(second[entry], out[entry], playback.weight);
    return out;
}

}  // namespace

Baseline baked() {
    return {.name = "baked",
            .summary = "skin matrices stored for every frame; two frames interpolated",
            .source = "B. Dudash, Skinned Instancing, NVIDIA white paper, 2007",
            .bake = bake,
            .skin_matrices = skin_matrices,
            .plain = kPlain,
            .software = kSoftware};
}

void check_key_bytes(const Character& character, std::string_view method, uint64_t key_bytes,
                     const BakeSettings& settings) {
    if (key_bytes > settings.limit_bytes)
        throw Failure(ErrorCode::kLimit, character.name,
                      std::to_string(key_bytes) + " bytes of " + std::string(method) +
                          " clips exceed the device's storage-buffer range of " + std::to_string(settings.limit_bytes) +
                          " bytes");
}

}  // namespace throng::bench
