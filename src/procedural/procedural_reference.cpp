#include "procedural/procedural_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

using Vector = Vec3<double>;
using Turn = Quaternion<double>;

constexpr double kParallel = 1e-6;

Vector rotated(const Turn& turn, const Vector& v) {
    return transform_vector(to_affine(Trs<double>{.rotation = turn}), v);
}
Vector origin_of(const AffineT<double>& m) { return {m.row[0][3], m.row[1][3], m.row[2][3]}; }
Vector column(const AffineT<double>& m, size_t c) { return {m.row[0][c], m.row[1][c], m.row[2][c]}; }

// The shortest turn from one direction to another.
Turn arc(const Vector& from, const Vector& to) {
    const Vector u = normalized(from), v = normalized(to), axis = cross(u, v);
    const double w = 1 + dot(u, v);
    if (w >= kParallel) return normalized(Turn{axis.x, axis.y, axis.z, w});
    const Vector across = normalized(cross(u, std::abs(u.x) < 0.7 ? Vector{1, 0, 0} : Vector{0, 1, 0}));
    return {across.x, across.y, across.z, 0};
}

// A turn of the world as one of a space that lies turned, and perhaps mirrored, in it.
Turn turn_within(const AffineT<double>& world_from_space, const Turn& turn) {
    const Vector x = normalized(column(world_from_space, 0)),
                 y = normalized(column(world_from_space, 1) - x * dot(x, column(world_from_space, 1))), z = cross(x, y);
    // A flat space has no turns
    if (dot(z, z) == 0 ||
        std::abs(dot(z, column(world_from_space, 2))) <= kParallel * length(column(world_from_space, 2)))
        return {};
    const double side = determinant(world_from_space) < 0 ? -1 : 1;
    const Vector axis{turn.x, turn.y, turn.z};
    return {side * dot(x, axis), side * dot(y, axis), dot(z, axis), turn.w};
}

double wave(double cycles) {
    const double x = 2 * (cycles - std::floor(cycles)) - 1;
    return 4 * x * (1 - std::abs(x));
}

double wind_at(const WindClock::Moment& wind, const Vector& place) {
    const double along = dot(place, wind.direction) * wind.gust_rate;
    return wind.speed *
           (1 + wind.gust * (0.5 * wave(wind.gust_phases[0] - along) + 0.3 * wave(wind.gust_phases[1] - 2.7 * along) +
                             0.2 * wave(wind.gust_phases[2] - 7.1 * along)));
}

struct Capsule {
    Vector a, b;
    double radius = 0;
};

Vector pushed_out(const Vector& place, const Capsule& capsule) {
    const Vector along = capsule.b - capsule.a;
    const double square = dot(along, along);
    const double t = square > 0 ? std::clamp(dot(place - capsule.a, along) / square, 0.0, 1.0) : 0;
    const Vector nearest = capsule.a + along * t, way = place - nearest;
    const double distance = length(way);
    return distance < capsule.radius && distance > 0 ? nearest + way * (capsule.radius / distance) : place;
}

}  // namespace

ProceduralReference::ProceduralReference(const ProceduralRules& rules, const Character& character)
    : targets(rules.targets.size()),
      rules_(rules),
      character_(character),
      plan_(plan_procedural(rules, character)),
      springs_(plan_.spring_count) {}

struct ProceduralReference::Update {
    ProceduralReference& reference;
    std::span<Trs<double>> local;
    const Moment& moment;

    AffineT<double> world_from_parent(uint32_t joint) const {
        AffineT<double> model_from_parent;
        for (uint32_t above = parent_of(joint); above != kNone; above = parent_of(above))
            model_from_parent = to_affine(local[above]) * model_from_parent;
        return moment.world_from_model * model_from_parent;
    }
    AffineT<double> world_from_joint(uint32_t joint) const {
        return world_from_parent(joint) * to_affine(local[joint]);
    }
    uint32_t parent_of(uint32_t joint) const { return reference.character_.rig.parents[joint]; }
    // About the joint's origin.
    void turn(uint32_t joint, const Turn& by) const {
        local[joint].rotation = turn_within(world_from_parent(joint), by) * local[joint].rotation;
    }
    const Target& target(const std::string& name) const {
        return reference
            .targets[size_t(std::ranges::find(reference.rules_.targets, name) - reference.rules_.targets.begin())];
    }

    void move(const PlannedChain& chain, const WindRule& rule) const {
        const WindClock::Moment& wind = moment.wind;
        if (wind.speed == 0) return;
        const double phase = double(uint32_t{moment.instance * 2654435769u}) * 0x1p-32 +
                             rounded_sway_hz(rule.sway_hz) * wind.sway_time_s;
        for (size_t k = 0; k < chain.joints.size(); ++k) {
            const AffineT<double> world = world_from_joint(chain.joints[k]);
            const Vector bone = transform_vector(world, chain.bones[k].as<double>());
            const Vector across = cross(normalized(bone), wind.direction);
            const double sine = length(across);
            if (sine <= kParallel) continue;
            const double angle_rad = std::atan2(sine, dot(normalized(bone), wind.direction));
            const double sway_rad = wind.speed * rule.sway_rad *
                                    wave(phase - 0.07 * double(chain.first_generation + k));
            const double bend_rad = std::clamp((wind_at(wind, origin_of(world)) * rule.bend_rad + sway_rad) * sine,
                                               angle_rad - std::numbers::pi, angle_rad);
            turn(chain.joints[k], axis_angle(normalized(across), bend_rad));
        }
    }

