// Motion for the dragon: waves that travel along the chains.
#include "tools/creatures/dragon.h"

namespace throng::creature {
namespace {

enum Clip { kIdle, kWalk, kFly, kGlide, kRoar };

bool in_air(uint32_t clip) { return clip == kFly || clip == kGlide; }
// How far the roar has swollen, 0 … 1.
double swell(double loop) { return smooth_step(0.1, 0.4, loop) * smooth_step(0.95, 0.65, loop); }

Bend bend_of_tail(const Moment& m) {
    const double loop = m.loop, along = m.along();
    const double share = 1.0 / (m.chain.joint_count + 2);  // few joints may not break the body where they bend
    const bool flies = in_air(m.clip);
    const double swing = flies ? 0.9 : m.clip == kWalk ? 2.0 : 1.6;
    const double lift = flies ? 1.1 : 0.45;
    const double droop = m.clip == kFly ? -0.35 : m.clip == kGlide ? -0.1 : 0;
    return {share * (lift * sine(loop - along - m.chain.phase_turns) + droop),
            share * swing * (0.3 + along) * sine(loop - along)};
}

Bend bend_of_trunk(const Moment& m) {
    const double loop = m.loop, along = m.along(), share = m.share();
    const double neck = m.share_between(0.2, 0.7), head = m.share_between(0.7, 1);
    switch (m.clip) {
        case kIdle:
            return {(share * 0.04 + neck * 0.10) * sine(loop) - head * 0.08 * sine(loop - 0.1),
                    0.18 * neck * sine(loop - 0.25) + 0.14 * head * sine(loop - 0.35)};
        case kWalk: return {share * 0.14 * sine(2 * loop - along * 0.6), share * -0.3 * sine(loop - along * 0.7)};
        case kFly:
            return {neck * (0.55 + 0.12 * sine(loop - 0.3)) - head * (0.45 + 0.1 * sine(loop - 0.3)),
                    0.05 * share * sine(loop)};
        case kGlide:  // looks about
            return {share * 0.03 * sine(loop) + neck * 0.6 - head * 0.5, 0.22 * (neck + head) * sine(loop)};
        case kRoar: {  // rears its neck, then throws the head forward
            const double high = swell(loop), late = swell(loop - 0.06);
            return {share * 0.08 * sine(loop) - neck * 0.55 * high +
                        head * (0.65 * high - 0.35 * late - 0.03 * high * sine(9 * loop)),
                    (neck + head) * (0.05 * sine(loop) + 0.16 * high * sine(2 * loop))};
        }
    }
    return {};
}

// A hip bend lets the leg swing back, a knee bend the shin, a foot bend the foot.
Bend bend_of_leg(const Moment& m) {
    const double loop = m.loop;
    const bool is_hind = m.chain.number == 1;
    double hip = 0, knee = 0, foot = 0;
    switch (m.clip) {
        case kIdle:
        case kRoar:
            hip = 0.025 * sine(loop);
            knee = -2 * hip;
            foot = hip;
            break;
        case kWalk: {  // trot: diagonal legs together; front legs fold forward, hind legs backward
            const double step = loop + ((m.chain.side > 0) == is_hind ? 0.5 : 0);
            const double lifted = std::max(0.0, cosine(step));
            hip = -0.42 * sine(step);
            knee = (is_hind ? 0.75 : -0.85) * lifted;
            foot = -0.6 * (hip + knee) + 0.35 * lifted;
            break;
        }
        case kFly:
        case kGlide:  // folded below the chest, trailing behind
            hip = (is_hind ? 0.85 : 0.75) + 0.06 * sine(loop - 0.2);
            knee = (is_hind ? 0.25 : -1.25) + 0.04 * sine(loop - 0.3);
            foot = (is_hind ? 0.75 : 1.2) + 0.08 * sine(loop - 0.4);
            break;
    }
    if (m.chain.joint_count < 3) return {m.k == 0 ? hip : 0.03 * sine(loop)};  // a stilt
    return {hip * m.share_between(0, 0.24) + knee * m.share_between(0.2, 0.48) + foot * m.share_between(0.5, 0.9), 0,
            0};
}

Bend bend_of_arm(const Moment& m) {
    const double loop = m.loop, share = m.share(), side = m.chain.side;
    const double beat = loop - 0.1 * m.along();
    switch (m.clip) {
        case kIdle: return {share * (0.10 * sine(beat) - 0.1), side * share * 0.06 * sine(loop - 0.2)};
        case kWalk: return {share * (0.10 * sine(2 * beat) - 0.25), side * share * (0.05 * sine(loop) - 0.45)};
        case kFly: return {share * (0.75 * sine(beat) - 0.1), side * share * 0.18 * sine(loop - 0.25)};
        case kGlide:  // spread, the wind under them; banks to where it looks
            return {share * (0.12 + 0.05 * sine(loop) + 0.10 * side * sine(loop - 0.05)),
                    side * share * 0.05 * sine(loop - 0.25)};
        case kRoar: return {share * (0.1 * sine(beat) - 0.1 - 0.45 * swell(loop)), side * share * 0.3 * swell(loop)};
    }
    return {};
}

// Fingers follow the arm's beat later; on the ground they close the fan halfway, the first ones furthest.
Bend bend_of_finger(const Moment& m) {
    const double loop = m.loop, share = m.share(), side = m.chain.side;
    const double beat = loop - 0.16 - 0.08 * m.along();
    switch (m.clip) {
        case kIdle: return {share * 0.10 * sine(beat), side * share * 0.05 * sine(loop - 0.2)};
        case kWalk: return {share * (0.12 * sine(2 * beat) + 0.1), side * share * -0.14 * (4 - double(m.chain.number))};
        case kFly: return {share * 0.4 * sine(beat), side * share * 0.06 * sine(loop - 0.3)};
        case kGlide: return {share * (0.08 * sine(2 * beat) - 0.12), side * share * 0.05 * sine(loop - 0.3)};
        case kRoar:
            return {share * (0.10 * sine(beat) - 0.15 * swell(loop - 0.05)),
                    side * share * (0.05 * sine(loop) + 0.1 * swell(loop))};
    }
    return {};
}

Bend bend_of_jaw(const Moment& m) {
    const double chatter = 0.08 * sine((in_air(m.clip) ? 1 : 2) * m.loop - m.chain.phase_turns);
    if (m.clip != kRoar) return {0.1 + chatter};
    return {0.1 + 0.5 * chatter + swell(m.loop) * (0.5 + 0.04 * sine(9 * m.loop))};
}

Bend bend_of_tendril(const Moment& m) {
    const double size = m.clip == kIdle ? 0.55 : 0.8;
    const double turns = m.loop - m.along() * 0.8 - m.chain.phase_turns;
    return {m.share() * (size * sine(turns) - (in_air(m.clip) ? 0.2 : 0)),
            m.chain.side * m.share() * 0.6 * size * sine(turns - 0.3)};
}

Bend bend_of_toe(const Moment& m) { return {m.share() * 0.12 * sine(m.loop - 0.1 * m.chain.number)}; }

RootMotion root_motion(uint32_t clip, double loop) {
    switch (clip) {
        case kIdle:
        case kRoar: return {{0, 0.012 * sine(loop), 0}, {0.012 * sine(loop + 0.25), 0, 0.01 * sine(loop)}};
        case kWalk:
            return {{0.015 * sine(loop), 0.03 * sine(2 * loop), 0},
                    {0.025 * sine(2 * loop + 0.2), 0.05 * sine(loop), 0.03 * sine(loop + 0.25)}};
        case kFly: return {{0, 0.55 - 0.11 * sine(loop - 0.05), 0}, {-0.06 + 0.05 * sine(loop)}};
        case kGlide: return {{0.05 * sine(loop), 0.55 + 0.05 * sine(loop - 0.25), 0}, {-0.03, 0, -0.14 * sine(loop)}};
    }
    return {};
}

}  // namespace

Model make_dragon(const CreatureSettings& settings) {
    Dragon dragon = make_dragon_body(settings);
    std::vector<Piece> flesh = make_dragon_flesh(dragon, settings);
    return {std::move(dragon.body),
            std::move(flesh),
            {{{"idle", 72}, {"walk", 36}, {"fly", 36}, {"glide", 72}, {"roar", 72}},
             {{"tail", bend_of_tail},
              {"trunk", bend_of_trunk},
              {"jaw", bend_of_jaw},
              {"leg", bend_of_leg},
              {"toe", bend_of_toe},
              {"arm", bend_of_arm},
              {"finger", bend_of_finger},
              {"tendril", bend_of_tendril}},
             root_motion}};
}

}  // namespace throng::creature
