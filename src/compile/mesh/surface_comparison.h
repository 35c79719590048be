// How far a level of detail is from the fine mesh, and where.
#pragma once

#include "base/progress.h"
#include "compile/mesh/coarse_mesh.h"
#include "compile/mesh/posed_mesh.h"
#include "compile/mesh/triangle_index.h"
#include "compile/mesh/welded_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// A place of one surface, and a place near it on the other, in a pose.
struct PlacePair {
    uint32_t pose = 0;
    size_t number = 0;           // of the place that was searched for: see SurfaceComparison
    uint32_t triangle = 0;       // of the other surface, where the place near it lies
    CoarseMesh::Place coarse{};  // the place of the coarse mesh
    Vec3<float> apart{};         // from there to the place of the fine mesh, model space
};

// Compares places of both surfaces with the other one, in all poses. Both directions count, since a surface may be near
// to all vertices of the other and still span a gap between them.
class SurfaceComparison {
public:
    // Keeps the reference. `coarse` may be moved between the calls.
    explicit SurfaceComparison(const CoarseMesh& coarse);

    struct Result {
        float largest = 0;             // the largest distance of any place in any pose, model space
        std::vector<PlacePair> pairs;  // ordered by their numbers
    };
    // Finds the largest distance, and the pairs that are farther apart than `part` of that and than `least`, model
    // space. Only in poses that were searched is a pair's triangle the nearest one. In others a nearer one may exist,
    // but the pair is at most 1.1 times as far apart as the place is in its worst pose. Both meshes must have
    // triangles.
    Result compare(float part, float least, const Progress& progress);
    // After the coarse mesh has moved a little: finds the nearest place anew, in the same triangle.
    void update(PlacePair& pair) const;

    uint64_t steps() const { return steps_; }  // of the searches
    // The places of the coarse mesh that are compared: the vertices, the middles of the edges and of the triangles;
    // neighbours follow one another.
    std::span<const CoarseMesh::Place> coarse_places() const { return coarse_places_; }

private:
    // A triangle near a place in a pose, and how far away it is.
    struct Near {
        uint32_t triangle = 0;
        float squared_distance = 0;
        bool is_searched = false;  // the triangle is the nearest one, or near enough
    };

    // Numbers of places: first those of the fine mesh, its points, then coarse_places().
    bool is_fine(size_t number) const { return number < welded_.point_count(); }
    size_t place_count() const { return welded_.point_count() + coarse_places_.size(); }
    const CoarseMesh::Place& coarse_place(size_t number) const {
        return coarse_places_[number - welded_.point_count()];
    }
    Four3 places(size_t number, size_t group) const;  // in a group of poses
    Vec3<float> place(size_t number, uint32_t pose) const { return places(number, pose / kLanes).at(pose % kLanes); }
    const TriangleIndex& other_surface(size_t number, uint32_t pose) const;
    void make_coarse_places();
    void move_surfaces();
    float squared_near_enough() const;
    void look_at(size_t number);
    void try_triangle(size_t number, uint32_t triangle);
    void search(size_t number, uint32_t pose, float squared_enough);

    const CoarseMesh& coarse_;
    const PosedMesh& fine_;
    const WeldedMesh& welded_;
    std::vector<TriangleIndex> coarse_surfaces_;  // [poses]
    std::vector<CoarseMesh::Place> coarse_places_;
    std::vector<uint32_t> likely_;  // [places]: a triangle that was near before
    std::vector<Near> near_;        // [poses], of the place that is looked at
    float squared_part_ = 0, squared_least_ = 0;
    float squared_largest_ = 0;  // as far as is known
    uint64_t steps_ = 0;
};

}  // namespace throng
