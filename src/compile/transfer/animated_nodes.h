// What the clips of an asset do to its nodes.
#pragma once

#include <throng/asset.h>

#include <cstddef>
#include <vector>

namespace throng {

inline size_t components(const AssetTrack& track) { return track.target == TrackTarget::kRotation ? 4 : 3; }

// `value`: the index of a value of the track, or of a row of weights.
inline bool is_tangent(const auto& track, size_t value) {
    return track.interpolation == Interpolation::kCubicSpline && value % 3 != 1;
}

inline Vec3<double> vector_of(const float* value) { return {value[0], value[1], value[2]}; }

// Whether the track leaves its node in the rest pose, apart from exporters' rounding.
bool holds_rest(const Asset& asset, const AssetTrack& track);

struct AnimatedNode {
    bool has_rotation = false, has_translation = false, has_morphs = false;
    bool rotates = false, translates = false;  // away from its rest pose
    bool moves = false;                        // any of its tracks leaves that, or it has morphs
    bool changes_length = false;               // its place relative to its parent varies, unlike a bone's
};

// [node]
std::vector<AnimatedNode> animated_nodes(const Asset& asset);

}  // namespace throng
