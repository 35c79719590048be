#include "compile/mesh/lod.h"

#include "base/count.h"
#include "bind/bind_reference.h"
#include "reference/sampled_poses.h"
#include "compile/mesh/triangle_index.h"
#include "morph/morph_reference.h"
#include "skin/skin_reference.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

namespace throng {
namespace {

constexpr size_t kFewest = 64 * 3;     // indices, below which nothing is gained
constexpr double kShare = 0.35;        // of the triangles of the level before that a level aims at
constexpr double kAlmost = 1.25;       // of them, which is still coarse enough
constexpr double kWorthwhile = 0.8;    // of them, above which it is not kept
constexpr float kLargestError = 0.2f;  // of a section's extent, by quadrics
constexpr uint32_t kPoses = 8;         // of all clips together, that errors are measured in
constexpr float kLeastError = 1e-6f;   // of the character's size, which rounding does not tell from none

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

// Vertices of the fine mesh that the coarse one lacks, such as are near to each other one after the other.
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

// Where a triangle may span what is none of the mesh that it stands for: its middle, and those of its edges.
constexpr size_t kMiddles = 4;
Vec3<float> middle_of(const Triangle& triangle, size_t which) {
    const auto& [a, b, c] = triangle;
    if (which == 0) return (a + b + c) * (1 / 3.0f);
    return (which == 1 ? a + b : which == 2 ? b + c : c + a) * 0.5f;
}

// For each of some places, a triangle of the mesh that was near to it when it was looked at last. Most often it is near
// enough in the next pose too, and the place is done with.
using NearTriangles = std::vector<uint32_t>;

// How far one of the places, a function of its number, lies from the mesh at most, where that is more than `known`; the
// quadrics' own measure is a mean, several times too low for this. Each is looked at only until it is known not to be
// the furthest, and none any more when one lies further than `useful`.
template <class Place>
float furthest_from(const TriangleIndex& mesh, NearTriangles& near, const Place& place, float known, float useful,
                    const Progress& progress, uint64_t& steps) {
    float furthest = known * known;
    uint32_t last = 0;
    // Some of all parts first: then it is known about how far the furthest is.
    for (const size_t stride : {size_t{16}, size_t{1}}) {
        for (size_t i = 0; i < near.size(); i += stride) {
            progress.poll_at(i);
            const TriangleIndex::Nearest found = mesh.nearest(place(i), furthest, near[i] == kNone ? last : near[i]);
            furthest = std::max(furthest, found.squared_distance);
            near[i] = last = found.triangle;
            steps += found.steps;
            if (furthest > useful * useful) return std::sqrt(furthest);
        }
    }
    return std::sqrt(furthest);
}

std::span<const uint32_t> indices_of(const Character& character, const MeshSection& section) {
    return std::span(character.indices).subspan(section.first_index, section.index_count);
}

// Triangles of a section, and how far they are off in the poses looked at so far.
struct Coarse {
    Coarse() = default;
    Coarse(std::vector<uint32_t> mesh, const TriangleIndex& fine, std::span<const Vec3<float>> positions)
        : indices(std::move(mesh)),
          index(indices, positions),
          lost(lost_vertices(fine, indices, positions.size())),
          near_lost(lost.size(), kNone),
          near_middles(indices.size() / 3 * kMiddles, kNone) {}

    // Raises the error to what it is in a pose.
    void measure(const TriangleIndex& fine, std::span<const Vec3<float>> positions, const Progress& progress,
                 uint64_t& steps) {
        index.move(positions);
        const auto lost_place = [&](size_t i) { return positions[lost[i]]; };
        const auto middle = [&](size_t i) { return middle_of(index.triangles()[i / kMiddles], i % kMiddles); };
        error = furthest_from(index, near_lost, lost_place, error, useful_error, progress, steps);
        if (may_be_best()) error = furthest_from(fine, near_middles, middle, error, useful_error, progress, steps);
    }

    bool may_be_best() const { return error <= useful_error; }

