// How the walker moves: hips, knees and feet by the phase of the step, the hips as high as the longer leg allows; cloak
// and hair lag behind.
#include "tools/creatures/walker.h"

namespace throng::creature {
namespace {

enum Clip { kIdle, kWalk, kRun, kWave };

constexpr double kThigh = 0.41, kShin = 0.41;  // m

bool moves(uint32_t clip) { return clip == kWalk || clip == kRun; }
double step_of(double loop, double side) { return loop + (side > 0 ? 0.5 : 0); }

// Of one leg; backward is positive. The step begins with the foot far in front; it is on the ground for the first half.
struct LegPose {
    double hip, knee, foot;
};
LegPose leg_pose(uint32_t clip, double step) {
    const double lifted = std::max(0.0, -sine(step - 0.04)), lift = lifted * lifted;
    if (clip == kWalk) {
        const double hip = -0.06 - 0.40 * cosine(step), knee = 0.10 + 0.06 * sine(2 * step) + 0.95 * lift;
        return {hip, knee,
                -(hip + knee) - 0.28 * cosine(step) * smooth_step(-0.2, 1, cosine(step)) +
                    0.50 * std::max(0.0, -cosine(step)) * (1 - lift)};
    }
    if (clip == kRun) {
        const double hip = -0.18 - 0.66 * cosine(step), knee = 0.28 + 0.08 * sine(2 * step) + 1.35 * lift;
        return {hip, knee, -0.9 * (hip + knee) + 0.75 * std::max(0.0, -cosine(step))};
    }
    const double breath = 0.012 * sine(step);
    return {-0.02 - breath, 0.04 + 2 * breath, -0.02 - breath};
}
double reach(const LegPose& leg) {
    return kThigh * cosine(leg.hip / (2 * std::numbers::pi)) +
           kShin * cosine((leg.hip + leg.knee) / (2 * std::numbers::pi));
}
// The hips stand on the longer leg.
double hips_height(uint32_t clip, double loop) {
    const double left = reach(leg_pose(clip, step_of(loop, 1))), right = reach(leg_pose(clip, step_of(loop, -1)));
    const double apart = left - right, softness = 0.02;  // rounds the moment of changing over
    return 0.5 * (left + right + std::sqrt(apart * apart + softness * softness)) - kThigh - kShin;
}

// Of the bend between two of a limb's four bones.
double hinge(const Moment& m, uint32_t number) { return m.share_between(0.25 * number, 0.25 * number + 0.1); }

Bend bend_of_leg(const Moment& m) {
    const LegPose leg = leg_pose(m.clip, step_of(m.loop, m.chain.side));
    const double stir = 0.01 * m.share() * sine(m.loop);
    if (m.chain.joint_count < 4) return {m.k == 0 ? leg.hip + 0.4 * leg.knee : stir};  // a stilt
    const double toes = moves(m.clip) ? -0.5 * std::max(0.0, leg.foot + leg.hip + leg.knee) : stir;
    return {leg.hip * hinge(m, 0) + leg.knee * hinge(m, 1) + leg.foot * hinge(m, 2) + toes * hinge(m, 3)};
}

Bend bend_of_arm(const Moment& m) {
    const double side = m.chain.side, swing = cosine(step_of(m.loop, side));  // against the leg of its side
    double forward = 0.05 + 0.02 * sine(m.loop), down = 0.38 + 0.015 * sine(m.loop),
           elbow = 0.25 + 0.03 * sine(m.loop - 0.05), bow = 0, hand = 0.05 * sine(m.loop - 0.1);
    switch (m.clip) {
        case kWalk:
            forward = 0.04 - 0.46 * swing;
            elbow = 0.32 - 0.16 * swing;
            break;
        case kRun:
            forward = -0.12 - 0.72 * swing;
            down = 0.34;
            elbow = 1.35 - 0.25 * swing;
            break;
        case kWave:
            if (side > 0) break;
            // Up, to and fro from the elbow, and down again.
            const double up = smooth_step(0.04, 0.24, m.loop) * smooth_step(0.96, 0.76, m.loop),
                         beat = sine(4 * m.loop);
            forward = mix(forward, 0.15, up);
            down = mix(down, -1.05, up);
            elbow = mix(elbow, 0.2, up);
            bow = up * (-1.35 + 0.4 * beat);
            hand += 0.1 * up * beat;
            break;
    }
    if (m.chain.joint_count < 4)
        return {m.k == 0 ? -forward : 0.02 * m.share() * sine(m.loop), m.k == 0 ? -side * down : 0};
    const double shoulder = hinge(m, 0), middle = hinge(m, 1), wrist = hinge(m, 2), fingers = hinge(m, 3);
    return {-forward * shoulder - elbow * middle - hand * wrist - (0.2 + hand) * fingers,
            side * (-down * shoulder - bow * middle)};
}

Bend bend_of_spine(const Moment& m) {
    const double loop = m.loop, share = m.share(), head = m.share_between(0.7, 1), back = m.share_between(0, 0.7);
    const double breath = 0.015 * sine(m.clip == kIdle ? 2 * loop : loop);
    switch (m.clip) {
        case kWalk:
            return {0.05 * back - 0.05 * head + 0.02 * share * sine(2 * loop), 0.03 * back * sine(loop),
                    (-0.24 * back + 0.16 * head) * cosine(loop)};
        case kRun:
            return {0.24 * back - 0.20 * head + 0.03 * share * sine(2 * loop), 0.03 * back * sine(loop),
                    (-0.36 * back + 0.26 * head) * cosine(loop)};
        case kWave:
            return {breath * back - 0.05 * head, 0.05 * back * (0.5 - 0.5 * cosine(loop)),
                    head * -0.15 * (0.5 - 0.5 * cosine(loop)) + 0.01 * share * sine(loop)};
        default:
            return {breath * back - 0.03 * head * sine(loop), 0.02 * back * sine(loop), head * 0.22 * sine(loop - 0.1)};
    }
}

// Negative pitch lets the cloth fly back. The faster the walker, the more of it, most of all from the shoulders.
Bend bend_of_cloak(const Moment& m) {
    const double along = m.along(), share = m.share(), lag = 0.12 + 0.5 * along, edge = 0.09 * m.chain.side;
    const double flutter = sine(2 * m.loop - 2 * lag - edge), sway = sine(m.loop - lag - edge);
    switch (m.clip) {
        case kWalk: return {-share * (0.34 * (1.3 - 0.6 * along) + 0.16 * flutter), share * 0.16 * sway};
        case kRun: return {-share * (0.72 * (1.7 - 1.4 * along) + 0.38 * flutter), share * 0.24 * sway};
        default: return {-share * (0.05 + 0.05 * sine(m.loop - lag - 2 * edge)), share * 0.06 * sway};
    }
}

Bend bend_of_hair(const Moment& m) {
    const double along = m.along(), share = m.share(), turns = m.loop - 0.1 - 0.45 * along;
    const double length = m.chain.number == 0 ? 1 : 0.3;  // the braid, or a lock beside the face
    switch (m.clip) {
        case kWalk: return {-share * length * (0.30 + 0.20 * sine(2 * turns)), share * length * 0.4 * sine(turns)};
        case kRun: return {-share * length * (0.95 + 0.40 * sine(2 * turns)), share * length * 0.6 * sine(turns)};
        default:
            return {-share * length * (0.04 + 0.04 * sine(turns + m.chain.phase_turns)),
                    share * length * 0.14 * sine(turns)};
    }
}

RootMotion root_motion(uint32_t clip, double loop) {
    const double height = hips_height(clip, loop);
    switch (clip) {
        case kWalk: return {{-0.022 * sine(loop), height, 0}, {0, 0.09 * cosine(loop), 0.03 * sine(loop)}};
        case kRun:
            return {{-0.015 * sine(loop), height + 0.10 * (0.5 + 0.5 * cosine(2 * loop)), 0},
                    {0.04, 0.14 * cosine(loop), 0.02 * sine(loop)}};
        default: return {{0.008 * sine(loop), height, 0}, {0, 0.01 * sine(loop), 0}};
    }
}

}  // namespace

Model make_walker(const CreatureSettings& settings) {
    Body body = make_walker_body(settings);
    std::vector<Piece> flesh = make_walker_flesh(body, settings);
    return {std::move(body),
            std::move(flesh),
            {{{"idle", 72}, {"walk", 36}, {"run", 24}, {"wave", 72}},
             {{"spine", bend_of_spine},
              {"leg", bend_of_leg},
              {"arm", bend_of_arm},
              {"cloak", bend_of_cloak},
              {"hair", bend_of_hair}},
             root_motion}};
}

}  // namespace throng::creature
