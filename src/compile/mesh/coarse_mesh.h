// A level of detail in the making: triangles between vertices of the fine mesh, or between copies of them that lie
// elsewhere.
#pragma once

#include "compile/mesh/posed_mesh.h"
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
    // [PosedMesh::groups()]: where a vertex is in each group of poses, model space; lanes beyond the last pose mean
    // nothing.
    const Four3* positions(uint32_t vertex) const { return &positions_[vertex * groups_]; }
    Vec3<float> position(uint32_t vertex, uint32_t pose) const {
        return positions(vertex)[pose / kLanes].at(pose % kLanes);
    }

    // A place of this mesh: a weighted sum of three vertices.
    struct Place {
        std::array<uint32_t, 3> vertices{};
        std::array<float, 3> weights{};
    };
    Four3 positions(const Place& place, size_t group) const;  // in a group of poses

    // Vertices at one place are one point.
    uint32_t point_of(uint32_t vertex) const { return point_of_[vertex]; }
    // [points]: how far away they are from where they are in the fine mesh, model space at rest. In other poses they
    // move with the vertices that they come from.
    std::span<const Vec3<float>> shifts() const { return shifts_; }
    void move(std::vector<Vec3<float>> shifts);
    // A direction in a pose, turned back to the rest pose by the transposed linear part of the vertex's
    // model_from_rest.
    Vec3<float> pull_at_rest(uint32_t vertex, uint32_t pose, const Vec3<float>& pull);
    bool is_moved(uint32_t vertex) const { return shifts_[point_of_[vertex]] != Vec3<float>{}; }
    Vec3<float> bind_position(uint32_t vertex) const;

private:
    // The columns of a linear transform, in four poses.
    using Columns = std::array<Four3, 3>;

    AffineT<double> model_from_bind(uint32_t vertex, uint32_t pose) const;
    std::span<const Columns> model_from_rest();

    const Character& character_;
    const PosedMesh& fine_;
    const WeldedMesh& welded_;
    size_t groups_;
    std::vector<uint32_t> indices_, sources_, point_of_;
    std::vector<Vec3<float>> shifts_;            // [points]
    std::vector<Four3> of_sources_, positions_;  // [vertices][groups]: where they come from, and where they are
    std::vector<Columns> model_from_rest_;       // [vertices][groups], linear parts; empty before they are needed
};

}  // namespace throng
