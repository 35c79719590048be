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
    // and have to move together. Keeps the references to `character` and `fine`.
    CoarseMesh(const Character& character, const PosedMesh& fine, const WeldedMesh& welded,
               std::span<const uint32_t> indices);

    // Three vertices of this mesh for each triangle.
    std::span<const uint32_t> indices() const { return indices_; }
    std::span<const uint32_t> sources() const { return sources_; }  // [vertices], the character's
    std::span<const Vec3<float>> positions(uint32_t pose) const { return positions_[pose]; }  // [vertices], model space
    // The triangles, in the pose of the last move_surface(); at first in the rest pose.
    const TriangleIndex& surface() const { return surface_; }
    void move_surface(uint32_t pose) { surface_.move(positions_[pose]); }

    // The places of this mesh that are compared with the fine one: a weighted sum of three vertices.
    struct Place {
        std::array<uint32_t, 3> vertices{};
        std::array<float, 3> weights{};

        Vec3<float> in(std::span<const Vec3<float>> positions) const {
            return positions[vertices[0]] * weights[0] + positions[vertices[1]] * weights[1] +
                   positions[vertices[2]] * weights[2];
        }
    };
    // The vertices, the middles of the edges and of the triangles; neighbours follow one another.
    std::span<const Place> places() const { return places_; }

    // Vertices at one place are one point.
    uint32_t point_of(uint32_t vertex) const { return point_of_[vertex]; }
    // [points]: how far away they are from where they are in the fine mesh, model space at rest. In other poses they
    // move with the vertices that they come from.
    std::span<const Vec3<float>> shifts() const { return shifts_; }
    void move(std::vector<Vec3<float>> shifts);
    // The linear part of a vertex's model_from_rest in a pose, by columns.
    using Columns = std::array<Vec3<float>, 3>;
    const Columns& model_from_rest(uint32_t pose, uint32_t vertex) const { return model_from_rest_[pose][vertex]; }
    bool is_moved(uint32_t vertex) const { return shifts_[point_of_[vertex]] != Vec3<float>{}; }
    Vec3<float> bind_position(uint32_t vertex) const;

private:
    AffineT<double> model_from_bind(uint32_t vertex, uint32_t pose) const;
    void make_places();
    void make_matrices();

    const Character& character_;
    const PosedMesh& fine_;
    std::vector<uint32_t> indices_, sources_, point_of_;
    std::vector<Vec3<float>> shifts_;                    // [points]
    std::vector<std::vector<Vec3<float>>> positions_;    // [poses][vertices]
    std::vector<std::vector<Columns>> model_from_rest_;  // [poses][vertices]
    TriangleIndex surface_;
    std::vector<Place> places_;
};

}  // namespace throng
