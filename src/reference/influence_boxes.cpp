#include "reference/influence_boxes.h"

#include "reference/sampled_poses.h"

#include <algorithm>
#include <limits>
#include <span>

namespace throng {

Vec3<double> Box::corner(size_t index) const {
    return {index & 1 ? high.x : low.x, index & 2 ? high.y : low.y, index & 4 ? high.z : low.z};
}

double Box::largest_distance() const {
    const auto larger = [](double a, double b) { return std::max(std::abs(a), std::abs(b)); };
    return length(Vec3<double>{larger(low.x, high.x), larger(low.y, high.y), larger(low.z, high.z)});
}

namespace {

// [joint_count]: the scale from joint to model space in the rest pose. A joint that only the rest pose hides, by a
// scale of nearly 0, has the scale of its parent, since a clip may show it.
std::vector<double> scales_when_seen(const Rig& rig) {
    constexpr double kHidden = 5e-4;  // of the parent's scale; a change from metres to millimetres, 1e-3, is above it
    std::vector<double> scales;
    for (const AffineT<double>& model_from_joint : rest_model_from_joint(rig)) {
        const auto& row = model_from_joint.row;
        const double scale = length(Vec3<double>{row[0][0], row[1][0], row[2][0]});
        const uint32_t parent = rig.parents[scales.size()];
        const double above = parent == kNone ? 1 : scales[parent];
        scales.push_back(scale < kHidden * above ? above : scale);
    }
    return scales;
}

// A joint that moves no vertex may carry something, such as a sword. Errors are measured at this distance from it, as
// ACL does at 3 cm of a person (N. Frechette, Animation Compression Library, "Simulating the skinned mesh").
void add_unskinned(const Character& character, std::vector<Box>& boxes) {
    constexpr double kReach = 0.02, kReachWithoutMesh = 0.1;  // of the character's size
    const bool has_mesh = std::any_of(boxes.begin(), boxes.end(), [](const Box& box) { return !box.empty; });
    const std::vector<double> scales = scales_when_seen(character.rig);
    for (size_t joint = 0; joint < boxes.size(); ++joint) {
        if (!boxes[joint].empty) continue;
        const double half = character.size * (has_mesh ? kReach : kReachWithoutMesh) / (std::sqrt(3.0) * scales[joint]);
        boxes[joint] = {{-half, -half, -half}, {half, half, half}, false};
    }
}

struct WeightRange {
    double least = 0, most = 0;

    void add(float weight) {
        least = std::min(least, double{weight});
        most = std::max(most, double{weight});
    }
};

// [morphs]: the smallest and the largest of 0, the default weight and the weights in clips.
std::vector<WeightRange> weight_ranges(const Character& character) {
    std::vector<WeightRange> ranges(character.morphs.size());
    for (size_t morph = 0; morph < ranges.size(); ++morph) ranges[morph].add(character.morphs[morph].default_weight);
    for (size_t track = 0; track < character.morph_tracks.size(); ++track) {
        const uint32_t word = character.morph_tracks[track];
        if (word == kNone) continue;
        const Clip& clip = character.clips[track / ranges.size()];
        const uint32_t row_count = word & kTrackAnimated ? clip.morph_row_count : 1;
        for (size_t row = 0; row < row_count; ++row)
            ranges[track % ranges.size()].add(
                character.morph_values[(word & kTrackPosition) + row * clip.morph_row_stride]);
    }
    return ranges;
}

// The places of a vertex in bind space: without morphs, with each morph at weight 1, and the corners of a box that
// holds those of all weights within the ranges.
std::vector<Vec3<double>> places_of(const Character& character, const MeshSection& section, const Vertex& vertex,
                                    std::span<const WeightRange> ranges) {
    const Vec3<double> unmorphed = vertex.position.as<double>();
    std::vector<Vec3<double>> places{unmorphed};
    if (vertex.first_delta == 0) return places;
    Box reached{unmorphed, unmorphed, false};
    for (uint32_t target = 0; target < section.morph_count; ++target) {
        const auto delta = character.morph_deltas[vertex.first_delta - 1 + target].position.as<double>();
        const WeightRange& range = ranges[section.first_morph + target];
        Box moved;
        moved.add(delta * range.least);
        moved.add(delta * range.most);
        reached = {reached.low + moved.low, reached.high + moved.high, false};
        places.push_back(unmorphed + delta);
    }
    for (size_t corner = 0; corner < 8; ++corner) places.push_back(reached.corner(corner));
    return places;
}

// Calls visit(palette entry, weight, place in bind space) for each place of each vertex and each entry that moves it.
template <class Visit>
void visit_influences(const Character& character, const Visit& visit) {
    const std::vector<WeightRange> ranges = weight_ranges(character);
    for (const MeshSection& section : character.sections) {
        for (uint32_t vertex = 0; vertex < section.vertex_count; ++vertex) {
            const std::vector<Vec3<double>> places = places_of(
                character, section, character.vertices[section.first_vertex + vertex], ranges);
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
