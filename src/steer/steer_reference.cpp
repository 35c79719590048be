#include "steer/steer_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

constexpr double kReach = 2, kAvoidance = 6, kPassing = 1.5, kHorizon_s = 0.25, kArrival_s = 1, kAcceleration = 2,
                 kMinWish = 0.05, kFastSpeed = 10, kHeldUpFraction = 0.3, kPatience_s = 1 / 0.3, kRecovery_s = 2,
                 kMinWidth = 0.75;

// A vector on the ground plane, in world space.
struct Ground {
    double x = 0, z = 0;
};
Ground operator+(const Ground& a, const Ground& b) { return {a.x + b.x, a.z + b.z}; }
Ground operator*(double f, const Ground& a) { return {f * a.x, f * a.z}; }
double dot(const Ground& a, const Ground& b) { return a.x * b.x + a.z * b.z; }
double length(const Ground& a) { return std::hypot(a.x, a.z); }

Ground place_of(const SteeredAgent& agent) {
    return {agent.world_from_model.row[0][3], agent.world_from_model.row[2][3]};
}
Vec3<double> column(const AffineT<double>& m, size_t k) { return {m.row[0][k], m.row[1][k], m.row[2][k]}; }

Ground direction_of(uint32_t index) {
    const uint32_t mixed = index * 2654435769u, both = mixed ^ mixed >> 15;
    const Ground direction{(both & 0xFFFF) - 32767.25, (both >> 16) - 32767.25};
    return 1 / length(direction) * direction;
}

// `agents`: all agents as they were when the update began.
SteeredAgent step(std::span<const SteeredAgent> agents, uint32_t index, double time_step_s) {
    SteeredAgent agent = agents[index];
    const Vec3<double> x_axis = column(agent.world_from_model, 0), z_axis = column(agent.world_from_model, 2);
    const double scale = length(z_axis), upright = std::hypot(z_axis.x, z_axis.z);
    if (!agent.destination || !(upright > 1e-6 * scale)) {
        agent.speed = 0;
        agent.patience = 1;
        agent.stands = false;
        return agent;
    }
    const Steering& steering = agent.steering;
    const Ground place = place_of(agent), heading{z_axis.x / upright, z_axis.z / upright};
    const Ground way{agent.destination->x - place.x, agent.destination->z - place.z};
    const double remaining = length(way), radius = double{steering.radius}, max_speed = double{steering.speed};
    agent.stands = remaining < (agent.stands ? 2 : 1) * radius;
    const Ground ahead = agent.stands ? Ground() : 1 / remaining * way;
    const double comfort = agent.stands ? 0 : std::min(remaining / (3 * radius), 1.0),
                 width = kMinWidth + (1 - kMinWidth) * agent.patience;

    Ground push;
    double speed_limit = max_speed;
    for (uint32_t other = 0; other < agents.size(); ++other) {
        const Ground between = place_of(agents[other]) + -1 * place;
        const double apart = length(between), touching = radius + double{agents[other].steering.radius},
                     closest = touching * width;
        if (other == index || apart >= kReach * touching) continue;
        const Ground towards = apart > 0 ? 1 / apart * between : -1 * direction_of(index);
        const double approach = dot(heading, towards);
        if (apart > 0 && approach > 0)
            speed_limit = std::min(speed_limit,
                                   std::max(apart - closest, 0.0) / (2 * std::max(time_step_s, kHorizon_s) * approach));
        const double nearness = std::max(1 - apart / (closest * (1 + (kReach - 1) * comfort)), 0.0);
        const Ground right{-towards.z, towards.x};
        push = push + nearness * nearness * (kPassing * std::max(dot(towards, ahead), 0.0) * right + -1 * towards);
    }

    const double hurry = agent.stands ? 0 : std::min(max_speed, remaining / kArrival_s);
    Ground wish = hurry * ahead + kAvoidance * max_speed * push;
    const double eagerness = length(wish);
    if (eagerness < kMinWish * std::min(max_speed, kFastSpeed * radius)) wish = {};
    if (eagerness > max_speed) wish = max_speed / eagerness * wish;
    const double speed = std::min({std::max(dot(wish, heading), 0.0), speed_limit,
                                   agent.speed + kAcceleration * max_speed * time_step_s,
                                   (agent.stands ? radius : std::min(remaining, radius)) / time_step_s});
    const bool is_held_up = !agent.stands && speed < kHeldUpFraction * hurry;
    agent.patience = std::clamp(agent.patience + time_step_s * (is_held_up ? -1 / kPatience_s : 1 / kRecovery_s), 0.0,
                                1.0);
    agent.speed = speed;

    // A turn by yaw maps the model's +z axis to (sin, cos) in its xz plane.
    const double determinant = x_axis.x * z_axis.z - x_axis.z * z_axis.x;
    double yaw = 0;
    if (length(wish) > 0 && determinant != 0)
        yaw = std::atan2((z_axis.z * wish.x - z_axis.x * wish.z) / determinant,
                         (x_axis.x * wish.z - x_axis.z * wish.x) / determinant);
    const double max_yaw = std::min(double{steering.turn} * time_step_s, std::numbers::pi);
    yaw = std::clamp(yaw, -max_yaw, max_yaw);
    const Ground shift = agent.is_carried ? Ground() : speed * time_step_s * heading;
    agent.world_from_model = agent.world_from_model *
                             to_affine(Trs<double>{.rotation = axis_angle(Vec3<double>{0, 1, 0}, yaw)});
    agent.world_from_model.row[0][3] += shift.x;
    agent.world_from_model.row[2][3] += shift.z;
    return agent;
}

}  // namespace

double SteeredAgent::model_speed() const { return speed / length(column(world_from_model, 2)); }

std::vector<SteeredAgent> steer_reference(std::span<const SteeredAgent> agents, double time_step_s) {
    std::vector<SteeredAgent> after;
    for (uint32_t i = 0; i < agents.size(); ++i) after.push_back(step(agents, i, time_step_s));
    return after;
}

}  // namespace throng
