// Deals the joints out: the spine and one braid down from the head first, which are the longest way, then legs and
// arms, and the rest to the cloak and to locks of hair.
#include "tools/creatures/walker.h"

namespace throng::creature {
namespace {

// Hips, waist, chest, shoulders, neck, head: one body, whose stations are about as far apart as its joints.
Outline spine_outline() {
    return {{{0, 0.84, 0.0}, 0.06, 0.07},      {{0, 0.91, 0.0}, 0.155, 0.105},
            {{0, 1.00, 0.0}, 0.158, 0.108},    {{0, 1.10, 0.005}, 0.128, 0.092},
            {{0, 1.21, 0.01}, 0.132, 0.096},   {{0, 1.33, 0.005}, 0.160, 0.112},
            {{0, 1.44, -0.01}, 0.188, 0.110},  {{0, 1.53, -0.015}, 0.135, 0.082},
            {{0, 1.60, -0.005}, 0.055, 0.056}, {{0, 1.67, 0.005}, 0.054, 0.060},
            {{0, 1.735, 0.025}, 0.078, 0.090}, {{0, 1.82, 0.02}, 0.098, 0.112},
            {{0, 1.91, 0.01}, 0.100, 0.118},   {{0, 2.01, 0.005}, 0.0}};
}
// Hip, knee, ankle, ball of the foot, toes.
Outline leg_outline(double side) {
    return {{{0.085 * side, 0.93, 0}, 0.070, 0.085},
            {{0.095 * side, 0.52, 0.015}, 0.056, 0.062},
            {{0.10 * side, 0.11, -0.02}, 0.042, 0.046},
            {{0.105 * side, 0.045, 0.09}, 0.045, 0.035},
            {{0.115 * side, 0.03, 0.20}, 0.03, 0.02}};
}
// Shoulder, elbow, wrist, knuckles, finger tips.
Outline arm_outline(double side) {
    return {{{0.155 * side, 1.475, -0.01}, 0.062, 0.066},
            {{0.320 * side, 1.245, -0.03}, 0.046, 0.050},
            {{0.455 * side, 1.030, 0.01}, 0.031, 0.036},
            {{0.505 * side, 0.945, 0.035}, 0.022, 0.042},
            {{0.545 * side, 0.865, 0.055}}};
}
// Out from the back of the head and down behind the cloak.
Outline braid_outline() {
    return {{{0, 1.93, -0.07}, 0.030},
            {{0, 1.92, -0.17}, 0.050, 0.045},
            {{0, 1.76, -0.24}, 0.062, 0.055},
            {{0, 1.52, -0.25}, 0.058, 0.050},
            {{0, 1.28, -0.30}, 0.050, 0.042},
            {{0, 1.06, -0.35}, 0.034, 0.030},
            {{0, 0.90, -0.37}}};
}
// Beside the face and over the shoulders: `place` 0 in front, 1 behind.
Outline lock_outline(double side, double place) {
    const double turns = mix(0.05, 0.24, place), length = mix(0.34, 0.42, place);
    const auto at = [&](double out, double y, double girth) {
        return Station{{side * out * 0.115 * cosine(turns - 0.08), y, 0.02 - out * 0.115 * sine(turns - 0.02)}, girth};
    };
    return {at(0.7, 1.97, 0.02), at(1.0, 1.86, 0.036), at(1.06, 1.86 - 0.35 * length, 0.036),
            at(1.2, 1.86 - 0.7 * length, 0.028), at(1.22, 1.86 - length, 0)};
}
// From the collar to the hem; `place` -1 at the right shoulder, 1 at the left.
Outline cloak_outline(double place) {
    const double turns = 0.25 * place, fold = cosine(3.5 * place);
    const auto at = [&](double width, double back, double depth, double y, double folds) {
        return Station{{width * sine(turns), y + 0.03 * cosine(turns), -back - depth * cosine(turns) - folds * fold}};
    };
    return {at(0.150, 0.005, 0.075, 1.545, 0),   at(0.205, 0.02, 0.110, 1.46, 0),
            at(0.225, 0.05, 0.115, 1.25, 0.008), at(0.250, 0.07, 0.125, 0.95, 0.018),
            at(0.290, 0.09, 0.140, 0.60, 0.028), at(0.325, 0.10, 0.155, 0.25, 0.036)};
}

class Dealer : Builder {
public:
    explicit Dealer(const CreatureSettings& settings) : Builder(settings), random_(settings.seed) {}

    Body deal() {
        const Outline outline = spine_outline();
        add_root(outline, kHipsAt, 1, kBehind);
        const uint32_t depth = level_count_ - 1;
        Chain spine{.part = "spine", .joint_count = std::min(8u, (depth + 1) / 2), .outline = outline, .up = kBehind};
        spine.step = (1 - kHipsAt) / (spine.joint_count + 1);
        spine.begin = kHipsAt + spine.step;
        const uint32_t braid = depth - spine.joint_count;
        add(std::move(spine));
        // Hung from the last joint of the spine, so that the way is as long as it must be.
        add_on_spine(1,
                     {.part = "hair", .joint_count = braid, .outline = braid_outline(), .phase_turns = random_.unit()});
        add_pair(kHipsAt - 0.03, {.part = "leg", .up = {0, 0, 1}}, leg_outline);
        add_pair(kChestAt, {.part = "arm", .up = {0, 0, 1}}, arm_outline);
        deal_locks();
        deal_cloak();
        return std::move(body_);
    }

private:
    const Chain& spine() const { return body_.chains[0]; }

    void add_on_spine(double t, Chain limb) { add_limb_on(spine(), t, std::move(limb)); }
    // Legs and arms bend at their stations: four joints, or else too few for that.
    void add_pair(double t, Chain limb, Outline (*outline)(double side)) {
        limb.joint_count = std::min(4u, left_ / 4);
        for (const double side : kSides) {
            limb.side = side;
            limb.outline = outline(side);
            add_on_spine(t, limb);
        }
    }

    // Two or three to each side of the face.
    void deal_locks() {
        const uint32_t each = std::min(left_ / 30, 8u);
        for (const double place : {0.0, 0.5, 1.0})
            for (const double side : kSides)
                add_on_spine(kHeadAt, {.part = "hair",
                                       .joint_count = each,
                                       .outline = lock_outline(side, place),
                                       .up = kBehind,
                                       .side = side,
                                       .phase_turns = random_.unit(),
                                       .number = 1 + uint32_t(2 * place)});
    }

    // From shoulder to shoulder, as long as levels and joints allow.
    void deal_cloak() {
        const uint32_t parent = with_room(spine().joint_at(kChestAt));
        const uint32_t fewest = left_ < 14 ? 2 : 7;
        const uint32_t wish = std::min(room_below(parent), std::max({(left_ + fewest - 1) / fewest, 1u}));
        const std::vector<uint32_t> lengths = share_out(left_, std::min(wish, 64u), fewest,
                                                        [&](uint32_t, uint32_t) { return room_below(parent); });
        const uint32_t count = std::max(2u, uint32_t(lengths.size()));
        for (uint32_t i = 0; i < count; ++i) {
            const double place = 1 - 2.0 * i / (count - 1);
            add_on_spine(kChestAt, {.part = "cloak",
                                    .joint_count = i < lengths.size() ? lengths[i] : 0,
                                    .outline = cloak_outline(place),
                                    .up = kBehind,
                                    .side = place,
                                    .number = i});
        }
    }

    Random random_;
};

}  // namespace

Body make_walker_body(const CreatureSettings& settings) { return Dealer(settings).deal(); }

}  // namespace throng::creature
