// A mesh that loses its points one after the other, and what of the fine mesh each triangle that is left stands for.
#pragma once

#include "compile/mesh/welded_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

class SimplifiedMesh {
public:
    struct Face : WeldedFace {
        explicit Face(const WeldedFace& face) : WeldedFace(face) {}

        bool has(uint32_t point) const { return points[0] == point || points[1] == point || points[2] == point; }

        bool is_there = true;
        std::vector<uint32_t> lost;  // collapsed points that it is the nearest triangle to; of very many, some
    };

    // Of all points and faces. Keeps the reference.
    explicit SimplifiedMesh(const WeldedMesh& fine);

    size_t face_count() const { return face_count_; }
    const Face& face(uint32_t number) const { return faces_[number]; }
    std::span<const uint32_t> faces_of(uint32_t point) const { return faces_of_[point]; }
    std::vector<uint32_t> neighbours_of(uint32_t point) const;  // each once

    // Moves the triangles of one point to another one, which has some of them too: those vanish. Returns the points
    // for which that changes what a collapse of theirs does, each once.
    std::vector<uint32_t> collapse(uint32_t from, uint32_t to);

    // Of what is left: three of the character's vertices are a triangle.
    std::vector<uint32_t> indices() const;

private:
    void hand_on(std::span<const uint32_t> lost, std::span<const uint32_t> faces);

    const WeldedMesh& fine_;
    std::vector<Face> faces_;
    size_t face_count_;
    std::vector<std::vector<uint32_t>> faces_of_;  // [points]
    std::vector<FourTriangles> triangles_;         // [faces][groups of poses], of those that points are handed on to
};

}  // namespace throng
