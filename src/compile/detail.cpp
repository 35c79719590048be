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
constexpr double kAlmost = 1.25;         // of them, which is still coarse enough
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

std::vector<Vec3<float>> places_of(std::span<const uint32_t> vertices, std::span<const Vec3<float>> positions) {
    std::vector<Vec3<float>> places;
    for (const uint32_t vertex : vertices) places.push_back(positions[vertex]);
    return places;
}

// Where triangles may span what is none of the mesh that they stand for: their middles, and those of their edges.
std::vector<Vec3<float>> middles_of(std::span<const uint32_t> mesh, std::span<const Vec3<float>> positions) {
    std::vector<Vec3<float>> middles;
    for (size_t k = 0; k < mesh.size(); k += 3) {
        const Vec3<float> &a = positions[mesh[k]], &b = positions[mesh[k + 1]], &c = positions[mesh[k + 2]];
        for (const Vec3<float>& middle : {(a + b + c) * (1 / 3.0f), (a + b) * 0.5f, (b + c) * 0.5f, (c + a) * 0.5f}) middles.push_back(middle);
    }
    return middles;
}

// How far one of the places lies from the mesh at most, where that is more than `known`; the quadrics' own measure is a mean, several times too low for this. Of large meshes not all places may be looked at, but some of
// each part.
float furthest_from(std::span<const uint32_t> mesh, std::span<const Vec3<float>> places, std::span<const Vec3<float>> positions, float known) {
    constexpr size_t kPasses = 16, kMostSteps = 5'000'000;  // some hundredths of a second
    float furthest = known * known;
    size_t closest = 0;  // where the search for the last place ended, so that most end where they begin
    for (size_t pass = 0, steps = 0; pass < kPasses; ++pass) {
        for (size_t i = pass; i < places.size() && steps < kMostSteps; i += kPasses) {
            float nearest = std::numeric_limits<float>::infinity();
            for (size_t n = 0, k = closest; n < mesh.size() && nearest > furthest; n += 3, k = k + 3 < mesh.size() ? k + 3 : 0) {
                ++steps;
                const float distance = squared_distance(places[i], positions[mesh[k]], positions[mesh[k + 1]], positions[mesh[k + 2]]);
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

// Triangles of a section, and how far they are off in the poses looked at so far.
struct Coarse {
    std::vector<uint32_t> indices;
    float error = 0;
};

// By both ways of meshoptimizer, in the rest pose: edge collapses towards vertices that are there (M. Garland and P. S. Heckbert, Surface Simplification Using Quadric Error Metrics, SIGGRAPH 1997), which stop where the
// mesh comes apart, and clusters of vertices, which do not, and lose no thin part that is larger than a cluster.
struct CoarseSection {
    CoarseSection(std::span<const uint32_t> fine, std::span<const Vec3<float>> positions, double share) : wanted(static_cast<size_t>(share * static_cast<double>(fine.size())) / 3 * 3) {
        if (fine.empty()) return;
        for (Coarse* coarse : {&collapsed, &clustered}) coarse->indices.resize(fine.size());
        collapsed.indices.resize(meshopt_simplify(collapsed.indices.data(), fine.data(), fine.size(), &positions[0].x, positions.size(), sizeof positions[0], wanted, kLargestError, 0, nullptr));
        clustered.indices.resize(meshopt_simplifySloppy(clustered.indices.data(), fine.data(), fine.size(), &positions[0].x, positions.size(), sizeof positions[0], wanted, kLargestError, nullptr));
        if (collapsed.indices.empty()) collapsed.indices.assign(fine.begin(), fine.end());  // nothing vanishes
    }

    // Of two that are as coarse as they should be the one that is off by less, else the coarser one.
    const Coarse& better() const {
        const auto is_coarse = [this](const Coarse& coarse) { return static_cast<double>(coarse.indices.size()) <= kAlmost * static_cast<double>(wanted); };
        if (clustered.indices.empty()) return collapsed;
        const bool prefers_collapsed = is_coarse(collapsed) && is_coarse(clustered) ? collapsed.error <= clustered.error : collapsed.indices.size() <= clustered.indices.size();
        return prefers_collapsed ? collapsed : clustered;
    }

    size_t wanted;
    Coarse collapsed, clustered;
};
using CoarseLevel = std::vector<CoarseSection>;  // [sections]

std::vector<CoarseLevel> make_levels(const Character& character) {
    const std::vector<Vec3<float>> positions = positions_in(character, {.clip = static_cast<uint32_t>(character.clips.size())});
    std::vector<CoarseLevel> levels(kDetailLimit);
    double share = 1;
    for (CoarseLevel& level : levels) {
        share *= kShare;
        for (const MeshSection& section : character.sections) level.emplace_back(indices_of(character, section), std::span(positions).subspan(section.first_vertex, section.vertex_count), share);
    }
    return levels;
}

// Raises the errors of all to what they are in the pose: either way, since clusters may join what lies side by side, as legs, and moves apart.
void measure_in(const Character& character, const SampledPose& pose, std::vector<CoarseLevel>& levels) {
    const std::vector<Vec3<float>> all_positions = positions_in(character, pose);
    for (CoarseLevel& level : levels)
        for (size_t i = 0; i < level.size(); ++i) {
            const MeshSection& section = character.sections[i];
            const std::span<const uint32_t> fine = indices_of(character, section);
            const auto positions = std::span(all_positions).subspan(section.first_vertex, section.vertex_count);
            for (Coarse* coarse : {&level[i].collapsed, &level[i].clustered}) {
                if (coarse->indices.empty()) continue;
                coarse->error = furthest_from(coarse->indices, places_of(lost_vertices(fine, coarse->indices, section.vertex_count), positions), positions, coarse->error);
                coarse->error = furthest_from(fine, middles_of(coarse->indices, positions), positions, coarse->error);
            }
        }
}

// As long as triangles become markedly fewer.
void keep_levels(Character& character, std::span<const CoarseLevel> levels) {
    size_t count_before = character.indices.size();
    float error = kLeastError * character.size;
    for (const CoarseLevel& level : levels) {
        size_t count = 0;
        for (const CoarseSection& section : level) count += section.better().indices.size();
        if (count_before <= kFewest || static_cast<double>(count) > kWorthwhile * static_cast<double>(count_before)) return;
        count_before = count;
        for (const CoarseSection& section : level) {
            const Coarse& coarse = section.better();
            error = std::max(error, coarse.error);
            character.detail_ranges.push_back({static_cast<uint32_t>(character.detail_indices.size()), static_cast<uint32_t>(coarse.indices.size())});
            character.detail_indices.insert(character.detail_indices.end(), coarse.indices.begin(), coarse.indices.end());
        }
        character.details.push_back({error});
    }
}

}  // namespace

void make_details(Character& character) {
    if (character.indices.size() <= kFewest) return;
    std::vector<CoarseLevel> levels = make_levels(character);
    for (const SampledPose& pose : sampled_poses(character, kPoses)) measure_in(character, pose, levels);
    keep_levels(character, levels);
}

}  // namespace throng
