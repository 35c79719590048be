// A mesh whose vertices are welded into points. Vertices at the same place in every pose share one point, whatever
// their other attributes. So the mesh stays connected where vertices are duplicated for different normals or texture
// coordinates.
#pragma once

#include "base/progress.h"
#include "compile/mesh/four_triangles.h"

#include <throng/character.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

struct WeldedFace {
    std::array<uint32_t, 3> points, vertices;
};

class WeldedMesh {
public:
    // Every three `indices`, vertices of the character, form a triangle; triangles with two corners at one point are
    // left out. `positions` are [poses][vertices], the rest pose first. `progress` is only polled.
    WeldedMesh(const Character& character, std::span<const uint32_t> indices,
               std::span<const std::vector<Vec3<float>>> positions, const Progress& progress = {});

    size_t point_count() const { return vertices_of_.size(); }
    const std::vector<WeldedFace>& faces() const { return faces_; }
    uint32_t point_of(uint32_t vertex) const { return point_of_[vertex]; }  // kNone: no triangle has the vertex
    // [groups()]: the point's places in the first four poses, beginning with the rest pose, then in the next four, and
    // so on.
    const Four3* places(uint32_t point) const { return &places_[point * groups_]; }
    size_t groups() const { return groups_; }
    const Vec3<float>& rest_place(uint32_t point) const { return rest_places_[point]; }

    struct Corner {
        uint32_t vertex = 0;           // kNone: the point has no vertex of this section
        bool is_of_same_chart = true;  // same part of the texture
    };
    // The vertex of `point` that is most like `vertex`: of the same section, and of the same chart if the point has one
    // there.
    Corner most_like(uint32_t vertex, uint32_t point) const;

private:
    void weld(std::span<const uint32_t> indices, std::span<const std::vector<Vec3<float>>> positions, float close,
              const Progress& progress);
    void make_charts();

    const Character& character_;
    size_t groups_;
    std::vector<uint32_t> point_of_, section_of_, chart_of_;  // [vertices]
    std::vector<std::vector<uint32_t>> vertices_of_;          // [points]
    std::vector<WeldedFace> faces_;
    std::vector<Four3> places_;             // [points][groups]; the last pose is repeated to fill its group
    std::vector<Vec3<float>> rest_places_;  // [points], once more: looked at far more often than other poses
};

}  // namespace throng
