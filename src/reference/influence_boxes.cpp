#include "reference/influence_boxes.h"

#include "reference/sampled_poses.h"

#include <algorithm>
#include <limits>

namespace throng {

Vec3<double> Box::corner(size_t index) const {
    return {index & 1 ? high.x : low.x, index & 2 ? high.y : low.y, index & 4 ? high.z : low.z};
}

double Box::largest_distance() const {
    const auto larger = [](double a, double b) { return std::max(std::abs(a), std::abs(b)); };
    return length(Vec3<double>{larger(low.x, high.x), larger(low.y, high.y), larger(low.z, high.z)});
}

namespace {

// Joints that move no vertex may carry a sword: what hangs on them is measured at this distance, as ACL does at 3 cm of
// a person (N. Frechette, Animation Compression Library, "Simulating the skinned mesh").
void add_unskinned(const Character& character, std::vector<Box>& boxes) {
    constexpr double kReach = 0.02, kReachWithoutMesh = 0.1;  // of the character's size
    constexpr double kHidden = 1e-9;                          // a scale of the rest pose; clips may show the joint
    const bool has_mesh = std::any_of(boxes.begin(), boxes.end(), [](const Box& box) { return !box.empty; });
    const std::vector<AffineT<double>> model_from_joint = rest_model_from_joint(character.rig);
    for (size_t joint = 0; joint < boxes.size(); ++joint) {
        if (!boxes[joint].empty) continue;
        const auto& row = model_from_joint[joint].row;
        // The factor by which lengths grow from joint to model space
        const double scale = length(Vec3<double>{row[0][0], row[1][0], row[2][0]});
        const double half = character.size * (has_mesh ? kReach : kReachWithoutMesh) /
                            (std::sqrt(3.0) * (scale > kHidden ? scale : 1));
        boxes[joint] = {{-half, -half, -half}, {half, half, half}, false};
    }
}

// The places of a vertex in bind space: without morphs, and with each morph at weight 1.
std::vector<Vec3<double>> places_of(const Character& character, const MeshSection& section, const Vertex& vertex) {
    std::vector<Vec3<double>> places{vertex.position.as<double>()};
    for (uint32_t target = 0; vertex.first_delta > 0 && target < section.morph_count; ++target)
        places.push_back(places[0] + character.morph_deltas[vertex.first_delta - 1 + target].position.as<double>());
    return places;
}

// Calls visit(palette entry, weight, place in bind space) for each place of each vertex and each entry that moves it.
template <class Visit>
void visit_influences(const Character& character, const Visit& visit) {
    for (const MeshSection& section : character.sections) {
        for (uint32_t vertex = 0; vertex < section.vertex_count; ++vertex) {
            const std::vector<Vec3<double>> places = places_of(character, section,
                                                               character.vertices[section.first_vertex + vertex]);
            for (uint32_t set = 0; set < section.influence_sets; ++set) {
                const Influences& influences =
                    character.influences[section.first_influences + vertex * section.influence_sets + set];
                for (size_t i = 0; i < 4; ++i) {
                    if (!(influences.weights[i] > 0)) continue;
                    for (const Vec3<double>& place : places) visit(influences.entries[i], influences.weights[i], place);
                }
            }
        }
    }
}

}  // namespace

std::vector<Box> influence_boxes(const Character& character) {
    std::vector<Box> boxes(character.rig.joint_count());
    visit_influences(character, [&](uint16_t number, float, const Vec3<double>& place) {
        const PaletteEntry& entry = character.palette[number];
        boxes[entry.joint].add(transform_point(entry.joint_from_bind.as<double>(), place));
    });
    add_unskinned(character, boxes);
    return boxes;
}

std::vector<Box> bind_boxes(const Character& character) {
    std::vector<Box> boxes(character.palette.size());
    visit_influences(character, [&](uint16_t entry, float, const Vec3<double>& place) { boxes[entry].add(place); });
    return boxes;
}

std::vector<bool> joints_that_move_alone(const Character& character) {
    constexpr float kAll = 1 - 1e-5f;  // with such a weight, all others are rounding
    std::vector<bool> alone(character.rig.joint_count(), true);
    visit_influences(character, [&](uint16_t entry, float weight, const Vec3<double>&) {
        if (weight < kAll) alone[character.palette[entry].joint] = false;
    });
    return alone;
}

double displacement(const AffineT<double>& difference, const Box& box) {
    const Vec3<double> middle = transform_point(difference, (box.low + box.high) * 0.5),
                       half = (box.high - box.low) * 0.5;
    const auto axis = [&](size_t column, double extent) {
        return Vec3<double>{difference.row[0][column], difference.row[1][column], difference.row[2][column]} * extent;
    };
    const Vec3<double> x = axis(0, half.x), y = axis(1, half.y), z = axis(2, half.z), a = x + y, b = x - y;
    double largest = -1;                                           // no comparison with NaN is true
    for (const Vec3<double>& edge : {a + z, a - z, b + z, b - z})  // a corner and its opposite
        largest = std::max(largest, dot(middle, middle) + dot(edge, edge) + 2 * std::abs(dot(middle, edge)));
    return largest >= 0 ? std::sqrt(largest) : std::numeric_limits<double>::infinity();
}

}  // namespace throng
