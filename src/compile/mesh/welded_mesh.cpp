#include "compile/mesh/welded_mesh.h"

#include "base/count.h"
#include "compile/mesh/posed_mesh.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace throng {
namespace {

// As a part of the character's size: vertices that stay this close in all poses are one point. The errors of levels are
// measured at points, not at each vertex, so this has to be less than what is added to them for rounding (lod.cpp).
constexpr float kClose = 5e-7f;

// Union-find with path halving (R. E. Tarjan and J. van Leeuwen, Worst-case Analysis of Set Union Algorithms, 1984).
uint32_t root_of(std::vector<uint32_t>& sets, uint32_t member) {
    while (sets[member] != member) member = sets[member] = sets[sets[member]];
    return member;
}

// A measure of how different two normals are. It is not the angle between them, but it grows with that angle.
float squared_difference(uint32_t octahedral, uint32_t other) {
    float squared = 0;
    for (const int shift : {0, 16}) {
        const auto part = [shift](uint32_t normal) {
            return static_cast<float>(static_cast<int16_t>(normal >> shift)) / 32767.0f;
        };
        squared += (part(octahedral) - part(other)) * (part(octahedral) - part(other));
    }
    return squared;
}

// One coordinate of the vertices' places in one pose.
struct Axis {
    std::span<const Vec3<float>> places;  // [vertices]
    float Vec3<float>::*axis = &Vec3<float>::x;

    double operator()(uint32_t vertex) const { return double{places[vertex].*axis}; }
};

// The pose and the axis along which the vertices are farthest apart.
Axis widest_axis(std::span<const uint32_t> vertices, std::span<const std::vector<Vec3<float>>> positions) {
    Axis widest{positions[0]};
    double most = 0;
    for (const std::vector<Vec3<float>>& in_pose : positions) {
        for (float Vec3<float>::*axis : {&Vec3<float>::x, &Vec3<float>::y, &Vec3<float>::z}) {
            const Axis along{in_pose, axis};
            const auto [low, high] = std::ranges::minmax(vertices, {}, along);
            if (!(along(high) - along(low) > most)) continue;
            most = along(high) - along(low);
            widest = along;
        }
    }
    return widest;
}

// Bounds the work for hostile files. In a file, any number of vertices can lie at one place at rest, move apart in a
// pose, and still agree along the axis by which they are sorted, so that each would be compared with all others. A
// vertex that has been compared this often without a match begins a point of its own. The only harm is that the mesh is
// not connected there.
constexpr uint32_t kMaxCompared = 256;

// Sets first_of[vertex] to the first vertex of its point. `vertices` are those at one place at rest, in ascending
// order. Those that begin a point are kept sorted along an axis, so that only near ones are compared. `steps` counts
// the steps of the loops, for polling.
void find_firsts(std::span<const uint32_t> vertices, std::span<const std::vector<Vec3<float>>> positions, float close,
                 const Progress& progress, uint64_t& steps, std::vector<uint32_t>& first_of) {
    const auto stay_together = [&](uint32_t a, uint32_t b) {
        return std::ranges::all_of(positions, [&](const std::vector<Vec3<float>>& in_pose) {
            const Vec3<float> apart = in_pose[a] - in_pose[b];
            return dot(apart, apart) <= close * close;
        });
    };
    const double reach = 1.01 * double{close};  // the squares above are rounded
    const Axis place = widest_axis(vertices, positions);
    std::multimap<double, uint32_t> firsts;
    for (const uint32_t vertex : vertices) {
        progress.poll_at(steps++);
        const double at = place(vertex);
        uint32_t first = vertex, compared = 0;
        for (auto near = firsts.lower_bound(at - reach);
             near != firsts.end() && near->first <= at + reach && compared < kMaxCompared; ++near, ++compared) {
            progress.poll_at(steps++);
            if (near->second < first && stay_together(near->second, vertex)) first = near->second;
        }
        first_of[vertex] = first;
        if (first == vertex) firsts.emplace(at, vertex);
    }
}

}  // namespace

WeldedMesh::WeldedMesh(const Character& character, std::span<const uint32_t> indices,
                       std::span<const std::vector<Vec3<float>>> positions, const Progress& progress)
    : character_(character), groups_(groups_of_four(positions.size())) {
    for (uint32_t section = 0; section < character.sections.size(); ++section)
        section_of_.insert(section_of_.end(), character.sections[section].vertex_count, section);
    weld(indices, positions, kClose * character.size, progress);
    for (size_t t = 0; t < indices.size(); t += 3) {
        WeldedFace face;
        for (size_t k = 0; k < 3; ++k) {
            face.vertices[k] = indices[t + k];
            face.points[k] = point_of_[indices[t + k]];
        }
        const auto& [a, b, c] = face.points;
        if (a != b && b != c && c != a) faces_.push_back(face);
    }
    make_charts();
    for (const std::vector<uint32_t>& vertices : vertices_of_) {
        rest_places_.push_back(positions[0][vertices[0]]);
        for (size_t group = 0; group < groups_; ++group)
            places_.push_back(in_four_poses(positions, vertices[0], group));
    }
}

