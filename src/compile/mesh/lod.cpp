#include "compile/mesh/lod.h"

#include "base/count.h"
#include "base/default_floats.h"
#include "base/processor.h"
#include "base/thread_pool.h"
#include "compile/mesh/coarse_mesh.h"
#include "compile/mesh/decimate.h"
#include "compile/mesh/fit_vertices.h"
#include "compile/mesh/posed_mesh.h"
#include "compile/mesh/welded_mesh.h"
#include "compile/mesh/write_levels.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>

namespace throng {
namespace {

constexpr size_t kMaxWithoutLevels = 64 * 3;  // indices: coarser levels of a mesh with no more would gain nothing
constexpr double kShare = 1.0 / 3;            // level n aims at kShare^n of the mesh's triangles
constexpr double kWorthwhile = 0.8;           // a level with more than this share of the previous one's ends the levels
constexpr double kAlmost = 1.25;              // of the triangles wanted: clustering meets a number only roughly
constexpr double kDecimated = 0.9;            // part of the work; the rest is fitting the last level
constexpr float kRounding = 1e-6f;            // of the character's size: how exactly errors are known

std::span<const uint32_t> indices_of(const Character& character, const MeshSection& section) {
    return std::span(character.indices).subspan(section.first_index, section.index_count);
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

// A level that is fitted to the fine mesh, on a thread of its own, while coarser levels are made.
struct LevelInWork {
    size_t index_count = 0;
    std::future<FittedLevel> fitted{};
};

// Makes levels as long as triangles become markedly fewer.
class LevelMaker {
public:
    LevelMaker(Character& character, std::span<const MeshPose> poses, const Progress& progress)
        : character_(character),
          progress_(progress),
          threads_(std::min(count_of(poses), processor_threads())),
          indices_(joined_indices(character)),
          fine_(character, poses, indices_, threads_, progress),
          welded_(character, indices_, fine_.positions, progress) {}

    uint64_t run() {
        double share = 1;
        for (size_t level = 0; level < kLodLimit; ++level) {
            share *= kShare;
            wanted_.push_back(static_cast<size_t>(share * static_cast<double>(indices_.size())) / 3 * 3);
        }
        decimate(
            welded_, fine_.surfaces[0], wanted_,
            [&](std::vector<uint32_t> decimated) { return add_level(std::move(decimated)); },
            progress_.between(0, kDecimated));
        std::vector<FittedLevel> fitted;
        uint64_t steps = 0;
        for (LevelInWork& level : levels_) {
            wait_for(level.fitted);
            fitted.push_back(level.fitted.get());
            fitted.back().error += kRounding * character_.size;
            steps += fitted.back().steps;
        }
        write_levels(fitted, character_);
        return steps;
    }

private:
    // Returns whether a coarser one may be worth keeping.
    bool add_level(std::vector<uint32_t> decimated) {
        progress_.poll();
        const size_t before = levels_.empty() ? indices_.size() : levels_.back().index_count;
        if (before <= kMaxWithoutLevels) return false;
        std::vector<uint32_t> coarse = coarser(std::move(decimated), before, character_, fine_.positions[0],
                                               wanted_[levels_.size()]);
        // If every triangle of a mesh has two corners at one place, its levels have no triangles
        if (coarse.empty() || !are_markedly_fewer(coarse.size(), before)) return false;
        levels_.push_back({coarse.size(), std::async([this, indices = std::move(coarse)] {
                               const DefaultFloats floats;
                               return fit_vertices({character_, fine_, welded_, indices}, progress_);
                           })});
        return true;
    }

    // Meanwhile this thread, which has to call the hooks, polls for cancellation. If the system has no more threads,
    // get() does the work.
    void wait_for(const std::future<FittedLevel>& fitted) const {
        constexpr std::chrono::milliseconds kInterval(10);
        while (fitted.wait_for(kInterval) == std::future_status::timeout) progress_.poll();
    }

    Character& character_;
    const Progress& progress_;
    ThreadPool threads_;
    std::vector<uint32_t> indices_;
    PosedMesh fine_;
    WeldedMesh welded_;
    std::vector<size_t> wanted_;  // [levels], indices
    // Destroyed first: the destructor of a future waits for its thread.
    std::vector<LevelInWork> levels_;
};

}  // namespace

uint64_t make_lods(Character& character, std::span<const MeshPose> poses, const Progress& progress) {
    if (character.indices.size() <= kMaxWithoutLevels) return 0;
    return LevelMaker(character, poses, progress).run();
}

}  // namespace throng
