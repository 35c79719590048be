// How far a level of detail is from the fine mesh, and where.
#pragma once

#include "base/progress.h"
#include "compile/mesh/coarse_mesh.h"
#include "compile/mesh/posed_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// A place of one surface, and the nearest place of the other, in a pose.
struct PlacePair {
    uint32_t pose = 0;
    size_t number = 0;           // of the place that was searched for: see SurfaceComparison
    uint32_t triangle = 0;       // of the other surface, where its nearest place lies
    CoarseMesh::Place coarse{};  // the place of the coarse mesh
    Vec3<float> apart{};         // from there to the place of the fine mesh, model space
};

// Compares places of both surfaces with the other one, in all poses. Both directions count, since a surface may be near
// to all vertices of the other and still span a gap between them.
class SurfaceComparison {
public:
    // Keeps the references. `coarse` may be moved between the calls.
    SurfaceComparison(CoarseMesh& coarse, const PosedMesh& fine);

    // The largest distance of any place, model space.
    float largest_distance(const Progress& progress);
    // The places that are farther away than `distance`, ordered by pose. Goes quickly over places that were near enough
    // before and around which the coarse mesh has hardly moved; largest_distance() must have run.
    std::vector<PlacePair> pairs_beyond(float distance, const Progress& progress);
    // After the coarse mesh has moved a little: finds the nearest place anew, in the same triangle.
    void update(PlacePair& pair) const;

    uint64_t steps() const { return steps_; }  // of the searches

private:
    // A triangle of the other surface that was near a place, and an upper bound of the place's distance from it.
    struct Near {
        uint32_t triangle = kNone;
        float distance = 0;
    };

    // Numbers of places: first those of the fine mesh, its vertices, then CoarseMesh::places().
    bool is_fine(size_t number) const { return number < fine_vertices_.size(); }
    size_t place_count() const { return fine_vertices_.size() + coarse_.places().size(); }
    Vec3<float> place(size_t number, uint32_t pose) const;
    const TriangleIndex& other_surface(size_t number, uint32_t pose) const;
    float search(size_t number, uint32_t pose, float near_enough);
    void note_movement(uint32_t pose);
    float movement(size_t number, const Near& near) const;

    CoarseMesh& coarse_;
    const PosedMesh& fine_;
    std::vector<uint32_t> fine_vertices_;          // distinct; neighbours follow one another
    std::vector<std::vector<Near>> near_;          // [poses][places]
    std::vector<std::vector<Vec3<float>>> known_;  // [poses][vertices of coarse_]: positions that near_ holds for
    std::vector<float> moved_by_;                  // [vertices of coarse_], since then, in the current pose
    uint64_t steps_ = 0;
};

}  // namespace throng
