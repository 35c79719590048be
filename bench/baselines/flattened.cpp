#include "bench/baselines/baselines.h"

#include "bench/value_of.h"
#include "sample/sample_reference.h"
#include "scan/scan_reference.h"

#include <algorithm>

namespace throng::bench {
namespace {

constexpr uint32_t kPlain[] = {
#include "bench/flattened.inc"
};
constexpr uint32_t kSoftware[] = {
#include "bench/flattened.software.inc"
};

using Key = std::array<float, 4>;
using Pose = std::vector<Trs<double>>;

// model_from_joint of every joint. Exact if scales do not shear; otherwise only the scale along the joint's axes.
Pose model_pose(const Character& character, uint32_t clip, double time_s) {
    Pose pose = sample_reference(character, clip, time_s);
    std::vector<AffineT<double>> local;
    for (const Trs<double>& joint : pose) local.push_back(to_affine(joint));
    const std::vector<AffineT<double>> model = scan_reference(character.rig.parents, local);
    for (size_t joint = 0; joint < pose.size(); ++joint) {
        Trs<double>& trs = pose[joint];
        if (const uint32_t parent = character.rig.parents[joint]; parent != kNone)
            trs.rotation = normalized(pose[parent].rotation * trs.rotation);
        const Quaternion<double>& q = trs.rotation;
        const AffineT<double> scale = to_affine(Trs<double>{.rotation = {-q.x, -q.y, -q.z, q.w}}) * model[joint];
        trs.translation = {model[joint].row[0][3], model[joint].row[1][3], model[joint].row[2][3]};
        trs.scale = {scale.row[0][0], scale.row[1][1], scale.row[2][2]};
    }
    return pose;
}

// A joint's three keys, the rotation in the hemisphere of `before`.
std::array<Key, 3> keys_of(const Trs<double>& trs, const Key& before) {
    const Quaternion<double> last{before[0], before[1], before[2], before[3]};
    const auto q = (dot(trs.rotation, last) < 0 ? -trs.rotation : trs.rotation).as<float>();
    const auto t = trs.translation.as<float>(), s = trs.scale.as<float>();
    return {{{q.x, q.y, q.z, q.w}, {t.x, t.y, t.z, 0}, {s.x, s.y, s.z, 0}}};
}

// Appends the clip's keys; a track whose rows are all equal is stored once, as throng does.
void append_clip(Character& flat, const Character& character, uint32_t clip_index) {
    Clip& clip = flat.clips[clip_index];
    const size_t joint_count = character.rig.joint_count(), first_key = flat.keys.size();
    std::vector<std::vector<Key>> rows(3 * joint_count);  // [joint and target][row]
    for (uint32_t row = 0; row < clip.row_count; ++row) {
        const Pose pose = model_pose(character, clip_index, character.times_s[clip.first_time + row]);
        for (size_t joint = 0; joint < joint_count; ++joint) {
            const auto keys = keys_of(pose[joint], row > 0 ? rows[3 * joint].back() : Key{});
            for (size_t target = 0; target < 3; ++target) rows[3 * joint + target].push_back(keys[target]);
        }
    }
    std::vector<size_t> columns;
    std::vector<uint32_t> words;
    for (size_t track = 0; track < rows.size(); ++track) {
        const bool constant = std::all_of(rows[track].begin(), rows[track].end(),
                                          [&](const Key& key) { return key == rows[track].front(); });
        words.push_back(constant ? static_cast<uint32_t>(flat.keys.size())
                                 : static_cast<uint32_t>(columns.size()) | kTrackAnimated);
        if (constant)
            flat.keys.push_back(rows[track].front());
        else
            columns.push_back(track);
    }
    const auto first_row = static_cast<uint32_t>(flat.keys.size());
    for (uint32_t& word : words)
        if (word & kTrackAnimated) word += first_row;
    for (size_t track = 0; track < words.size(); track += 3)
        flat.tracks.push_back({.rotation = words[track], .translation = words[track + 1], .scale = words[track + 2]});
    for (uint32_t row = 0; row < clip.row_count; ++row)
        for (const size_t column : columns) flat.keys.push_back(rows[column][row]);
    clip.row_stride = static_cast<uint32_t>(columns.size());
    clip.size_bytes = (flat.keys.size() - first_key) * sizeof(Key) + clip.row_count * sizeof(float) +
                      joint_count * sizeof(JointTracks);
}

// Makes a character whose joints are all roots. Its clips hold the model-space poses at the rows of the original clips.
Character bake(const Character& character, const BakeSettings& settings) {
    Character flat{.name = character.name + ", flattened",
                   .rig = character.rig,
                   .clips = character.clips,
                   .times_s = character.times_s,
                   .palette = character.palette,
                   .size = character.size};
    std::fill(flat.rig.parents.begin(), flat.rig.parents.end(), kNone);
    for (uint32_t clip = 0; clip < flat.clips.size(); ++clip) {
        append_clip(flat, character, clip);
        check_key_bytes(character, "flattened", flat.keys.size() * sizeof(Key), settings);
    }
    for (const Trs<double>& joint : model_pose(character, static_cast<uint32_t>(flat.clips.size()), 0)) {
        const auto first = static_cast<uint32_t>(flat.keys.size());
        flat.tracks.push_back({.rotation = first, .translation = first + 1, .scale = first + 2});
        for (const Key& key : keys_of(joint, {})) flat.keys.push_back(key);
    }
    return flat;
}

std::vector<AffineT<double>> skin_matrices(const Character& flat, const Playback& playback) {
    return value_of(reference_pose(flat, playback)).model_from_bind;
}

}  // namespace

Baseline flattened() {
    return {.name = "flattened",
            .summary = "clips hold model-space poses; sampled, blended and bound without a hierarchy",
            .source = "J. Shopf, J. Barczak, C. Oat, N. Tatarchuk, March of the Froblins, SIGGRAPH course notes, 2008",
            .bake = bake,
            .skin_matrices = skin_matrices,
            .plain = kPlain,
            .software = kSoftware};
}

}  // namespace throng::bench