    void move(const PlannedChain& chain, const SpringRule& rule) const {
        std::vector<Capsule> capsules;
        for (const Collider& collider : rule.colliders) {
            const auto joint = static_cast<uint32_t>(std::ranges::find(reference.character_.rig.names, collider.joint) -
                                                     reference.character_.rig.names.begin());
            const AffineT<double> world = world_from_joint(joint);
            const double scale = std::max(
                {length(column(world, 0)), length(column(world, 1)), length(column(world, 2))});
            capsules.push_back({transform_point(world, collider.a.as<double>()),
                                transform_point(world, collider.b.as<double>()),
                                collider.radius * scale + rule.radius});
        }
        const double omega = 2 * std::numbers::pi * rule.frequency_hz, step_s = std::max(moment.time_step_s, 0.0);
        for (size_t k = 0; k < chain.joints.size(); ++k) {
            const AffineT<double> world = world_from_joint(chain.joints[k]);
            const Vector from = origin_of(world), rest = transform_point(world, chain.bones[k].as<double>());
            const double size = length(rest - from);
            Spring& spring = reference.springs_[chain.first_spring + k];
            if (size == 0) {
                spring.is_known = false;
                continue;
            }
            if (!spring.is_known) spring = {rest, {}, true};
            const Vector force = (rest - spring.place) * (omega * omega) + rule.gravity.as<double>() +
                                 moment.wind.direction * (rule.drag * wind_at(moment.wind, rest));
            const Vector velocity = (spring.velocity + force * step_s) *
                                    (1 / (1 + step_s * (2 * rule.damping * omega + step_s * omega * omega)));
            Vector place = spring.place + velocity * step_s;
            for (const Capsule& capsule : capsules) place = pushed_out(place, capsule);
            place = length(place - from) > 0 ? from + normalized(place - from) * size : rest;
            if (step_s > 0) spring.velocity = (place - spring.place) * (1 / step_s);
            spring.place = place;
            turn(chain.joints[k], arc(rest - from, place - from));
        }
    }

    void move(const PlannedChain& chain, const LookAtRule& rule) const {
        const Target& at = target(rule.target);
        const double weight = rule.weight * std::clamp(at.weight, 0.0, 1.0);
        if (weight <= 0) return;
        const AffineT<double> world = world_from_joint(chain.joints[0]);
        const Vector forward = normalized(transform_vector(world, rule.forward.as<double>())),
                     way = normalized(at.place - origin_of(world)), across = cross(forward, way);
        const double sine = length(across);
        if (sine <= kParallel) return;
        const double angle_rad = std::min(std::atan2(sine, dot(forward, way)), double{rule.limit_rad});
        turn(chain.joints[0], axis_angle(normalized(across), angle_rad * weight));
    }

    void move(const PlannedChain& chain, const ReachRule& rule) const {
        const uint32_t upper = chain.joints[0], middle = chain.joints[1], end = chain.joints[2];
        const Target& at = target(rule.target);
        const double weight = rule.weight * std::clamp(at.weight, 0.0, 1.0);
        if (weight <= 0) return;
        const Vector a = origin_of(world_from_joint(upper)), b = origin_of(world_from_joint(middle)),
                     c = origin_of(world_from_joint(end));
        const Vector goal = lerp(c, at.place, weight);
        const double upper_size = length(b - a), lower_size = length(c - b), far = upper_size + lower_size;
        if (std::min({upper_size, lower_size, length(goal - a), length(c - a)}) <= kParallel * far) return;
        const Vector to_goal = normalized(goal - a);
        const double near = std::abs(upper_size - lower_size), reached = std::clamp(length(goal - a), near, far);
        const Turn swing = arc(c - a, to_goal);
        const Vector upper_bone = rotated(swing, b - a),
                     pole = transform_vector(world_from_parent(upper), normalized(rule.pole.as<double>()));
        const auto aside_of = [&](const Vector& v) { return v - to_goal * dot(v, to_goal); };
        Vector side = aside_of(upper_bone);
        if (dot(side, side) < 1e-6 * upper_size * upper_size) side = aside_of(pole);
        if (dot(side, side) == 0) return;
        // Heron's formula: exactly straight where the limb is stretched.
        const double along = (upper_size * upper_size + reached * reached - lower_size * lower_size) / (2 * reached);
        const double aside = std::sqrt(std::max((far - reached) * (far + reached) * (reached - near) * (reached + near),
                                                0.0)) /
                             (2 * reached);
        const Vector wanted = to_goal * along + normalized(side) * aside;
        turn(upper, arc(upper_bone, wanted) * swing);
        turn(middle,
             arc(origin_of(world_from_joint(end)) - origin_of(world_from_joint(middle)), to_goal * reached - wanted));
    }
};

void ProceduralReference::update(std::span<Trs<double>> parent_from_joint, const Moment& moment) {
    const Update one{*this, parent_from_joint, moment};
    for (const PlannedChain& chain : plan_.chains)
        std::visit([&](const auto& rule) { one.move(chain, rule); }, rules_.rules[chain.rule]);
}

}  // namespace throng
