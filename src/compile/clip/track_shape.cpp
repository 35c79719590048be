#include "compile/clip/track_shape.h"

#include "compile/clip/packed_track.h"

#include <algorithm>
#include <limits>

namespace throng {
namespace {

// If the component left out gets smaller than this, the square root that restores it enlarges the others' errors by
// more than storing it costs
constexpr double kSmallestLeftOut = 0.02;

double largest_part(const Vec3<double>& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Largest scale along the path from the root to the parent of each joint.
std::vector<double> parent_scales(const Character& character, std::span<const Trs<double>> pose) {
    std::vector<double> scales(pose.size(), 1);
    for (size_t joint = 0; joint < pose.size(); ++joint) {
        const uint32_t parent = character.rig.parents[joint];
        if (parent != kNone) scales[joint] = scales[parent] * largest_part(pose[parent].scale);
    }
    return scales;
}

// The radius around each joint, in its own space, within which everything that it moves lies.
std::vector<double> joint_radii(const Character& character, std::span<const Box> boxes,
                                std::span<const Trs<double>> pose) {
    std::vector<double> radii(pose.size());
    for (size_t joint = pose.size(); joint-- > 0;) {
        radii[joint] = std::max(radii[joint], boxes[joint].largest_distance());
        const uint32_t parent = character.rig.parents[joint];
        if (parent != kNone)
            radii[parent] = std::max(radii[parent],
                                     length(pose[joint].translation) + largest_part(pose[joint].scale) * radii[joint]);
    }
    return radii;
}

// The component that is best left out of a rotation that varies, and how small it gets.
std::pair<uint32_t, double> choose_left_out(bool step, std::span<const TrackValue> values) {
    std::array<double, 4> low, high, nearest;
    low.fill(1), high.fill(-1), nearest.fill(1);
    for (const TrackValue& value : values) {
        for (size_t c = 0; c < 4; ++c) {
            low[c] = std::min(low[c], value[c]);
            high[c] = std::max(high[c], value[c]);
            nearest[c] = std::min(nearest[c], std::abs(value[c]));
        }
    }
    std::pair<uint32_t, double> best{3, 0};
    for (uint32_t c = 0; c < 4; ++c)
        if ((step || low[c] > 0 || high[c] < 0) && nearest[c] > best.second) best = {c, nearest[c]};
    return best;
}

std::array<double, 3> stored_components(const TrackShape& shape, const TrackValue& value) {
    if (shape.target != TrackTarget::kRotation) return {value[0], value[1], value[2]};
    const double sign = value[shape.left_out] < 0 ? -1 : 1;
    return {sign * value[(shape.left_out + 1) % 4], sign * value[(shape.left_out + 2) % 4],
            sign * value[(shape.left_out + 3) % 4]};
}

// The displacement if every component deviates by this much.
double displacement_of(const TrackShape& shape, const std::array<double, 3>& deviation) {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) sum += std::pow(shape.sensitivity[c] * deviation[c], 2);
    return std::sqrt(sum);
}

std::array<double, 3> half_range(const TrackShape& shape) {
    std::array<double, 3> half;
    for (size_t c = 0; c < 3; ++c) half[c] = (shape.high[c] - shape.low[c]) / 2;
    return half;
}

PackedTrack full_rotation() {
    PackedTrack track;
    track.minimum.fill(-1);
    track.step.fill(kPackedFullStep);
    track.layout = kPackedFull | 3u << kPackedLeftOutShift | kPackedFullBits | kPackedFullBits << 5 |
                   kPackedFullBits << 10;
    return track;
}

PackedTrack middle_of(const TrackShape& shape) {
    PackedTrack track;
    for (size_t c = 0; c < 3; ++c) track.minimum[c] = static_cast<float>((shape.low[c] + shape.high[c]) / 2);
    if (shape.target == TrackTarget::kRotation) track.layout = shape.left_out << kPackedLeftOutShift;
    return track;
}

// `values`: those of the track in all rows, or the one that it always has.
TrackShape shape_of(TrackTarget target, bool step, const Trs<float>& rest, std::span<const TrackValue> values) {
    TrackShape shape{
        .target = target, .step = step, .rest = key_of(component(rest.as<double>(), target)), .first = values.front()};
    if (target == TrackTarget::kRotation && values.size() > 1) {
        const auto [left_out, smallest] = choose_left_out(step, values);
        shape.left_out = left_out;
        shape.full = smallest < kSmallestLeftOut;
    } else if (target == TrackTarget::kRotation) {
        for (uint32_t c = 0; c < 4; ++c)
            if (std::abs(shape.first[c]) > std::abs(shape.first[shape.left_out])) shape.left_out = c;
    }
    const std::array<double, 3> stored_rest = stored_components(shape, value_of(shape.rest));
    shape.low = shape.high = stored_components(shape, shape.first);
    for (const TrackValue& value : values) {
        const std::array<double, 3> stored = stored_components(shape, value);
        for (size_t c = 0; c < 3; ++c) {
            shape.low[c] = std::min(shape.low[c], stored[c]);
            shape.high[c] = std::max(shape.high[c], stored[c]);
            shape.rest_deviation[c] = std::max(shape.rest_deviation[c], std::abs(stored[c] - stored_rest[c]));
        }
    }
    return shape;
}

}  // namespace

std::vector<TrackShape> track_shapes(const Character& character, const ClipGrid& grid, std::span<const size_t> rows) {
    const std::vector<Trs<float>>& rest = character.rig.rest;
    std::vector<TrackShape> shapes;
    for (size_t joint = 0; joint < rest.size(); ++joint)
        for (const TrackTarget target : {TrackTarget::kTranslation, TrackTarget::kRotation, TrackTarget::kScale}) {
            const TrackValue value = component(grid.still[joint], target);
            shapes.push_back(shape_of(target, false, rest[joint], {&value, 1}));
        }
    std::vector<TrackValue> values;
    for (const ExactTrack& track : grid.tracks) {
        values.clear();
        for (const size_t row : rows) values.push_back(track.at_row(row));
        shapes[slot_of(track)] = shape_of(track.target, track.step, rest[track.joint], values);
    }
    return shapes;
}

std::vector<double> joint_reaches(const Character& character, std::span<const Box> boxes,
                                  std::span<const Trs<double>> pose) {
    std::vector<double> reaches = joint_radii(character, boxes, pose);
    const std::vector<double> scales = parent_scales(character, pose);
    for (size_t joint = 0; joint < pose.size(); ++joint)
        reaches[joint] *= scales[joint] * largest_part(pose[joint].scale);
    return reaches;
}

void add_sensitivity(std::vector<TrackShape>& shapes, const Character& character, std::span<const Box> boxes,
                     std::span<const Trs<double>> pose, double bound) {
    const std::vector<double> scales = parent_scales(character, pose), radii = joint_radii(character, boxes, pose);
    // In joint space: a box of what a rotation of the joint moves and no joint below makes up for
    std::vector<Box> levers(boxes.begin(), boxes.end());
    for (size_t joint = pose.size(); joint-- > 0;) {
        const auto shape = [&](TrackTarget target) -> TrackShape& {
            return shapes[joint * 3 + static_cast<size_t>(target)];
        };
        const auto raise = [&](TrackTarget target, size_t c, double value) {
            shape(target).sensitivity[c] = std::max(shape(target).sensitivity[c], value);
        };
        const AffineT<double> parent_from_joint = to_affine(pose[joint]);
        std::array<Vec3<double>, 8> arms;  // from the joint to the corners, in the space of its parent
        for (size_t i = 0; i < 8; ++i) arms[i] = transform_vector(parent_from_joint, levers[joint].corner(i));
        const uint32_t left_out = shape(TrackTarget::kRotation).left_out;
        const TrackValue q = component(pose[joint], TrackTarget::kRotation);
        for (uint32_t c = 0; c < 3; ++c) {
            TrackValue change{};
            const uint32_t stored = (left_out + 1 + c) % 4;
            change[stored] = 1;
            change[left_out] = -q[stored] /
                               std::copysign(std::max(std::abs(q[left_out]), kSmallestLeftOut), q[left_out]);
            const Quaternion<double> turn = Quaternion<double>{change[0], change[1], change[2], change[3]} *
                                            Quaternion<double>{-q[0], -q[1], -q[2], q[3]};
            const Vec3<double> radians = Vec3<double>{turn.x, turn.y, turn.z} * 2.0;
            for (const Vec3<double>& arm : arms)
                raise(TrackTarget::kRotation, c, scales[joint] * length(cross(radians, arm)));
            raise(TrackTarget::kTranslation, c, scales[joint]);
            raise(TrackTarget::kScale, c, scales[joint] * radii[joint]);
        }
        const uint32_t parent = character.rig.parents[joint];
        if (parent == kNone) continue;
        levers[parent].add(pose[joint].translation);
        const TrackShape& rotation = shape(TrackTarget::kRotation);
        if (!rotation.full && displacement_of(rotation, half_range(rotation)) <= bound) {
            const double radius = radii[joint] * largest_part(pose[joint].scale);  // limits the growth of nested boxes
            const Vec3<double>& o = pose[joint].translation;
            for (const Vec3<double>& arm : arms)
                levers[parent].add(o + Vec3<double>{std::clamp(arm.x, -radius, radius),
                                                    std::clamp(arm.y, -radius, radius),
                                                    std::clamp(arm.z, -radius, radius)});
        }
    }
}

PackedTrack plan_track(const TrackShape& shape, double tolerance) {
    constexpr double kConstant = 1.5;  // a constant saves more than a bit does, so it may err more
    const uint32_t flags = shape.step ? kPackedStep : 0;
    const bool moves_no_skin = shape.sensitivity == std::array<double, 3>{};
    if (moves_no_skin || (displacement_of(shape, shape.rest_deviation) <= kConstant * tolerance && !shape.full))
        return constant_track(shape.target, shape.rest);
    if (!shape.varies() && !shape.full) return constant_track(shape.target, key_of(shape.first));
    if (shape.full) {
        PackedTrack track = full_rotation();
        track.layout |= flags;
        return track;
    }
    PackedTrack track = middle_of(shape);
    if (displacement_of(shape, half_range(shape)) <= kConstant * tolerance) return track;

    // The errors of tracks add up like independent random ones. So equal errors cost the fewest bits, and rounding to
    // the nearest number of bits serves better than rounding up.
    for (uint32_t c = 0; c < 3; ++c) {
        const double range = shape.high[c] - shape.low[c],
                     cells = range * shape.sensitivity[c] / std::max(tolerance, std::numeric_limits<double>::min());
        if (!(cells > 1)) continue;
        const auto bits = static_cast<uint32_t>(
            std::min(std::nearbyint(std::log2(cells)), double{kPackedComponentBits}));
        const auto step = static_cast<float>(range / (1u << bits));
        if (bits == 0 || !(step > 0)) continue;
        track.step[c] = step;
        track.minimum[c] = static_cast<float>(shape.low[c] + double{step} / 2);
        track.layout |= bits << (5 * c);
    }
    if (packed_row_bits(track) > 0) track.layout |= flags;
    return track;
}

}  // namespace throng