// Numbers the points in the order in which the triangles use them, so that neighbours are close in memory.
void WeldedMesh::weld(std::span<const uint32_t> indices, std::span<const std::vector<Vec3<float>>> positions,
                      float close, const Progress& progress) {
    std::vector<uint32_t> order(indices.begin(), indices.end());
    std::ranges::sort(order);
    order.erase(std::unique(order.begin(), order.end()), order.end());
    const auto rest = [&](uint32_t vertex) {
        const Vec3<float>& place = positions[0][vertex];
        return std::tuple(place.x, place.y, place.z);
    };
    std::ranges::stable_sort(order, {}, rest);
    std::vector<uint32_t> first_of(positions[0].size(), kNone);  // [vertices]: the first vertex of its point
    uint64_t steps = 0;
    for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        progress.poll_at(steps++);
        for (end = begin + 1; end < order.size() && rest(order[end]) == rest(order[begin]);) ++end;
        if (end - begin == 1)
            first_of[order[begin]] = order[begin];
        else
            find_firsts(std::span(order).subspan(begin, end - begin), positions, close, progress, steps, first_of);
    }
    point_of_.assign(first_of.size(), kNone);
    uint32_t point_count = 0;
    for (const uint32_t index : indices)
        if (uint32_t& point = point_of_[first_of[index]]; point == kNone) point = point_count++;
    vertices_of_.resize(point_count);
    for (const uint32_t vertex : order) {
        point_of_[vertex] = point_of_[first_of[vertex]];
        vertices_of_[point_of_[vertex]].push_back(vertex);
    }
}

// A chart: triangles whose texture coordinates agree where they meet.
void WeldedMesh::make_charts() {
    chart_of_.resize(point_of_.size());
    std::iota(chart_of_.begin(), chart_of_.end(), 0u);
    const auto unite = [&](uint32_t a, uint32_t b) { chart_of_[root_of(chart_of_, a)] = root_of(chart_of_, b); };
    for (const WeldedFace& face : faces_) {
        unite(face.vertices[0], face.vertices[1]);
        unite(face.vertices[1], face.vertices[2]);
    }
    // Compares bits, which have an order even if numbers are NaN. Adding 0 turns -0, which is equal to 0, into 0.
    const auto seam = [&](uint32_t vertex) {
        const auto& [u, v] = character_.vertices[vertex].texcoord;
        return std::tuple(section_of_[vertex], std::bit_cast<uint32_t>(u + 0.0f), std::bit_cast<uint32_t>(v + 0.0f));
    };
    // Sorted, so that only neighbours need to be compared: a file can put all of its vertices at one point.
    std::vector<uint32_t> sorted;
    for (const std::vector<uint32_t>& vertices : vertices_of_) {
        sorted = vertices;
        std::ranges::sort(sorted, {}, seam);
        for (size_t i = 1; i < sorted.size(); ++i)
            if (seam(sorted[i - 1]) == seam(sorted[i])) unite(sorted[i - 1], sorted[i]);
    }
    for (uint32_t vertex = 0; vertex < chart_of_.size(); ++vertex) chart_of_[vertex] = root_of(chart_of_, vertex);
}

WeldedMesh::Corner WeldedMesh::most_like(uint32_t vertex, uint32_t point) const {
    constexpr float kOfNormals = 1e-6f;  // where texture coordinates are the same, the normal decides
    constexpr float kOfCharts = 1e6f;
    const Vertex& wanted = character_.vertices[vertex];
    Corner best{.vertex = kNone};
    float least = std::numeric_limits<float>::infinity();
    for (const uint32_t candidate : vertices_of_[point]) {
        if (section_of_[candidate] != section_of_[vertex]) continue;
        const bool is_of_same_chart = chart_of_[candidate] == chart_of_[vertex];
        if (vertices_of_[point].size() == 1) return {candidate, is_of_same_chart};
        const Vertex& other = character_.vertices[candidate];
        const float u = other.texcoord[0] - wanted.texcoord[0], v = other.texcoord[1] - wanted.texcoord[1];
        const float difference = u * u + v * v +
                                 kOfNormals * squared_difference(other.normal_octahedral, wanted.normal_octahedral) +
                                 (is_of_same_chart ? 0 : kOfCharts);
        if (best.vertex != kNone && difference >= least) continue;
        least = difference;
        best = {candidate, is_of_same_chart};
    }
    return best;
}

}  // namespace throng
