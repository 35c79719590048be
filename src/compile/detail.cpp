#include "compile/detail.h"

#include "bind/bind_reference.h"
#include "scan/scan_reference.h"
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

// Vertices where the rest pose has them, so that errors are in model space.
std::vector<Vec3<float>> resting_positions(const Character& character) {
    std::vector<AffineT<double>> local;
    for (const Trs<float>& joint : character.rig.rest) local.push_back(to_affine(joint.as<double>()));
    const std::vector<AffineT<double>> model = scan_reference(character.rig.parents, local);
    std::vector<Vec3<float>> positions;
    for (const Vec3<double>& p : skin_reference(character, bind_reference(character.palette, model))) positions.push_back(p.as<float>());
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

// How far a vertex of the fine mesh lies from the coarse one at most; the quadrics' own measure is a mean, several times too low for this. Of large meshes a part of the vertices is looked at.
float distance_between(std::span<const uint32_t> fine, std::span<const uint32_t> coarse, std::span<const Vec3<float>> positions) {
    constexpr size_t kMostPairs = 20'000'000;  // some tenths of a second
    const size_t stride = 1 + fine.size() * (coarse.size() / 3) / kMostPairs;
    float furthest = 0;
    for (size_t i = 0; i < fine.size(); i += stride) {
        float nearest = std::numeric_limits<float>::infinity();
        for (size_t k = 0; k < coarse.size() && nearest > furthest; k += 3)
            nearest = std::min(nearest, squared_distance(positions[fine[i]], positions[coarse[k]], positions[coarse[k + 1]], positions[coarse[k + 2]]));
        furthest = std::max(furthest, nearest);
    }
    return std::sqrt(furthest);
}

}  // namespace

void make_details(Character& character) {
    const std::vector<Vec3<float>> positions = resting_positions(character);
    size_t count_before = character.indices.size();
    double share = 1;
    for (float error = 0; count_before > kFewest && character.details.size() < kDetailLimit;) {
        share *= kShare;
        std::vector<IndexRange> ranges;
        std::vector<uint32_t> level;
        for (const MeshSection& section : character.sections) {
            const auto indices = std::span(character.indices).subspan(section.first_index, section.index_count);
            const auto vertices = std::span(positions).subspan(section.first_vertex, section.vertex_count);
            std::vector<uint32_t> coarse;
            if (!indices.empty()) coarse = simplified(indices, vertices, static_cast<size_t>(share * section.index_count));
            if (coarse.empty()) coarse.assign(indices.begin(), indices.end());  // nothing vanishes
            error = std::max(error, distance_between(indices, coarse, vertices));
            ranges.push_back({static_cast<uint32_t>(character.detail_indices.size() + level.size()), static_cast<uint32_t>(coarse.size())});
            level.insert(level.end(), coarse.begin(), coarse.end());
        }
        if (static_cast<double>(level.size()) > kWorthwhile * static_cast<double>(count_before)) break;
        character.details.push_back({error});
        character.detail_ranges.insert(character.detail_ranges.end(), ranges.begin(), ranges.end());
        character.detail_indices.insert(character.detail_indices.end(), level.begin(), level.end());
        count_before = level.size();
    }
}

}  // namespace throng