    std::vector<uint32_t> indices;
    float error = 0;
    bool leads = false;  // the least error in the first pose, among the candidates for one section and level
    // An error above it cannot be the least any more, so nobody needs to know how large it is
    float useful_error = std::numeric_limits<float>::infinity();
    TriangleIndex index;
    std::vector<uint32_t> lost;  // vertices
    NearTriangles near_lost;     // of these, among its own
    NearTriangles near_middles;  // of its middles, among those of the fine mesh
};

// By both ways of meshoptimizer, in the rest pose: edge collapses towards vertices that are there (M. Garland and P. S.
// Heckbert, Surface Simplification Using Quadric Error Metrics, SIGGRAPH 1997), which stop where the mesh comes apart,
// and clusters of vertices, which do not, and lose no thin part that is larger than a cluster.
// `index` is that of the fine mesh. Returns one or two.
std::vector<Coarse> coarse_meshes(std::span<const uint32_t> fine, const TriangleIndex& index,
                                  std::span<const Vec3<float>> positions, double share, const Progress& progress) {
    if (fine.empty()) return std::vector<Coarse>(1);
    const size_t wanted = static_cast<size_t>(share * static_cast<double>(fine.size())) / 3 * 3;
    std::vector<uint32_t> collapsed(fine.size()), clustered(fine.size());
    const size_t stride = sizeof positions[0];
    collapsed.resize(meshopt_simplify(collapsed.data(), fine.data(), fine.size(), &positions[0].x, positions.size(),
                                      stride, wanted, kLargestError, 0, nullptr));
    progress.poll();
    clustered.resize(meshopt_simplifySloppy(clustered.data(), fine.data(), fine.size(), &positions[0].x,
                                            positions.size(), stride, wanted, kLargestError, nullptr));
    progress.poll();
    if (collapsed.empty()) collapsed.assign(fine.begin(), fine.end());  // nothing vanishes
    const auto is_coarse = [wanted](const std::vector<uint32_t>& mesh) {
        return static_cast<double>(mesh.size()) <= kAlmost * static_cast<double>(wanted);
    };
    // Where not both are as coarse as they should be, the coarser one is taken however far it is off.
    const bool are_coarse = is_coarse(collapsed) && is_coarse(clustered) && !clustered.empty();
    const bool prefers_collapsed = clustered.empty() || collapsed.size() <= clustered.size();
    std::vector<Coarse> candidates;
    if (are_coarse || prefers_collapsed) candidates.emplace_back(std::move(collapsed), index, positions);
    progress.poll();
    if (are_coarse || !prefers_collapsed) candidates.emplace_back(std::move(clustered), index, positions);
    return candidates;
}

// All sections as one mesh: indices of the character's vertices.
std::vector<uint32_t> joined_indices(const Character& character) {
    std::vector<uint32_t> all;
    for (const MeshSection& section : character.sections)
        for (const uint32_t index : indices_of(character, section)) all.push_back(section.first_vertex + index);
    return all;
}

// By edge collapses of all sections together, so that those which lose least by it give up most triangles.
std::vector<uint32_t> collapsed_together(const Character& character, std::span<const Vec3<float>> positions,
                                         size_t wanted) {
    const std::vector<uint32_t> all = joined_indices(character);
    std::vector<uint32_t> collapsed(all.size());
    collapsed.resize(meshopt_simplify(collapsed.data(), all.data(), all.size(), &positions[0].x, positions.size(),
                                      sizeof positions[0], wanted, kLargestError, 0, nullptr));
    return collapsed;
}

// By clusters of one size in all sections.
std::vector<uint32_t> clustered_by(float cell, const Character& character, std::span<const Vec3<float>> positions) {
    std::vector<uint32_t> all;
    for (const MeshSection& section : character.sections) {
        const std::span<const uint32_t> fine = indices_of(character, section);
        if (fine.empty()) continue;
        const std::span<const Vec3<float>> places = positions.subspan(section.first_vertex, section.vertex_count);
        const float extent = meshopt_simplifyScale(&places[0].x, places.size(), sizeof places[0]);
        std::vector<uint32_t> clustered(fine.size());
        // It wants no triangles, and the error, a part of the extent, then is the size of a cluster
        clustered.resize(meshopt_simplifySloppy(clustered.data(), fine.data(), fine.size(), &places[0].x, places.size(),
                                                sizeof places[0], 0, std::min(cell / extent, 1.0f), nullptr));
        for (const uint32_t index : clustered) all.push_back(section.first_vertex + index);
    }
    return all;
}

std::vector<uint32_t> clustered_together(const Character& character, std::span<const Vec3<float>> positions,
                                         size_t wanted) {
    constexpr int kHalvings = 10;
    float least = 0, most = character.size;  // of a cluster
    std::vector<uint32_t> coarsest = clustered_by(most, character, positions);
    for (int i = 0; i < kHalvings; ++i) {
        const float middle = (least + most) / 2;
        std::vector<uint32_t> of_middle = clustered_by(middle, character, positions);
        const bool is_coarse = of_middle.size() <= wanted;
        (is_coarse ? most : least) = middle;
        if (is_coarse) coarsest = std::move(of_middle);
    }
    return coarsest;
}

// The one that is off by less.
const Coarse& best_of(const std::vector<Coarse>& candidates) {
    return *std::ranges::min_element(candidates, {}, &Coarse::error);
}

struct CoarseLevel {
    std::vector<std::vector<Coarse>> apart;  // [sections][candidates]
    std::vector<Coarse> together;            // candidates, of the joined mesh
};

// What a level is to have.
struct Chosen {
    std::vector<std::vector<uint32_t>> indices;  // [sections], relative to the section's first vertex
    size_t index_count = 0;
    float error = 0;
};

// Sections simplified together or apart, whichever is off by less and is not much finer.
Chosen best_of(const CoarseLevel& level, const Character& character) {
    Chosen chosen;
    for (const std::vector<Coarse>& candidates : level.apart) {
        const Coarse& best = best_of(candidates);
        chosen.indices.push_back(best.indices);
        chosen.index_count += best.indices.size();
        chosen.error = std::max(chosen.error, best.error);
    }
    const double most = kAlmost * static_cast<double>(chosen.index_count);
    for (const Coarse& together : level.together) {
        const auto count = static_cast<double>(together.indices.size());
        if (count == 0 || count > most || together.error >= chosen.error) continue;
        chosen = {.indices = std::vector<std::vector<uint32_t>>(character.sections.size()),
                  .index_count = together.indices.size(),
                  .error = together.error};
        for (const uint32_t index : together.indices) {
            const auto after = std::ranges::upper_bound(character.sections, index, {}, &MeshSection::first_vertex);
            chosen.indices[static_cast<size_t>(after - character.sections.begin()) - 1].push_back(
                index - std::prev(after)->first_vertex);
        }
    }
    return chosen;
}

class LodMaker {
public:
    LodMaker(Character& character, const Progress& progress)
        : character_(character), progress_(progress), levels_(kLodLimit) {
        const SampledPose rest{.clip = count_of(character.clips)};
        const std::vector<Vec3<float>> positions = positions_in(character, rest);
        for (const MeshSection& section : character.sections) {
            progress.poll();
            fine_.emplace_back(indices_of(character, section), of_section(section, positions));
        }
        if (fine_.size() > 1) joined_.emplace(joined_indices(character), positions);
        double share = 1;
        size_t done = 0;
        for (CoarseLevel& level : levels_) {
            share *= kShare;
            for (size_t i = 0; i < fine_.size(); ++i) {
                const MeshSection& section = character.sections[i];
                progress.report(done++, levels_.size() * fine_.size());
                level.apart.push_back(coarse_meshes(indices_of(character, section), fine_[i],
                                                    of_section(section, positions), share, progress));
            }
            if (!joined_) continue;
            const size_t wanted = static_cast<size_t>(share * static_cast<double>(character.indices.size())) / 3 * 3;
            for (auto* const simplified : {collapsed_together, clustered_together}) {
                progress.poll();
                level.together.emplace_back(simplified(character, positions, wanted), *joined_, positions);
            }
        }
    }

