#include "compile/influence_boxes.h"

#include <algorithm>

namespace throng {

void Box::add(const Vec3<double>& p) {
    low = empty ? p : Vec3<double>{std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = empty ? p : Vec3<double>{std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    empty = false;
}

void Box::add(const Box& other) {
    if (other.empty) return;
    add(other.low);
    add(other.high);
}

Vec3<double> Box::corner(size_t index) const { return {index & 1 ? high.x : low.x, index & 2 ? high.y : low.y, index & 4 ? high.z : low.z}; }

double Box::largest_distance() const {
    const auto larger = [](double a, double b) { return std::max(std::abs(a), std::abs(b)); };
    return empty ? 0 : length(Vec3<double>{larger(low.x, high.x), larger(low.y, high.y), larger(low.z, high.z)});
}

std::vector<Box> influence_boxes(const Character& character) {
    std::vector<Box> boxes(character.rig.joint_count());
    for (const MeshSection& section : character.sections) {
        for (uint32_t vertex = 0; vertex < section.vertex_count; ++vertex) {
            const Vec3<double> bind_position = character.vertices[section.first_vertex + vertex].position.as<double>();
            for (uint32_t set = 0; set < section.influence_sets; ++set) {
                const Influences& influences = character.influences[section.first_influences + vertex * section.influence_sets + set];
                for (size_t i = 0; i < 4; ++i) {
                    if (!(influences.weights[i] > 0)) continue;
                    const PaletteEntry& entry = character.palette[influences.entries[i]];
                    boxes[entry.joint].add(transform_point(entry.joint_from_bind.as<double>(), bind_position));
                }
            }
        }
    }
    if (std::all_of(boxes.begin(), boxes.end(), [](const Box& box) { return box.empty; })) {
        const double half = double{character.size} * 0.1 / std::sqrt(3.0);
        for (Box& box : boxes) box = {{-half, -half, -half}, {half, half, half}, false};
    }
    return boxes;
}

double displacement(const AffineT<double>& difference, const Box& box) {
    const Vec3<double> middle = transform_point(difference, (box.low + box.high) * 0.5), half = (box.high - box.low) * 0.5;
    const auto axis = [&](size_t column, double extent) {
        return Vec3<double>{difference.row[0][column], difference.row[1][column], difference.row[2][column]} * extent;
    };
    const Vec3<double> x = axis(0, half.x), y = axis(1, half.y), z = axis(2, half.z), a = x + y, b = x - y;
    double largest = 0;
    for (const Vec3<double>& edge : {a + z, a - z, b + z, b - z})  // a corner and its opposite
        largest = std::max(largest, dot(middle, middle) + dot(edge, edge) + 2 * std::abs(dot(middle, edge)));
    return std::sqrt(largest);
}

}  // namespace throng
