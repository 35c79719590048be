#include "compile/mesh/write_levels.h"

#include "base/count.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace throng {
namespace {

// The vertices of a level, section by section.
struct LevelVertices {
    explicit LevelVertices(const CoarseMesh& of)
        : mesh(of), by_section(of.sources().size()), numbers(by_section.size()), sections(by_section.size()) {
        std::iota(by_section.begin(), by_section.end(), 0u);
        std::ranges::sort(by_section, {}, [&](uint32_t vertex) { return mesh.sources()[vertex]; });
    }

    const CoarseMesh& mesh;
    std::vector<uint32_t> by_section;  // vertices of the mesh
    size_t done = 0;                   // of by_section
    // [vertices of the mesh]
    std::vector<uint32_t> numbers;  // relative to the first vertex of their section
    std::vector<uint32_t> sections;
};

class LevelWriter {
public:
    LevelWriter(std::span<const FittedLevel> levels, Character& character) : levels_(levels), character_(character) {
        for (const FittedLevel& level : levels) of_levels_.emplace_back(level.mesh);
    }

    void run() {
        std::vector<MeshSection> sections;
        for (uint32_t section = 0; section < character_.sections.size(); ++section)
            sections.push_back(with_levels(section));
        character_.sections = std::move(sections);
        character_.vertices = std::move(vertices_);
        character_.influences = std::move(influences_);
        float error = 0;
        for (size_t level = 0; level < levels_.size(); ++level) {
            error = std::max(error, levels_[level].error);
            character_.lods.push_back({error});
            add_indices(of_levels_[level]);
        }
    }

private:
    MeshSection with_levels(uint32_t number) {
        const MeshSection& section = character_.sections[number];
        MeshSection made = section;
        made.first_vertex = count_of(vertices_);
        made.first_influences = count_of(influences_);
        for (uint32_t vertex = 0; vertex < section.vertex_count; ++vertex) copy(section, vertex);
        for (LevelVertices& level : of_levels_) {
            for (; level.done < level.by_section.size(); ++level.done) {
                const uint32_t vertex = level.by_section[level.done];
                const uint32_t source = level.mesh.sources()[vertex] - section.first_vertex;
                if (source >= section.vertex_count) break;
                level.sections[vertex] = number;
                level.numbers[vertex] = source;
                if (!level.mesh.is_moved(vertex)) continue;
                level.numbers[vertex] = made.vertex_count++;
                ++made.lod_vertex_count;
                copy(section, source);
                vertices_.back().position = level.mesh.bind_position(vertex);
            }
        }
        return made;
    }

    void copy(const MeshSection& section, uint32_t vertex) {
        vertices_.push_back(character_.vertices[section.first_vertex + vertex]);
        for (uint32_t set = 0; set < section.influence_sets; ++set)
            influences_.push_back(
                character_.influences[section.first_influences + size_t{vertex} * section.influence_sets + set]);
    }

    void add_indices(const LevelVertices& level) {
        std::vector<std::vector<uint32_t>> of_sections(character_.sections.size());
        for (const uint32_t vertex : level.mesh.indices())
            of_sections[level.sections[vertex]].push_back(level.numbers[vertex]);
        for (const std::vector<uint32_t>& indices : of_sections) {
            character_.lod_ranges.push_back({count_of(character_.lod_indices), count_of(indices)});
            character_.lod_indices.insert(character_.lod_indices.end(), indices.begin(), indices.end());
        }
    }

    std::span<const FittedLevel> levels_;
    Character& character_;
    std::vector<LevelVertices> of_levels_;
    std::vector<Vertex> vertices_;
    std::vector<Influences> influences_;
};

}  // namespace

void write_levels(std::span<const FittedLevel> levels, Character& character) { LevelWriter(levels, character).run(); }

}  // namespace throng
