#include "compile/transfer/animated_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng {
namespace {

// Calls visit(value) for each key.
template <class Visit>
void for_each_key(const AssetTrack& track, const Visit& visit) {
    const size_t width = components(track);
    for (size_t i = 0; i < track.values.size() / width; ++i)
        if (!is_tangent(track, i)) visit(&track.values[i * width]);
}

bool changes_length_of_bone(const AssetTrack& track) {
    constexpr double kSamePlace = 0.01;  // as a part of the distance
    const Vec3<double> first = vector_of(&track.values[track.interpolation == Interpolation::kCubicSpline ? 3 : 0]);
    bool changes = false;
    for_each_key(track, [&](const float* value) {
        changes = changes || length(vector_of(value) - first) > kSamePlace * length(first);
    });
    return changes;
}

}  // namespace

bool holds_rest(const Asset& asset, const AssetTrack& track) {
    constexpr double kRounding = 1e-4;
    const auto& [q, t, s] = asset.nodes[track.node].parent_from_node;
    std::array<double, 4> rest{q.x, q.y, q.z, q.w};
    if (track.target == TrackTarget::kTranslation) rest = {t.x, t.y, t.z, 0};
    if (track.target == TrackTarget::kScale) rest = {s.x, s.y, s.z, 0};
    const size_t width = components(track);
    const auto differs = [&](const float* value, double sign) {
        double difference = 0, size = 1;
        for (size_t c = 0; c < width; ++c) {
            difference = std::max(difference, std::abs(sign * value[c] - rest[c]));
            size = std::max(size, std::abs(rest[c]));
        }
        return difference > kRounding * size;
    };
    bool holds = true;
    for_each_key(track, [&](const float* value) {
        const bool is_negative = track.target == TrackTarget::kRotation && !differs(value, -1);  // the same rotation
        holds = holds && (!differs(value, 1) || is_negative);
    });
    return holds;
}

std::vector<AnimatedNode> animated_nodes(const Asset& asset) {
    std::vector<AnimatedNode> nodes(asset.nodes.size());
    for (const AssetClip& clip : asset.clips) {
        for (const AssetTrack& track : clip.tracks) {
            AnimatedNode& node = nodes[track.node];
            const bool moves = !holds_rest(asset, track);
            node.moves = node.moves || moves;
            if (track.target == TrackTarget::kRotation) {
                node.has_rotation = true;
                node.rotates = node.rotates || moves;
            } else if (track.target == TrackTarget::kTranslation) {
                node.has_translation = true;
                node.translates = node.translates || moves;
                node.changes_length = node.changes_length || changes_length_of_bone(track);
            }
        }
        for (const AssetMorphTrack& track : clip.morph_tracks)
            nodes[track.node].moves = nodes[track.node].has_morphs = true;
    }
    return nodes;
}

}  // namespace throng