    // By definition: all candidates in all poses.
    void measure_all_in(std::span<const SampledPose> poses) {
        for (const SampledPose& pose : poses) {
            const std::vector<Vec3<float>> positions = positions_in(character_, pose);
            measure_apart(positions, [](const Coarse&) { return true; });
            measure_together(positions);
        }
    }

    // The same best candidates, with less work. An error only grows from pose to pose. So the candidates that begin
    // best are measured in all poses first, and then each of the others until it is known to be worse.
    void measure_in(std::span<const SampledPose> poses, const Progress& progress) {
        std::vector<std::vector<Vec3<float>>> positions;
        for (const SampledPose& pose : poses) {
            progress_.poll();
            positions.push_back(positions_in(character_, pose));
        }
        const size_t count = positions.size();
        size_t done = 0;
        const auto report = [&] { progress.report(done++, 2 * count); };
        report();
        measure_apart(positions[0], [](const Coarse&) { return true; });
        choose_leaders();
        for (size_t pose = 1; pose < count; ++pose) {
            report();
            measure_apart(positions[pose], &Coarse::leads);
        }
        bound_others();
        for (size_t pose = 0; pose < count; ++pose) {
            report();
            const auto is_other = [](const Coarse& coarse) { return !coarse.leads && coarse.may_be_best(); };
            if (pose > 0) measure_apart(positions[pose], is_other);
            measure_together(positions[pose]);
        }
    }

