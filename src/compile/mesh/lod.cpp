#include "compile/mesh/lod.h"

#include "base/count.h"
#include "base/processor.h"
#include "base/thread_pool.h"
#include "bind/bind_reference.h"
#include "reference/sampled_poses.h"
#include "compile/mesh/decimate.h"
#include "compile/mesh/triangle_index.h"
#include "morph/morph_reference.h"
#include "skin/skin_reference.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <utility>

namespace throng {
namespace {

constexpr size_t kMaxWithoutLevels = 64 * 3;  // indices: coarser levels of a mesh with no more would gain nothing
constexpr double kShare = 1.0 / 3;            // level n aims at kShare^n of the mesh's triangles
constexpr double kWorthwhile = 0.8;           // a level with more than this share of the previous one's ends the levels
constexpr double kAlmost = 1.25;              // of the triangles wanted: clustering meets a number only roughly
constexpr uint32_t kPoses = 7;                // of all clips together, beside the rest pose, to measure errors in
constexpr float kMinError = 1e-6f;            // of the character's size: rounding cannot tell it from 0

// In model space.
std::vector<Vec3<float>> positions_in(const Character& character, const SampledPose& pose) {
    const std::vector<MorphLayer> layers{{.active_clips = {{.clip = pose.clip, .time_s = pose.time_s}}}};
    const std::vector<WeightedMorph> morphs = active_morphs_reference(morphs_reference(character, layers));
    std::vector<Vec3<float>> positions;
    for (const Vec3<double>& p :
         skin_reference(character, bind_reference(character.palette, model_from_joint_of(character, pose)), morphs))
        positions.push_back(p.as<float>());
    return positions;
}

// Vertices of the fine mesh that the coarse one lacks, ordered so that neighbours follow one another.
std::vector<uint32_t> lost_vertices(const TriangleIndex& fine, std::span<const uint32_t> coarse, size_t vertex_count) {
    std::vector<bool> is_known(vertex_count);
    for (const uint32_t vertex : coarse) is_known[vertex] = true;
    std::vector<uint32_t> lost;
    for (const auto& corners : fine.corners()) {
        for (const uint32_t vertex : corners) {
            if (is_known[vertex]) continue;
            is_known[vertex] = true;
            lost.push_back(vertex);
        }
    }
    return lost;
}

// The points of a coarse triangle that are compared with the fine mesh, to find where it spans a gap: its middle, and
// the middles of its edges.
constexpr size_t kMiddles = 4;
Vec3<float> middle_of(const std::array<uint32_t, 3>& corners, size_t which, std::span<const Vec3<float>> positions) {
    const Vec3<float> a = positions[corners[0]], b = positions[corners[1]], c = positions[corners[2]];
    if (which == 0) return (a + b + c) * (1 / 3.0f);
    return (which == 1 ? a + b : which == 2 ? b + c : c + a) * 0.5f;
}

// [place]: a triangle of the mesh that was near it in the last search. Usually it is near enough in the next pose too,
// and the search ends at once.
using NearTriangles = std::vector<uint32_t>;

// The largest distance of any place from the mesh, or `known` if that is larger. `place(i)` returns the i-th place. The
// search for a place ends as soon as it is known not to be the furthest.
template <class Place>
float furthest_from(const TriangleIndex& mesh, NearTriangles& near, const Place& place, float known,
                    const Progress& progress, uint64_t& steps) {
    float furthest = known * known;
    uint32_t last = 0;
    // Every 16th place first: their largest distance ends most searches of the second pass early.
    for (const size_t stride : {size_t{16}, size_t{1}}) {
        for (size_t i = 0; i < near.size(); i += stride) {
            progress.poll_at(i);
            const TriangleIndex::Nearest found = mesh.nearest(place(i), furthest, near[i] == kNone ? last : near[i]);
            furthest = std::max(furthest, found.squared_distance);
            near[i] = last = found.triangle;
            steps += found.steps;
        }
    }
    return std::sqrt(furthest);
}

std::span<const uint32_t> indices_of(const Character& character, const MeshSection& section) {
    return std::span(character.indices).subspan(section.first_index, section.index_count);
}

// A coarse mesh, and its largest error in the poses measured so far.
struct Coarse {
    Coarse(std::vector<uint32_t> mesh, const TriangleIndex& fine, std::span<const Vec3<float>> positions)
        : indices(std::move(mesh)),
          index(indices, positions),
          lost(lost_vertices(fine, indices, positions.size())),
          near_lost(lost.size(), kNone),
          near_middles(indices.size() / 3 * kMiddles, kNone) {}

