// A mesh that is simplified one collapse at a time. Each remaining triangle lists removed points of the fine mesh that
// it stands for.
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
        std::vector<uint32_t> lost;  // collapsed points nearest to this triangle; if there are very many, only some
    };

    // Starts with all points and faces of `fine`. Keeps the reference.
    explicit SimplifiedMesh(const WeldedMesh& fine);

    size_t face_count() const { return face_count_; }
    const Face& face(uint32_t number) const { return faces_[number]; }
    std::span<const uint32_t> faces_of(uint32_t point) const { return faces_of_[point]; }
    std::vector<uint32_t> neighbours_of(uint32_t point) const;  // each once

    // Moves the triangles of point `from` to its neighbour `to`. Triangles that have both points vanish. Returns the
    // points whose own possible collapses are affected, each once.
    std::vector<uint32_t> collapse(uint32_t from, uint32_t to);

    // The remaining triangles: every three indices, vertices of the character, form one.
    std::vector<uint32_t> indices() const;

private:
    void hand_on(std::span<const uint32_t> lost, std::span<const uint32_t> faces);

    const WeldedMesh& fine_;
    std::vector<Face> faces_;
    size_t face_count_;
    std::vector<std::vector<uint32_t>> faces_of_;  // [points]
    std::vector<FourTriangles> triangles_;         // [faces][groups of poses], of the faces that get lost points
};

}  // namespace throng