    // As long as triangles become markedly fewer.
    void keep_levels() {
        size_t count_before = character_.indices.size();
        float error = kLeastError * character_.size;
        for (const CoarseLevel& level : levels_) {
            const Chosen chosen = best_of(level, character_);
            const size_t count = chosen.index_count;
            if (count_before <= kFewest || static_cast<double>(count) > kWorthwhile * static_cast<double>(count_before))
                return;
            count_before = count;
            error = std::max(error, chosen.error);
            for (const std::vector<uint32_t>& indices : chosen.indices) {
                character_.lod_ranges.push_back({count_of(character_.lod_indices), count_of(indices)});
                character_.lod_indices.insert(character_.lod_indices.end(), indices.begin(), indices.end());
            }
            character_.lods.push_back({error});
        }
    }

    uint64_t steps() const { return steps_; }

private:
    // Raise errors to what they are in a pose: either way, since clusters may join what lies side by side, as legs, and
    // moves apart.
    template <class IsWanted>
    void measure_apart(std::span<const Vec3<float>> positions, const IsWanted& is_wanted) {
        for (size_t i = 0; i < fine_.size(); ++i) {
            const std::span<const Vec3<float>> places = of_section(character_.sections[i], positions);
            fine_[i].move(places);
            for (CoarseLevel& level : levels_)
                for (Coarse& coarse : level.apart[i])
                    if (std::invoke(is_wanted, coarse)) coarse.measure(fine_[i], places, progress_, steps_);
        }
    }
    void measure_together(std::span<const Vec3<float>> positions) {
        if (!joined_) return;
        joined_->move(positions);
        for (CoarseLevel& level : levels_)
            for (Coarse& coarse : level.together)
                if (coarse.may_be_best()) coarse.measure(*joined_, positions, progress_, steps_);
    }

    void choose_leaders() {
        for (CoarseLevel& level : levels_)
            for (std::vector<Coarse>& candidates : level.apart)
                std::ranges::min_element(candidates, {}, &Coarse::error)->leads = true;
    }

    // Sections that are simplified together have to do better than the worst of them apart (best_of()).
    void bound_others() {
        for (CoarseLevel& level : levels_) {
            float worst = 0;
            for (std::vector<Coarse>& candidates : level.apart) {
                const float least = std::ranges::find_if(candidates, &Coarse::leads)->error;
                for (Coarse& coarse : candidates) coarse.useful_error = least;
                worst = std::max(worst, least);
            }
            for (Coarse& coarse : level.together) coarse.useful_error = worst;
        }
    }

    static std::span<const Vec3<float>> of_section(const MeshSection& section, std::span<const Vec3<float>> positions) {
        return positions.subspan(section.first_vertex, section.vertex_count);
    }

    Character& character_;
    const Progress progress_;
    std::vector<TriangleIndex> fine_;      // [sections]
    std::optional<TriangleIndex> joined_;  // all of several sections
    std::vector<CoarseLevel> levels_;
    uint64_t steps_ = 0;
};

}  // namespace

uint64_t make_lods(Character& character, const Progress& progress, LodSearch search) {
    if (character.indices.size() <= kFewest) return 0;
    constexpr double kSimplified = 0.3;  // part of the work; the rest is measuring
    LodMaker maker(character, progress.between(0, kSimplified));
    const std::vector<SampledPose> poses = sampled_poses(character, kPoses);
    if (search == LodSearch::kExhaustive)
        maker.measure_all_in(poses);
    else
        maker.measure_in(poses, progress.between(kSimplified, 1));
    maker.keep_levels();
    return maker.steps();
}

}  // namespace throng
