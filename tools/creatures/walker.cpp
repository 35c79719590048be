// The walker: a person with a cloak and long hair.
#include "tools/creatures/model.h"

namespace throng::creature {
namespace {

// Places on the spine's outline, which goes from the hips to the crown.
constexpr double kHipsAt = 2.0 / 13, kChestAt = 6.0 / 13, kHeadAt = 9.5 / 13, kNeckFrom = 7.6 / 13, kWaistAt = 2.9 / 13;
constexpr Vec kBehind{0, 0, -1};  // "up" along the spine

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

// Distributes the joints: first the spine and one braid down from the head, which form the longest path, then legs and
// arms. The rest go to the cloak and to locks of hair.
class WalkerJoints : Builder {
public:
    explicit WalkerJoints(const CreatureSettings& settings) : Builder(settings), random_(settings.seed) {}

    Body deal() {
        const Outline outline = spine_outline();
        add_root(outline, kHipsAt, 1, kBehind);
        const uint32_t depth = level_count_ - 1;
        Chain spine{.part = "spine", .joint_count = std::min(8u, (depth + 1) / 2), .outline = outline, .up = kBehind};
        spine.step = (1 - kHipsAt) / (spine.joint_count + 1);
        spine.begin = kHipsAt + spine.step;
        const uint32_t braid = depth - spine.joint_count;
        add(std::move(spine));
        // Hangs from the last joint of the spine, so that the path is as long as it must be.
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
    // Legs and arms bend at their stations, which takes four joints; fewer only if too few are left.
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

enum MaterialOf : uint32_t { kSkin, kHair, kTunic, kTrousers, kLeather, kCloak, kEyes };

constexpr Vec kWhite{1, 1, 1};

// Colours of the materials. Pieces are painted lighter or darker, so that a change of a colour changes all of them.
struct Colors {
    Vec skin, hair, tunic, trousers, leather, cloak;

    explicit Colors(uint64_t seed) {
        Random random(~seed);
        const double tone = random.unit(), hue = random.unit(), other = hue + random.between(0.3, 0.6);
        skin = lerp(color_of(0.065, 0.38, 0.92), color_of(0.06, 0.55, 0.42), tone);
        const double dye = random.unit();
        hair = dye < 0.3   ? color_of(0.11, 0.6, random.between(0.6, 0.85))
               : dye < 0.6 ? color_of(0.04, 0.75, random.between(0.35, 0.6))
                           : color_of(0.07, 0.5, random.between(0.1, 0.3));
        tunic = color_of(other, random.between(0.25, 0.5), random.between(0.6, 0.85));
        trousers = color_of(other + 0.1, 0.3, random.between(0.25, 0.4));
        leather = color_of(0.07, 0.55, random.between(0.28, 0.4));
        cloak = color_of(hue, random.between(0.65, 0.85), random.between(0.6, 0.85));
    }
};

// In the order of MaterialOf.
std::vector<Material> materials_of(uint64_t seed) {
    const Colors colors(seed);
    return {
        {"skin", colors.skin},       {"hair", colors.hair},   {"tunic", colors.tunic}, {"trousers", colors.trousers},
        {"leather", colors.leather}, {"cloak", colors.cloak}, {"eyes", kWhite}};
}

class WalkerPieces : BodyPieces {
public:
    explicit WalkerPieces(const Body& body)
        : BodyPieces(body), spine_(body.chains[0].outline), spine_bones_(bones_of(body.chains[0])) {}

    std::vector<Piece> dress() {
        add(Tube{.outline = spine_,
                 .to = 8.2 / 13,
                 .bones = spine_bones_,
                 .up = kBehind,
                 .paint = fading(kWhite * 0.8, kWhite),
                 .open_start = false,
                 .sides = {10, 4},
                 .segments = {12, 4},
                 .material = kTunic});
        add(Tube{.outline = spine_,
                 .from = kNeckFrom,
                 .bones = spine_bones_,
                 .up = kBehind,
                 .paint = plain(kWhite),
                 .sides = {10},
                 .segments = {10, 4},
                 .material = kSkin});
        for (const Chain& leg : body_.chains_of("leg")) add_leg(leg);
        for (const Chain& arm : body_.chains_of("arm")) add_arm(arm);
        add_cloak();
        add_hair();
        add_skirt();
        add_face();
        return std::move(pieces_);
    }

private:
    // Shins and forearms are straight.
    static Bones bony(const Chain& limb) {
        Bones bones = bones_of(limb);
        bones.blend = 0.45;
        return bones;
    }
    static Station thicker(const Outline& limb, double t, double times) {
        const Station s = limb.at(t);
        return {s.center, s.width * times, s.height * times};
    }
    // The bones between two places of a limb, for a piece that covers only that part.
    static Bones part_of(Bones bones, double from, double to) {
        for (double& bound : bones.bounds) bound = (bound - from) / (to - from);
        return bones;
    }

    void add_leg(const Chain& leg) {
        const Bones bones = bony(leg);
        const Outline& flesh = leg.outline;
        add(Tube{.outline = flesh,
                 .to = 0.56,
                 .bones = bones,
                 .up = leg.up,
                 .paint = fading(kWhite, kWhite * 0.8),
                 .sides = {7},
                 .segments = {8, 2},
                 .material = kTrousers});
        // A boot: shaft and foot.
        add(Tube{.outline = {thicker(flesh, 0.34, 1.16), thicker(flesh, 0.40, 1.15), thicker(flesh, 0.47, 1.15),
                             thicker(flesh, 0.52, 1.1)},
                 .bones = part_of(bones, 0.34, 0.52),
                 .up = leg.up,
                 .paint = fading(kWhite, kWhite * 0.75),
                 .sides = {7},
                 .segments = {3},
                 .material = kLeather});
        const double x = flesh.at(0.5).center.x, out = 0.02 * leg.side;
        add(Tube{.outline = {{{x, 0.07, -0.085}},
                             {{x, 0.062, -0.07}, 0.040, 0.055},
                             {{x, 0.066, 0.0}, 0.048, 0.064},
                             {{x + 0.5 * out, 0.044, 0.09}, 0.056, 0.044},
                             {{x + out, 0.034, 0.17}, 0.050, 0.033},
                             {{x + out, 0.028, 0.215}}},
                 .bones = part_of(bones, 0.42, 0.96),
                 .paint = plain(kWhite * 0.75),
                 .open_start = false,
                 .sides = {7},
                 .segments = {6, 3},
                 .material = kLeather});
    }

    void add_arm(const Chain& arm) {
        const Bones bones = bony(arm);
        const Outline& flesh = arm.outline;
        add(Tube{.outline = flesh,
                 .to = 0.5,
                 .bones = bones,
                 .up = arm.up,
                 .paint = fading(kWhite, kWhite * 0.85),
                 .open_start = false,
                 .sides = {7},
                 .segments = {8, 3},
                 .material = kTunic});
        add(Tube{.outline = flesh,
                 .from = 0.42,
                 .bones = bones,
                 .up = arm.up,
                 .paint = plain(kWhite),
                 .sides = {6},
                 .segments = {5},
                 .material = kSkin});
        const Vec palm = flesh.at(0.62).center;
        add(Tube{.outline = {{palm, 0.014},
                             {palm + Vec{-0.012 * arm.side, -0.035, 0.045}, 0.013},
                             {palm + Vec{-0.008 * arm.side, -0.075, 0.055}}},
                 .bones = stiff(influences_at(bones, 0.6)),
                 .paint = plain(kWhite),
                 .segments = {2},
                 .material = kSkin});
        add(Tube{.outline = {thicker(flesh, 0.36, 1.12), thicker(flesh, 0.42, 1.15), thicker(flesh, 0.47, 1.2)},
                 .bones = part_of(bones, 0.36, 0.47),
                 .up = arm.up,
                 .paint = plain(kWhite),
                 .sides = {6},
                 .segments = {2},
                 .material = kLeather});
    }

    // One cloth over all its chains.
    void add_cloak() {
        struct Fold {
            Outline outline;
            Bones bones;
        };
        std::vector<Fold> folds;
        for (const Chain& chain : body_.chains_of("cloak")) folds.push_back({chain.outline, bones_of(chain)});
        add(Sheet{.at =
                      [folds](double u, double v) {
                          const double place = v * double(folds.size() - 1);
                          const size_t i = std::min(size_t(place), folds.size() - 2);
                          const double w = place - double(i);
                          return SkinPoint{
                              lerp(folds[i].outline.at(u).center, folds[i + 1].outline.at(u).center, w),
                              joined(influences_at(folds[i].bones, u, 1 - w), influences_at(folds[i + 1].bones, u, w))};
                      },
                  .paint =
                      [](double u, double v) {
                          const double border = std::max(smooth_step(0.94, 0.97, u),
                                                         smooth_step(0.44, 0.47, std::abs(v - 0.5)));
                          return lerp(kWhite * mix(0.6, 0.45, u), kWhite, border);
                      },
                  .mirrored = true,
                  .along = {13, 3},
                  .across = {14, 4},
                  .material = kCloak});
        // The collar that holds it.
        const Station neck = spine_.at(7.55 / 13);
        const auto collar = [&](double y, double size) {
            return Station{neck.center + Vec{0, y, -0.01}, 0.115 * size, 0.085 * size};
        };
        add(Tube{.outline = {collar(-0.045, 1.25), collar(-0.01, 1.08), collar(0.03, 0.86), collar(0.05, 0.7)},
                 .bones = stiff(influences_at(spine_bones_, 7 / 13.0)),
                 .up = kBehind,
                 .paint = fading(kWhite * 0.6, kWhite),
                 .sides = {10},
                 .segments = {3},
                 .material = kCloak});
    }

    // The bones of what grows on the head.
    Bones head() const { return stiff(influences_at(spine_bones_, kHeadAt + 0.1)); }

    void add_hair() {
        // From the crown down to the brow in front and to the nape behind.
        const auto at = [base = head().base](double u, double v) {
            // V = 0 and 1 meet in front, where the seam is under the parting
            const double front = 0.5 + 0.5 * sine(v + 0.25);
            const double fall = mix(0.03, mix(0.36, 0.215, front * front), u),
                         size = mix(1.0, 1.1, std::min(1.0, 3 * u));
            const Vec direction{sine(fall) * sine(v), cosine(fall), sine(fall) * cosine(v)};
            return SkinPoint{
                Vec{0, 1.862, 0.004} + Vec{0.112 * direction.x, 0.162 * direction.y, 0.133 * direction.z} * size, base};
        };
        add(Sheet{
            .at = at, .paint = fading(kWhite, kWhite * 0.75), .along = {6, 3}, .across = {14, 6}, .material = kHair});
        for (const Chain& chain : body_.chains_of("hair")) {
            const bool braid = chain.number == 0;
            add_limb(chain, {.paint = fading(kWhite * 0.85, kWhite),
                             .sides = {braid ? 6.0 : 4.0},
                             .segments = {braid ? 14.0 : 6.0},
                             .material = kHair});
        }
    }

    // The tunic's skirt follows the hips above and the thighs below.
    void add_skirt() {
        std::vector<Bones> thighs;
        for (const Chain& leg : body_.chains_of("leg")) thighs.push_back(bones_of(leg));
        const auto at = [thighs, spine = spine_, bones = spine_bones_](double u, double v) {
            const double side = sine(v), y = mix(1.09, 0.70, u);
            const Station hips = spine.at(kWaistAt);
            const Vec position{side * mix(hips.width * 1.08, 0.215, smooth_step(0, 0.9, u)), y,
                               hips.center.z - cosine(v) * mix(hips.height * 1.08, 0.17, smooth_step(0, 0.9, u))};
            const double follow = 0.92 * smooth_step(0.0, 0.9, u), left = smooth_step(-0.7, 0.7, side);
            Influences all = influences_at(bones, mix(kWaistAt, kHipsAt - 0.02, u), 1 - follow);
            all = joined(std::move(all), influences_at(thighs[0], 0.12, follow * left));
            return SkinPoint{position, joined(std::move(all), influences_at(thighs[1], 0.12, follow * (1 - left)))};
        };
        add(Sheet{.at = at,
                  .paint = fading(kWhite * 0.8, kWhite * 0.95),
                  .mirrored = true,
                  .along = {5, 2},
                  .across = {14, 6},
                  .material = kTunic});
        const auto belt = [&](double above) { return thicker(spine_, kWaistAt + above, 1.13); };
        add(Tube{.outline = {belt(-0.012), belt(0.004), belt(0.02), belt(0.036)},
                 .bones = stiff(influences_at(spine_bones_, kWaistAt)),
                 .up = kBehind,
                 .paint = plain(kWhite * 0.7),
                 .sides = {10},
                 .segments = {2},
                 .material = kLeather});
    }

    void add_face() {
        for (const double side : kSides) {
            const Vec ball{side * 0.037, 1.832, 0.112};
            add(Tube{
                .outline = {{ball, 0.018, 0.020}, {ball + Vec{0, 0, 0.012}, 0.015, 0.017}, {ball + Vec{0, 0, 0.017}}},
                .bones = head(),
                .paint = changing({0.8, 0.8, 0.8}, {{0.2, 0.5, {0.015, 0.015, 0.02}}}),
                .sides = {6},
                .segments = {3, 3},
                .material = kEyes});
        }
        const Vec nose{0, 1.80, 0.115};
        add(Tube{.outline = {{nose + Vec{0, 0.035, 0.0}, 0.010, 0.012},
                             {nose + Vec{0, 0, 0.018}, 0.017, 0.018},
                             {nose + Vec{0, -0.016, 0.006}}},
                 .bones = head(),
                 .up = {0, 0, 1},
                 .paint = plain(kWhite * 0.95),
                 .sides = {4},
                 .segments = {2},
                 .material = kSkin});
        for (const double side : kSides) {
            const Vec brow{side * 0.016, 1.864, 0.128};
            add(Tube{.outline = {{brow, 0.004, 0.007},
                                 {brow + Vec{side * 0.022, 0.008, -0.003}, 0.004, 0.007},
                                 {brow + Vec{side * 0.044, 0.0, -0.016}}},
                     .bones = head(),
                     .paint = plain(kWhite * 0.6),
                     .segments = {2},
                     .material = kHair});
        }
    }

    Outline spine_;
    Bones spine_bones_;
};

// How it moves: hips, knees and feet by the phase of the step, the hips as high as the longer leg allows; cloak and
// hair lag behind.
enum Clip { kIdle, kWalk, kRun, kWave };

constexpr double kThigh = 0.41, kShin = 0.41;  // m

bool moves(uint32_t clip) { return clip == kWalk || clip == kRun; }
double step_of(double loop, double side) { return loop + (side > 0 ? 0.5 : 0); }

// Bends of one leg; backward is positive. The step begins with the foot far in front; it is on the ground for the first
// half.
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

// The joint's share of the bend between two of a limb's four bones.
double hinge(const Moment& m, uint32_t number) { return m.share_between(0.25 * number, 0.25 * number + 0.1); }

Bend bend_of_leg(const Moment& m) {
    const LegPose leg = leg_pose(m.clip, step_of(m.loop, m.chain.side));
    const double stir = 0.01 * m.share() * sine(m.loop);
    if (m.chain.joint_count < 4) return {m.k == 0 ? leg.hip + 0.4 * leg.knee : stir};  // a stilt
    const double toes = moves(m.clip) ? -0.5 * std::max(0.0, leg.foot + leg.hip + leg.knee) : stir;
    return {leg.hip * hinge(m, 0) + leg.knee * hinge(m, 1) + leg.foot * hinge(m, 2) + toes * hinge(m, 3)};
}

Bend bend_of_arm(const Moment& m) {
    const double side = m.chain.side, swing = cosine(step_of(m.loop, side));  // opposite to the leg of its side
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

// Negative pitch lets the cloth fly back: more at higher speed, and most at the shoulders.
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
    Body body = WalkerJoints(settings).deal();
    std::vector<Piece> flesh = WalkerPieces(body).dress();
    return {std::move(body),
            std::move(flesh),
            {{{"idle", 72}, {"walk", 36}, {"run", 24}, {"wave", 72}},
             {{"spine", bend_of_spine},
              {"leg", bend_of_leg},
              {"arm", bend_of_arm},
              {"cloak", bend_of_cloak},
              {"hair", bend_of_hair}},
             root_motion},
            materials_of(settings.seed)};
}

}  // namespace throng::creature
