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
    double weight = 1;  // those of a layer sum to 1
};

struct MorphLayer {
    bool is_additive = false;
    double weight = 1;
    std::vector<MorphActiveClip> active_clips;
};

// The weight that a clip gives a morph; none where it does not animate it. Before the first row and after the last,
// that row's.
std::optional<double> morph_weight_reference(const Character& character, uint32_t clip, uint32_t morph, double time_s);

// The weight of every morph, [morph]. Layers lie on the default weights, the lowest first. A clip that does not animate
// a morph counts with its default weight. An override layer goes from what lies below to the weighted sum of its
// active clips, by its weight; morphs that none of its active clips animates keep what lies below. An additive layer
// adds, by its weight, the weighted sum of the differences from the clips' first rows.
std::vector<double> morphs_reference(const Character& character, std::span<const MorphLayer> layers);

// A morph with its weight.
struct WeightedMorph {
    uint32_t morph = 0;
    double weight = 0;
};

// The `limit` largest by magnitude of all weights, [morph], largest first, equals by index; only those above
// kLeastMorphWeight.
std::vector<WeightedMorph> active_morphs_reference(std::span<const double> weights, size_t limit = SIZE_MAX);

// position + sum of weight * difference, in bind space. `morphs`: the active ones.
Vec3<double> morphed_position_reference(const Character& character, const MeshSection& section, uint32_t vertex,
                                        std::span<const WeightedMorph> morphs);

}  // namespace throng
