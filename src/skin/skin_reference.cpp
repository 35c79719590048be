#include "skin/skin_reference.h"

namespace throng {

std::vector<Vec3<double>> skin_reference(const Character& character, std::span<const AffineT<double>> model_from_bind, std::span<const WeightedMorph> morphs) {
    std::vector<Vec3<double>> positions(character.vertices.size());
    for (const MeshSection& section : character.sections) {
        for (uint32_t vertex = 0; vertex < section.vertex_count; ++vertex) {
            const Vec3<double> bind_position = morphed_position_reference(character, section, vertex, morphs);
            Vec3<double> sum;
            for (uint32_t set = 0; set < section.influence_sets; ++set) {
                const Influences& influences = character.influences[section.first_influences + vertex * section.influence_sets + set];
                for (size_t i = 0; i < 4; ++i)
                    if (influences.weights[i] != 0)
                        sum = sum + transform_point(model_from_bind[influences.entries[i]], bind_position) * double{influences.weights[i]};
            }
            positions[section.first_vertex + vertex] = sum;
        }
    }
    return positions;
}

}  // namespace throng
