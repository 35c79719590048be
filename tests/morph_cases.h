// Assets with morph targets, and the weights that their files specify.
#pragma once

#include "tests/test_rig.h"

#include <algorithm>

namespace throng::test {

// The weight by the rules of the file format (glTF 2.0, appendix C), implemented a second time.
inline double weight_of_track(const AssetMorphTrack& track, size_t target_count, size_t target, double time_s) {
    const bool cubic = track.interpolation == Interpolation::kCubicSpline;
    const auto at = [&](size_t key, size_t part) {
        return double{track.values[(key * (cubic ? 3 : 1) + part) * target_count + target]};
    };
    const size_t last = track.times_s.size() - 1, value = cubic ? 1 : 0;
    if (time_s <= track.times_s.front()) return at(0, value);
    if (time_s >= track.times_s.back()) return at(last, value);
    size_t key = 0;
    while (track.times_s[key + 1] <= time_s) ++key;
    const double span_s = double{track.times_s[key + 1]} - track.times_s[key],
                 t = (time_s - track.times_s[key]) / span_s;
    if (track.interpolation == Interpolation::kStep) return at(key, 0);
    if (!cubic) return at(key, 0) + (at(key + 1, 0) - at(key, 0)) * t;
    return (2 * t * t * t - 3 * t * t + 1) * at(key, 1) + span_s * (t * t * t - 2 * t * t + t) * at(key, 2) +
           (3 * t * t - 2 * t * t * t) * at(key + 1, 1) + span_s * (t * t * t - t * t) * at(key + 1, 0);
}

inline const AssetMorphTrack* track_of(const AssetClip& clip, uint32_t node) {
    const auto found = std::ranges::find(clip.morph_tracks, node, &AssetMorphTrack::node);
    return found == clip.morph_tracks.end() ? nullptr : &*found;
}

// One clip of one second that moves one joint and animates the weights in `tracks`. Three targets, of which the first
// moves the first vertex.
inline Asset small_asset(std::vector<AssetMorphTrack> tracks = {}) {
    Asset asset = make_asset({.joint_count = 3, .scale_spread = 0, .clip_count = 2, .vertex_count = 6});
    AssetMesh& mesh = asset.meshes[0];
    mesh.weights = {0, 0.5f, 0};
    mesh.primitives[0].targets.resize(3);
    mesh.primitives[0].targets[0].positions.assign(6, {});
    mesh.primitives[0].targets[0].positions[0] = {1, 2, 3};
    mesh.primitives[0].targets[1].normals.assign(6, {});
    mesh.primitives[0].targets[1].normals[3] = {0, -2, 0.5f};
    asset.mesh_instances[1].node = 1;
    asset.clips[0].morph_tracks = std::move(tracks);
    return asset;
}

}  // namespace throng::test
