#include "compile/mesh/simplified_mesh.h"

#include <algorithm>
#include <limits>

namespace throng {
namespace {

// A triangle with more lost points than this forgets every second one: the work grows with their number.
constexpr size_t kMaxLost = 128;

void erase_copies(std::vector<uint32_t>& numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

void forget_some(std::vector<uint32_t>& lost) {
    if (lost.size() <= kMaxLost) return;
    for (size_t i = 0; 2 * i < lost.size(); ++i) lost[i] = lost[2 * i];
    lost.resize((lost.size() + 1) / 2);
}

}  // namespace

SimplifiedMesh::SimplifiedMesh(const WeldedMesh& fine)
    : fine_(fine),
      faces_(fine.faces().begin(), fine.faces().end()),
      face_count_(faces_.size()),
      faces_of_(fine.point_count()) {
    for (uint32_t face = 0; face < faces_.size(); ++face)
        for (const uint32_t point : faces_[face].points) faces_of_[point].push_back(face);
}

std::vector<uint32_t> SimplifiedMesh::neighbours_of(uint32_t point) const {
    std::vector<uint32_t> neighbours;
    neighbours.reserve(2 * faces_of_[point].size());
    for (const uint32_t face : faces_of_[point])
        for (const uint32_t other : faces_[face].points)
            if (other != point) neighbours.push_back(other);
    erase_copies(neighbours);
    return neighbours;
}

std::vector<uint32_t> SimplifiedMesh::collapse(uint32_t from, uint32_t to) {
    std::vector<uint32_t> lost{from}, changed{to};
    for (const uint32_t at : faces_of_[from]) {
        Face& face = faces_[at];
        lost.insert(lost.end(), face.lost.begin(), face.lost.end());
        face.lost.clear();
        if (face.has(to)) {
            face.is_there = false;
            --face_count_;
            for (const uint32_t point : face.points) {
                if (point == from) continue;
                std::erase(faces_of_[point], at);
                changed.push_back(point);
                if (faces_of_[point].size() == 1)  // collapses of its neighbours must not remove its last face
                    for (const uint32_t beside : neighbours_of(point)) changed.push_back(beside);
            }
            continue;
        }
        for (size_t k = 0; k < 3; ++k) {
            if (face.points[k] != from) continue;
            face.points[k] = to;
            face.vertices[k] = fine_.most_like(face.vertices[k], to).vertex;
        }
        faces_of_[to].push_back(at);
    }
    faces_of_[from].clear();
    hand_on(lost, faces_of_[to]);
    for (const uint32_t face : faces_of_[to]) forget_some(faces_[face].lost);
    for (const uint32_t point : neighbours_of(to)) changed.push_back(point);
    erase_copies(changed);
    return changed;
}

// Assigns each lost point to the face whose largest distance from it in any pose is the least.
void SimplifiedMesh::hand_on(std::span<const uint32_t> lost, std::span<const uint32_t> faces) {
    const size_t groups = fine_.groups();
    triangles_.clear();
    for (const uint32_t face : faces) {
        const auto& [a, b, c] = faces_[face].points;
        for (size_t group = 0; group < groups; ++group)
            triangles_.emplace_back(fine_.places(a)[group], fine_.places(b)[group], fine_.places(c)[group]);
    }
    for (const uint32_t point : lost) {
        uint32_t best = faces[0];
        float least = std::numeric_limits<float>::infinity();
        for (size_t i = 0; i < faces.size(); ++i) {
            float furthest = 0;
            for (size_t group = 0; group < groups && furthest < least; ++group)
                furthest = std::max(
                    furthest, largest(triangles_[i * groups + group].squared_distance(fine_.places(point)[group])));
            if (furthest < least) least = furthest, best = faces[i];
        }
        faces_[best].lost.push_back(point);
    }
}

std::vector<uint32_t> SimplifiedMesh::indices() const {
    std::vector<uint32_t> all;
    for (const Face& face : faces_)
        if (face.is_there) all.insert(all.end(), face.vertices.begin(), face.vertices.end());
    return all;
}

}  // namespace throng
