// A level of detail in the making: triangles between vertices of the fine mesh, or between copies of them that lie
// elsewhere.
#pragma once

#include "base/progress.h"
#include "compile/mesh/posed_mesh.h"
#include "compile/mesh/triangle_index.h"
#include "compile/mesh/welded_mesh.h"

#include <throng/character.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

class CoarseMesh {
public:
    // Every three `indices`, vertices of the character, form a triangle. `welded` says which vertices lie at one place
    // and have to move together. Keeps the references, but not `indices`.
    CoarseMesh(const Character& character, const PosedMesh& fine, const WeldedMesh& welded,
               std::span<const uint32_t> indices);

    const Character& character() const { return character_; }
    const PosedMesh& fine() const { return fine_; }
    const WeldedMesh& welded() const { return welded_; }

    // Three vertices of this mesh for each triangle.
    std::span<const uint32_t> indices() const { return indices_; }
    std::span<const uint32_t> sources() const { return sources_; }  // [vertices], the character's
    // [PosedMesh::groups()]: where a vertex is in each group of poses, model space.
    const Four3* positions(uint32_t vertex) const { return &positions_[vertex * groups_]; }
    Vec3<float> position(uint32_t vertex, uint32_t pose) const {
        return positions(vertex)[pose / kLanes].at(pose % kLanes);
    }
    // The triangles in a pose, as they were at the last move_surfaces(); at first not moved.
    const TriangleIndex& surface(uint32_t pose) const { return surfaces_[pose]; }
    void move_surfaces();

    // The places of this mesh that are compared with the fine one: a weighted sum of three vertices.
    struct Place {
        std::array<uint32_t, 3> vertices{};
        std::array<float, 3> weights{};
    };
    Four3 position(const Place& place, size_t group) const;
    Vec3<float> position(const Place& place, uint32_t pose) const;
    // The vertices, the middles of the edges and of the triangles; neighbours follow one another.
    std::span<const Place> places() const { return places_; }

    // Vertices at one place are one point.
    uint32_t point_of(uint32_t vertex) const { return point_of_[vertex]; }
    // [points]: how far away they are from where they are in the fine mesh, model space at rest. In other poses they
    // move with the vertices that they come from.
    std::span<const Vec3<float>> shifts() const { return shifts_; }
    void move(std::vector<Vec3<float>> shifts);
    // How a direction in model space moves the vertex at rest, if it moves it in a pose: by the transposed linear part
    // of its model_from_rest.
    Vec3<float> pull_at_rest(uint32_t vertex, uint32_t pose, const Vec3<float>& pull) const;
    bool is_moved(uint32_t vertex) const { return shifts_[point_of_[vertex]] != Vec3<float>{}; }
    Vec3<float> bind_position(uint32_t vertex) const;

private:
    AffineT<double> model_from_bind(uint32_t vertex, uint32_t pose) const;
    void make_places();
    void make_matrices();

    // The columns of a linear transform, in four poses.
    using Columns = std::array<Four3, 3>;

    const Character& character_;
    const PosedMesh& fine_;
    const WeldedMesh& welded_;
    size_t groups_;
    std::vector<uint32_t> indices_, sources_, point_of_;
    std::vector<Vec3<float>> shifts_;            // [points]
    std::vector<Four3> of_sources_, positions_;  // [vertices][groups]: where they come from, and where they are
    std::vector<Columns> model_from_rest_;       // [vertices][groups], linear parts
    std::vector<TriangleIndex> surfaces_;        // [poses]
    std::vector<Place> places_;
};

}  // namespace throng
