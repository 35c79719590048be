// The definition of the morph stage.
#pragma once

#include <throng/character.h>

#include <optional>
#include <span>
#include <vector>

namespace throng {

// A clip as part of an instance's morphs.
struct MorphActiveClip {
    uint32_t clip = 0;  // clip_count: the rest pose
    double time_s = 0;
    double weight = 1;  // the weights of a layer sum to 1
};

struct MorphLayer {
    bool is_additive = false;
    double weight = 1;
    std::vector<MorphActiveClip> active_clips;
};

// The weight that a clip gives a morph; none if it does not animate it. Times outside the rows get the first or last
// row's weight.
std::optional<double> morph_weight_reference(const Character& character, uint32_t clip, uint32_t morph, double time_s);

// The weight of every morph, [morph]. Layers are applied over the default weights, the lowest first. A clip that does
// not animate a morph contributes the morph's default weight. An override layer blends, by its weight, from the result
// of the layers below to the weighted sum of its active clips; morphs that none of them animates stay as they were. An
// additive layer adds, by its weight, the weighted sum of the differences from the clips' first rows.
std::vector<double> morphs_reference(const Character& character, std::span<const MorphLayer> layers);

struct WeightedMorph {
    uint32_t morph = 0;
    double weight = 0;
};

// The up to `limit` morphs of largest magnitude, largest first, ties by index. Leaves out magnitudes up to
// kMinMorphWeight. `weights`: [morph].
std::vector<WeightedMorph> active_morphs_reference(std::span<const double> weights, size_t limit = SIZE_MAX);

// position + sum of weight * difference, in bind space. `morphs`: the active morphs.
Vec3<double> morphed_position_reference(const Character& character, const MeshSection& section, uint32_t vertex,
                                        std::span<const WeightedMorph> morphs);

}  // namespace throng
