// Small assets to compile, and the transforms of their nodes computed only from the glTF specification.
#pragma once

#include <throng/throng.h>

#include <cstdint>
#include <string>
#include <vector>

namespace throng::test {

struct AssetBuilder {
    Asset asset{.name = "built"};

    uint32_t node(uint32_t parent, const Trs<double>& trs = {}) {
        asset.nodes.push_back(
            {.name = "node " + std::to_string(asset.nodes.size()), .parent = parent, .parent_from_node = trs});
        return static_cast<uint32_t>(asset.nodes.size() - 1);
    }
    uint32_t skin(const std::vector<uint32_t>& joints) {
        asset.skins.push_back({.name = "skin", .joints = joints, .inverse_binds = std::vector<Affine>(joints.size())});
        return static_cast<uint32_t>(asset.skins.size() - 1);
    }
    // Adds one triangle. Skinned vertices follow joints 0, 1, 2 of the skin, modulo its size.
    uint32_t mesh(uint32_t node, uint32_t skin_index = kNone, uint32_t influence_count = 4) {
        AssetPrimitive primitive{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}};
        if (skin_index != kNone) {
            primitive.influence_count = influence_count;
            for (uint32_t v = 0; v < 3; ++v)
                for (uint32_t i = 0; i < influence_count; ++i) {
                    primitive.influence_joints.push_back(
                        static_cast<uint16_t>((v + i) % asset.skins[skin_index].joints.size()));
                    primitive.influence_weights.push_back(i == 0 ? 1.0f : 0.0f);
                }
        }
        asset.meshes.push_back({.name = "mesh", .primitives = {primitive}});
        asset.mesh_instances.push_back(
            {.node = node, .mesh = static_cast<uint32_t>(asset.meshes.size() - 1), .skin = skin_index});
        return static_cast<uint32_t>(asset.meshes.size() - 1);
    }
    AssetTrack& track(uint32_t node_index, TrackTarget target, const std::vector<float>& times_s,
                      const std::vector<float>& values, Interpolation interpolation = Interpolation::kLinear) {
        if (asset.clips.empty()) asset.clips.push_back({.name = "clip"});
        AssetClip& clip = asset.clips.back();
        clip.tracks.push_back({.node = node_index,
                               .target = target,
                               .interpolation = interpolation,
                               .times_s = times_s,
                               .values = values});
        clip.duration_s = std::max(clip.duration_s, double{times_s.back()});
        return clip.tracks.back();
    }
};

Trs<double> moved(double x, double y, double z);

// A walking creature of 40 joints, "walker.glb".
Asset walker_asset();

// The error of exact compilation. Fails the test if nothing is refused.
Error refusal_of(const Asset& asset);

// A node's transform at a time of a clip, which may be null, by glTF 2.0, appendix C. Independent of src/compile.
Trs<double> node_trs(const Asset& asset, uint32_t node, const AssetClip* clip, double time_s);
// model_from_node of every node, nothing folded.
std::vector<AffineT<double>> node_models(const Asset& asset, const AssetClip* clip, double time_s);

}  // namespace throng::test
