// What the clips of an asset do to its nodes.
#pragma once

#include <throng/asset.h>

#include <cstddef>
#include <vector>

namespace throng {

inline size_t components(const AssetTrack& track) { return track.target == TrackTarget::kRotation ? 4 : 3; }

inline bool is_tangent(const AssetTrack& track, size_t value) {
    return track.interpolation == Interpolation::kCubicSpline && value % 3 != 1;
}

inline Vec3<double> vector_of(const float* value) { return {value[0], value[1], value[2]}; }

// Whether its node stays in its rest pose, as far as exporters' rounding goes.
bool holds_rest(const Asset& asset, const AssetTrack& track);

struct AnimatedNode {
    bool has_rotation = false, has_translation = false, has_morphs = false;
    bool turns = false, goes = false;  // away from its rest pose
    bool moves = false;                // any of these
    bool changes_length = false;       // its distance to its parent is not that of a bone
};

// [node]
std::vector<AnimatedNode> animated_nodes(const Asset& asset);

}  // namespace throng
