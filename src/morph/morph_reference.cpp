#include "morph/morph_reference.h"

#include "control/control_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

double layer_on(const Character& character, const MorphLayer& layer, uint32_t morph, double below) {
    const double otherwise = double{character.morphs[morph].default_weight};
    double sum = 0;
    bool is_touched = false;
    for (const MorphActiveClip& active_clip : layer.active_clips) {
        const std::optional<double> weight = morph_weight_reference(character, active_clip.clip, morph,
                                                                    active_clip.time_s);
        if (!weight) continue;
        is_touched = true;
        sum += active_clip.weight *
               (*weight -
                (layer.is_additive ? *morph_weight_reference(character, active_clip.clip, morph, 0) : otherwise));
    }
    if (layer.is_additive) return below + layer.weight * sum;
    return is_touched ? below + layer.weight * (otherwise + sum - below) : below;
}

}  // namespace

std::optional<double> morph_weight_reference(const Character& character, uint32_t clip_index, uint32_t morph,
                                             double time_s) {
    if (clip_index >= character.clips.size()) return std::nullopt;
    const Clip& clip = character.clips[clip_index];
    const uint32_t word = character.morph_tracks[clip_index * character.morphs.size() + morph];
    if (word == kNone) return std::nullopt;
    const float* values = &character.morph_values[word & kTrackPosition];
    if ((word & kTrackAnimated) == 0) return double{*values};
    const RowCursor rows = find_rows_reference(
        std::span(character.morph_times_s).subspan(clip.first_morph_time, clip.morph_row_count), time_s);
    const double earlier = values[size_t{rows.earlier} * clip.morph_row_stride],
                 later = values[size_t{rows.later} * clip.morph_row_stride];
    return (word & kTrackStep) != 0 ? earlier : earlier * (1 - rows.fraction) + later * rows.fraction;
}

std::vector<double> morphs_reference(const Character& character, std::span<const MorphLayer> layers) {
    std::vector<double> weights;
    for (uint32_t morph = 0; morph < character.morphs.size(); ++morph) {
        weights.push_back(double{character.morphs[morph].default_weight});
        for (const MorphLayer& layer : layers) weights.back() = layer_on(character, layer, morph, weights.back());
    }
    return weights;
}

std::vector<WeightedMorph> active_morphs_reference(std::span<const double> weights, size_t limit) {
    std::vector<WeightedMorph> active;
    for (uint32_t morph = 0; morph < weights.size(); ++morph)
        if (std::abs(weights[morph]) > double{kMinMorphWeight}) active.push_back({morph, weights[morph]});
    std::ranges::stable_sort(
        active, [](const WeightedMorph& a, const WeightedMorph& b) { return std::abs(a.weight) > std::abs(b.weight); });
    active.resize(std::min(active.size(), limit));
    return active;
}

Vec3<double> morphed_position_reference(const Character& character, const MeshSection& section, uint32_t vertex_index,
                                        std::span<const WeightedMorph> morphs) {
    const Vertex& vertex = character.vertices[section.first_vertex + vertex_index];
    Vec3<double> position = vertex.position.as<double>();
    if (vertex.first_delta == 0) return position;
    for (const WeightedMorph& active : morphs)
        if (active.morph >= section.first_morph && active.morph - section.first_morph < section.morph_count)
            position = position + character.morph_deltas[vertex.first_delta - 1 + active.morph - section.first_morph]
                                          .position.as<double>() *
                                      active.weight;
    return position;
}

}  // namespace throng
