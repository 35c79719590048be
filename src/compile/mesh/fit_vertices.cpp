#include "compile/mesh/fit_vertices.h"

#include "compile/mesh/surface_comparison.h"

#include <algorithm>
#include <utility>

namespace throng {
namespace {

// Only places that are off by this part of the error are followed from step to step. kRounds times they are looked for
// anew, since moving points brings others far off.
constexpr float kFar = 0.5f;
constexpr int kRounds = 3, kStepsOfRound = 3;
constexpr float kStep = 0.4f;          // of the way: the places of a triangle pull at the same points
constexpr float kHold = 1;             // a weight that slows points which are hardly pulled at
constexpr float kWorthMoving = 0.95f;  // of the error before
// As a part of the character's size: levels that are off by no more stay as they are. They replace the fine mesh where
// a character is still hundreds of pixels tall. Few of a crowd are that near, too few for copies of vertices to be
// worth their memory.
constexpr float kSmall = 2.5e-3f;

class VertexFit {
public:
    VertexFit(CoarseMesh& mesh, SurfaceComparison& comparison)
        : mesh_(mesh), fine_(mesh.fine()), character_(mesh.character()), comparison_(comparison) {}

    // Returns the error of the result.
    float run(const Progress& progress) {
        const float before = compare(progress), small = kSmall * character_.size;
        if (before <= small) return before;
        float least = before;
        std::vector<Vec3<float>> best(mesh_.shifts().size());
        for (int round = 0; round < kRounds && least > small; ++round) {
            move(progress);
            const float error = compare(progress);
            if (!(error < least)) continue;
            least = error;
            best.assign(mesh_.shifts().begin(), mesh_.shifts().end());
        }
        if (!(least <= kWorthMoving * before)) {
            least = before;
            best.assign(best.size(), {});
        }
        mesh_.move(std::move(best));
        return least;
    }

private:
    // Returns the error, and sets pairs_.
    float compare(const Progress& progress) {
        auto [error, pairs] = comparison_.compare(kFar, kSmall * character_.size, progress);
        pairs_ = std::move(pairs);
        return error;
    }

    float largest_distance() const {
        float largest = 0;
        for (const PlacePair& pair : pairs_) largest = std::max(largest, length(pair.apart));
        return largest;
    }

    void move(const Progress& progress) {
        for (int step = 0; step < kStepsOfRound; ++step) {
            progress.poll();
            if (step > 0)
                for (PlacePair& pair : pairs_) comparison_.update(pair);
            move_points();
        }
        put_back_flipped();
    }

    static float weight_of(const Vec3<float>& apart, float largest) {
        const float squared = dot(apart, apart) / (largest * largest);
        return squared * squared * squared * squared;
    }

    void move_points() {
        const float largest = largest_distance();
        if (!(largest > 0)) return;
        std::vector<Vec3<float>> shifts(mesh_.shifts().begin(), mesh_.shifts().end()), pulls(shifts.size());
        std::vector<float> weights(shifts.size());
        for (const PlacePair& pair : pairs_) {
            const float weight = weight_of(pair.apart, largest);
            for (size_t k = 0; k < 3; ++k) {
                const float share = weight * pair.coarse.weights[k];
                const uint32_t vertex = pair.coarse.vertices[k], point = mesh_.point_of(vertex);
                pulls[point] = pulls[point] + mesh_.pull_at_rest(vertex, pair.pose, pair.apart) * share;
                weights[point] += share;
            }
        }
        for (size_t point = 0; point < shifts.size(); ++point) {
            // Its place on the fine surface pulls it back, whether or not that is among the pairs already
            const float weight = weight_of(shifts[point], largest);
            const Vec3<float> pull = pulls[point] - shifts[point] * weight;
            shifts[point] = shifts[point] + pull * (kStep / (weights[point] + weight + kHold));
        }
        keep_in_bounds(shifts);
        mesh_.move(std::move(shifts));
    }

    // Character::bounds_min and bounds_max hold for all levels of detail.
    void keep_in_bounds(std::vector<Vec3<float>>& shifts) const {
        for (uint32_t vertex = 0; vertex < mesh_.sources().size(); ++vertex) {
            const Vec3<float> rest = fine_.positions[0][mesh_.sources()[vertex]];
            Vec3<float>& shift = shifts[mesh_.point_of(vertex)];
            for (float Vec3<float>::*axis : {&Vec3<float>::x, &Vec3<float>::y, &Vec3<float>::z})
                shift.*axis = std::max(character_.bounds_min.*axis - rest.*axis,
                                       std::min(shift.*axis, character_.bounds_max.*axis - rest.*axis));
        }
    }

    // Points of triangles that have turned over go back.
    void put_back_flipped() {
        std::vector<Vec3<float>> shifts(mesh_.shifts().begin(), mesh_.shifts().end());
        const auto normal = [](const Triangle& of) { return cross(of[1] - of[0], of[2] - of[0]); };
        const std::span<const uint32_t> indices = mesh_.indices();
        for (size_t i = 0; i < indices.size(); i += 3) {
            Triangle now, before;
            for (size_t k = 0; k < 3; ++k) {
                now[k] = mesh_.position(indices[i + k], 0);
                before[k] = fine_.positions[0][mesh_.sources()[indices[i + k]]];
            }
            if (dot(normal(now), normal(before)) > 0) continue;
            for (size_t k = 0; k < 3; ++k) shifts[mesh_.point_of(indices[i + k])] = {};
        }
        mesh_.move(std::move(shifts));
    }

    CoarseMesh& mesh_;
    const PosedMesh& fine_;
    const Character& character_;
    SurfaceComparison& comparison_;
    std::vector<PlacePair> pairs_;
};

}  // namespace

FittedLevel fit_vertices(CoarseMesh mesh, const Progress& progress) {
    SurfaceComparison comparison(mesh);
    const float error = VertexFit(mesh, comparison).run(progress);
    return {std::move(mesh), error, comparison.steps()};
}

}  // namespace throng
