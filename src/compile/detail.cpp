#include "compile/detail.h"

#include "bind/bind_reference.h"
#include "compile/sampled_poses.h"
#include "morph/morph_reference.h"
#include "skin/skin_reference.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
namespace {

constexpr size_t kFewest = 64 * 3;       // indices, below which nothing is gained
constexpr double kShare = 0.35;          // of the triangles of the level before that a level aims at
constexpr double kWorthwhile = 0.8;      // of them, above which it is not kept
constexpr float kLargestError = 0.2f;    // of a section's extent, by quadrics
constexpr uint32_t kPoses = 8;           // of all clips together, that errors are measured in
constexpr float kLeastError = 1e-6f;     // of the character's size, which rounding does not tell from none

// In model space.
std::vector<Vec3<float>> positions_in(const Character& character, const SampledPose& pose) {
    const std::vector<MorphLayer> layers{{.voices = {{.clip = pose.clip, .time_s = pose.time_s}}}};
    const std::vector<WeightedMorph> morphs = active_morphs_reference(morphs_reference(character, layers));
    std::vector<Vec3<float>> positions;
    for (const Vec3<double>& p : skin_reference(character, bind_reference(character.palette, model_from_joint_of(character, pose)), morphs)) positions.push_back(p.as<float>());
    return positions;
}

// By edge collapses towards vertices that are there (M. Garland and P. S. Heckbert, Surface Simplification Using Quadric Error Metrics, SIGGRAPH 1997), as
// meshoptimizer has them.
std::vector<uint32_t> simplified(std::span<const uint32_t> indices, std::span<const Vec3<float>> positions, size_t wanted_count) {
    std::vector<uint32_t> out(indices.size());
    out.resize(meshopt_simplify(out.data(), indices.data(), indices.size(), &positions[0].x, positions.size(), sizeof positions[0], wanted_count / 3 * 3, kLargestError, 0, nullptr));
    return out;
}

// Squared, of a point from a triangle: from its plane where the point is above it, else from an edge.
float squared_distance(const Vec3<float>& p, const Vec3<float>& a, const Vec3<float>& b, const Vec3<float>& c) {
    const Vec3<float> normal = cross(b - a, c - a);
    const float squared = dot(normal, normal);
    float nearest = std::numeric_limits<float>::infinity();
    bool is_above = squared > 0;
    const auto look_at_edge = [&](const Vec3<float>& from, const Vec3<float>& to) {
        const Vec3<float> edge = to - from, way = p - from;
        is_above = is_above && dot(cross(edge, way), normal) >= 0;
        const float length_squared = dot(edge, edge);
        const Vec3<float> apart = way - edge * (length_squared > 0 ? std::clamp(dot(way, edge) / length_squared, 0.0f, 1.0f) : 0.0f);
        nearest = std::min(nearest, dot(apart, apart));
    };
    look_at_edge(a, b);
    look_at_edge(b, c);
    look_at_edge(c, a);
    const float height = dot(p - a, normal);
    return is_above ? height * height / squared : nearest;
}

// Vertices of the fine mesh that the coarse one lacks.
std::vector<uint32_t> lost_vertices(std::span<const uint32_t> fine, std::span<const uint32_t> coarse, size_t vertex_count) {
    std::vector<bool> is_lost(vertex_count);
    for (const uint32_t vertex : fine) is_lost[vertex] = true;
    for (const uint32_t vertex : coarse) is_lost[vertex] = false;
    std::vector<uint32_t> lost;
    for (uint32_t vertex = 0; vertex < vertex_count; ++vertex)
        if (is_lost[vertex]) lost.push_back(vertex);
    return lost;
}

// How far one of the vertices lies from the mesh at most, where that is more than `known`; the quadrics' own measure is a mean, several times too low for this. Of large meshes not all vertices may be looked at, but some of
// each part.
float furthest_from(std::span<const uint32_t> mesh, std::span<const uint32_t> vertices, std::span<const Vec3<float>> positions, float known) {
    constexpr size_t kPasses = 16, kMostSteps = 5'000'000;  // some hundredths of a second
    float furthest = known * known;
    size_t closest = 0;  // where the search for the last vertex ended, so that most end where they begin
    for (size_t pass = 0, steps = 0; pass < kPasses; ++pass) {
        for (size_t i = pass; i < vertices.size() && steps < kMostSteps; i += kPasses) {
            float nearest = std::numeric_limits<float>::infinity();
            for (size_t n = 0, k = closest; n < mesh.size() && nearest > furthest; n += 3, k = k + 3 < mesh.size() ? k + 3 : 0) {
                ++steps;
                const float distance = squared_distance(positions[vertices[i]], positions[mesh[k]], positions[mesh[k + 1]], positions[mesh[k + 2]]);
                if (distance >= nearest) continue;
                nearest = distance;
                closest = k;
            }
            furthest = std::max(furthest, nearest);
        }
    }
    return std::sqrt(furthest);
}

std::span<const uint32_t> indices_of(const Character& character, const MeshSection& section) { return std::span(character.indices).subspan(section.first_index, section.index_count); }

// Each level's triangles; as long as they become markedly fewer.
void make_levels(Character& character) {
    const std::vector<Vec3<float>> positions = positions_in(character, {.clip = static_cast<uint32_t>(character.clips.size())});
    size_t count_before = character.indices.size();
    for (double share = kShare; count_before > kFewest && character.details.size() < kDetailLimit; share *= kShare) {
        std::vector<IndexRange> ranges;
        std::vector<uint32_t> level;
        for (const MeshSection& section : character.sections) {
            const std::span<const uint32_t> indices = indices_of(character, section);
            std::vector<uint32_t> coarse;
            if (!indices.empty()) coarse = simplified(indices, std::span(positions).subspan(section.first_vertex, section.vertex_count), static_cast<size_t>(share * section.index_count));
            if (coarse.empty()) coarse.assign(indices.begin(), indices.end());  // nothing vanishes
            ranges.push_back({static_cast<uint32_t>(character.detail_indices.size() + level.size()), static_cast<uint32_t>(coarse.size())});
            level.insert(level.end(), coarse.begin(), coarse.end());
        }
        if (static_cast<double>(level.size()) > kWorthwhile * static_cast<double>(count_before)) break;
        character.details.push_back({kLeastError * character.size});
        character.detail_ranges.insert(character.detail_ranges.end(), ranges.begin(), ranges.end());
        character.detail_indices.insert(character.detail_indices.end(), level.begin(), level.end());
        count_before = level.size();
    }
}

// Raises the errors of all levels to what they are in the pose.
void measure_in(Character& character, const SampledPose& pose) {
    const std::vector<Vec3<float>> positions = positions_in(character, pose);
    float error = 0;
    for (size_t level = 0; level < character.details.size(); ++level) {
        error = std::max(error, character.details[level].error);
        for (size_t i = 0; i < character.sections.size(); ++i) {
            const MeshSection& section = character.sections[i];
            const IndexRange& range = character.detail_ranges[level * character.sections.size() + i];
            const auto mesh = std::span(character.detail_indices).subspan(range.first_index, range.index_count);
            error = furthest_from(mesh, lost_vertices(indices_of(character, section), mesh, section.vertex_count), std::span(positions).subspan(section.first_vertex, section.vertex_count), error);
        }
        character.details[level].error = error;
    }
}

}  // namespace

void make_details(Character& character) {
    make_levels(character);
    if (character.details.empty()) return;
    for (const SampledPose& pose : sampled_poses(character, kPoses)) measure_in(character, pose);
}

}  // namespace throng
