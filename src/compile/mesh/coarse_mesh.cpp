#include "compile/mesh/coarse_mesh.h"

#include "base/affine.h"
#include "base/count.h"
#include "skin/skin_reference.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace throng {

CoarseMesh::CoarseMesh(const Character& character, const PosedMesh& fine, const WeldedMesh& welded,
                       std::span<const uint32_t> indices)
    : character_(character), fine_(fine), welded_(welded), groups_(fine.groups()) {
    std::vector<uint32_t> vertex_of(character.vertices.size(), kNone), point_numbers(welded.point_count(), kNone);
    for (const uint32_t source : indices) {
        if (vertex_of[source] == kNone) {
            vertex_of[source] = count_of(sources_);
            sources_.push_back(source);
            // Clusters may take a vertex that no triangle of the fine mesh has: it is a point by itself
            uint32_t alone = kNone;
            const uint32_t of_fine = welded.point_of(source);
            uint32_t& point = of_fine == kNone ? alone : point_numbers[of_fine];
            if (point == kNone) {
                point = count_of(shifts_);
                shifts_.emplace_back();
            }
            point_of_.push_back(point);
        }
        indices_.push_back(vertex_of[source]);
    }
    for (const uint32_t source : sources_)
        for (size_t group = 0; group < groups_; ++group)
            of_sources_.push_back(in_four_poses(fine.positions, source, group));
    positions_ = of_sources_;
}

AffineT<double> CoarseMesh::model_from_bind(uint32_t vertex, uint32_t pose) const {
    const MeshSection& section = *std::prev(
        std::ranges::upper_bound(character_.sections, sources_[vertex], {}, &MeshSection::first_vertex));
    return blended_reference(character_, section, sources_[vertex] - section.first_vertex, fine_.model_from_bind[pose]);
}

// Computed when a mesh is first moved: many never are, and this takes longer than all else of a coarse mesh.
std::span<const CoarseMesh::Columns> CoarseMesh::model_from_rest() {
    if (!model_from_rest_.empty()) return model_from_rest_;
    model_from_rest_.resize(positions_.size());
    for (uint32_t vertex = 0; vertex < sources_.size(); ++vertex) {
        const std::optional<AffineT<double>> bind_from_rest = inverse(model_from_bind(vertex, 0));
        if (!bind_from_rest) continue;  // it stays where it is
        for (uint32_t pose = 0; pose < fine_.pose_count(); ++pose) {
            const AffineT<float> m = (model_from_bind(vertex, pose) * *bind_from_rest).as<float>();
            Columns& columns = model_from_rest_[vertex * groups_ + pose / kLanes];
            for (size_t c = 0; c < 3; ++c) columns[c].set(pose % kLanes, {m.row[0][c], m.row[1][c], m.row[2][c]});
        }
    }
    return model_from_rest_;
}

void CoarseMesh::move(std::vector<Vec3<float>> shifts) {
    shifts_ = std::move(shifts);
    const std::span<const Columns> matrices = model_from_rest();
    for (size_t vertex = 0, at = 0; vertex < sources_.size(); ++vertex) {
        const Vec3<float>& shift = shifts_[point_of_[vertex]];
        for (size_t group = 0; group < groups_; ++group, ++at) {
            const auto& [x, y, z] = matrices[at];
            positions_[at] = of_sources_[at] + x * four(shift.x) + y * four(shift.y) + z * four(shift.z);
        }
    }
}

Four3 CoarseMesh::positions(const Place& place, size_t group) const {
    Four3 sum = positions(place.vertices[0])[group] * four(place.weights[0]);
    for (size_t k = 1; k < 3; ++k) sum = sum + positions(place.vertices[k])[group] * four(place.weights[k]);
    return sum;
}

Vec3<float> CoarseMesh::pull_at_rest(uint32_t vertex, uint32_t pose, const Vec3<float>& pull) {
    const auto& [x, y, z] = model_from_rest()[vertex * groups_ + pose / kLanes];
    const size_t lane = pose % kLanes;
    return {dot(x.at(lane), pull), dot(y.at(lane), pull), dot(z.at(lane), pull)};
}

Vec3<float> CoarseMesh::bind_position(uint32_t vertex) const {
    const Vec3<float> position = character_.vertices[sources_[vertex]].position;
    const std::optional<AffineT<double>> bind_from_rest = inverse(model_from_bind(vertex, 0));
    if (!bind_from_rest) return position;
    return position + transform_vector(*bind_from_rest, shifts_[point_of_[vertex]].as<double>()).as<float>();
}

}  // namespace throng