    // Raises the error to that in a pose. Measures in both directions, since clustering can join parts that lie side by
    // side, such as legs, and then move apart.
    void measure(const TriangleIndex& fine, std::span<const Vec3<float>> positions, const Progress& progress) {
        index.move(positions);
        const auto lost_place = [&](size_t i) { return positions[lost[i]]; };
        const auto middle = [&](size_t i) { return middle_of(index.corners()[i / kMiddles], i % kMiddles, positions); };
        error = furthest_from(index, near_lost, lost_place, error, progress, steps);
        error = furthest_from(fine, near_middles, middle, error, progress, steps);
    }

    std::vector<uint32_t> indices;  // of the character's vertices
    float error = 0;
    uint64_t steps = 0;  // of the searches
    TriangleIndex index;
    std::vector<uint32_t> lost;  // vertices
    NearTriangles near_lost;     // of `lost`, in `index`
    NearTriangles near_middles;  // of its middles, in the fine mesh
};

// Runs `body` on another thread, while this thread, which has to call the hooks, polls for cancellation. If the system
// has no more threads, this one runs `body`.
template <class Body>
void run_while_polling(const Progress& progress, const Body& body) {
    constexpr std::chrono::milliseconds kInterval(10);
    std::future<void> other = std::async(body);
    while (other.wait_for(kInterval) == std::future_status::timeout) progress.poll();
    other.get();
}

// All sections as one mesh: indices of the character's vertices.
std::vector<uint32_t> joined_indices(const Character& character) {
    std::vector<uint32_t> all;
    for (const MeshSection& section : character.sections)
        for (const uint32_t index : indices_of(character, section)) all.push_back(section.first_vertex + index);
    return all;
}

// Simplifies all sections by vertex clustering with one cell size.
std::vector<uint32_t> clustered_by(float cell, const Character& character, std::span<const Vec3<float>> positions) {
    std::vector<uint32_t> all;
    for (const MeshSection& section : character.sections) {
        const std::span<const uint32_t> fine = indices_of(character, section);
        if (fine.empty()) continue;
        const std::span<const Vec3<float>> places = positions.subspan(section.first_vertex, section.vertex_count);
        const float extent = meshopt_simplifyScale(&places[0].x, places.size(), sizeof places[0]);
        std::vector<uint32_t> clustered(fine.size());
        // With a target of 0 indices, only the error, a fraction of the extent, decides: it is the size of a cell
        clustered.resize(meshopt_simplifySloppy(clustered.data(), fine.data(), fine.size(), &places[0].x, places.size(),
                                                sizeof places[0], 0, std::min(cell / extent, 1.0f), nullptr));
        for (const uint32_t index : clustered) all.push_back(section.first_vertex + index);
    }
    return all;
}

std::vector<uint32_t> clustered_together(const Character& character, std::span<const Vec3<float>> positions,
                                         size_t wanted) {
    constexpr int kHalvings = 10;
    float least = 0, most = character.size;  // of a cell
    std::vector<uint32_t> coarsest = clustered_by(most, character, positions);
    for (int i = 0; i < kHalvings; ++i) {
        const float middle = (least + most) / 2;
        std::vector<uint32_t> of_middle = clustered_by(middle, character, positions);
        const bool is_coarse = static_cast<double>(of_middle.size()) <= kAlmost * static_cast<double>(wanted);
        (is_coarse ? most : least) = middle;
        if (is_coarse) coarsest = std::move(of_middle);
    }
    return coarsest;
}

bool are_markedly_fewer(size_t indices, size_t before) {
    return static_cast<double>(indices) <= kWorthwhile * static_cast<double>(before);
}

// Returns `decimated`, the result of edge collapses, if it is markedly coarser than the level before. If not, the mesh
// has many pieces, and collapses remove none: then tries vertex clustering, which joins pieces, and returns its result
// if that is coarser and not empty.
std::vector<uint32_t> coarser(std::vector<uint32_t> decimated, size_t before, const Character& character,
                              std::span<const Vec3<float>> positions, size_t wanted) {
    if (are_markedly_fewer(decimated.size(), before)) return decimated;
    std::vector<uint32_t> clustered = clustered_together(character, positions, wanted);
    return clustered.size() < decimated.size() && !clustered.empty() ? clustered : decimated;
}

// Keeps levels as long as triangles become markedly fewer.
void keep_levels(std::span<const Coarse> levels, Character& character) {
    size_t count_before = character.indices.size();
    float error = kMinError * character.size;
    for (const Coarse& level : levels) {
        const size_t count = level.indices.size();
        // If every triangle of a mesh has two corners at one place, its levels have no triangles
        if (count == 0 || count_before <= kMaxWithoutLevels || !are_markedly_fewer(count, count_before)) return;
        count_before = count;
        error = std::max(error, level.error);
        std::vector<std::vector<uint32_t>> of_sections(character.sections.size());
        for (const uint32_t index : level.indices) {
            const auto after = std::ranges::upper_bound(character.sections, index, {}, &MeshSection::first_vertex);
            of_sections[static_cast<size_t>(after - character.sections.begin()) - 1].push_back(
                index - std::prev(after)->first_vertex);
        }
        for (const std::vector<uint32_t>& indices : of_sections) {
            character.lod_ranges.push_back({count_of(character.lod_indices), count_of(indices)});
            character.lod_indices.insert(character.lod_indices.end(), indices.begin(), indices.end());
        }
        character.lods.push_back({error});
    }
}

}  // namespace

uint64_t make_lods(Character& character, const Progress& progress) {
    if (character.indices.size() <= kMaxWithoutLevels) return 0;
    constexpr double kSimplified = 0.85;  // part of the work; the rest is measuring
    const Progress simplifying = progress.between(0, kSimplified), measuring = progress.between(kSimplified, 1);
    ThreadPool threads(std::min(kLodLimit, processor_threads()));
    const std::vector<SampledPose> poses = sampled_poses(character, kPoses);
    std::vector<std::vector<Vec3<float>>> positions(poses.size());  // [poses][vertices]
    for_each_job(threads, count_of(poses), [&](uint32_t pose) {
        simplifying.poll();
        positions[pose] = positions_in(character, poses[pose]);
    });
    const std::vector<uint32_t> indices = joined_indices(character);
    std::vector<size_t> wanted;  // [levels], indices
    double share = 1;
    for (size_t level = 0; level < kLodLimit; ++level) {
        share *= kShare;
        wanted.push_back(static_cast<size_t>(share * static_cast<double>(indices.size())) / 3 * 3);
    }
    TriangleIndex fine(indices, positions[0]);
    std::vector<Coarse> levels;
    for (std::vector<uint32_t>& decimated : decimate(character, indices, positions, wanted, simplifying)) {
        simplifying.poll();
        const size_t before = levels.empty() ? indices.size() : levels.back().indices.size();
        levels.emplace_back(coarser(std::move(decimated), before, character, positions[0], wanted[levels.size()]), fine,
                            positions[0]);
    }
    for (size_t pose = 0; pose < positions.size(); ++pose) {
        measuring.report(pose, positions.size());
        fine.move(positions[pose]);
        run_while_polling(measuring, [&] {
            for_each_job(threads, count_of(levels),
                         [&](uint32_t level) { levels[level].measure(fine, positions[pose], measuring); });
        });
    }
    keep_levels(levels, character);
    uint64_t steps = 0;
    for (const Coarse& level : levels) steps += level.steps;
    return steps;
}

}  // namespace throng
