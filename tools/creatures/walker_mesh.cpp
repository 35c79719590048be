// The walker's flesh and clothes.
#include "tools/creatures/walker.h"

namespace throng::creature {
namespace {

constexpr double kNeckFrom = 7.6 / 13, kWaistAt = 2.9 / 13;  // on the spine

struct Colors {
    Vec skin, hair, tunic, trousers, boots, leather, cloak, lining;

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
        boots = color_of(0.07, 0.55, random.between(0.2, 0.32));
        leather = color_of(0.08, 0.6, 0.38);
        cloak = color_of(hue, random.between(0.65, 0.85), random.between(0.45, 0.7));
        lining = color_of(hue + 0.04, 0.5, 0.85);
    }
};

class Tailor : Flesh {
public:
    Tailor(const Body& body, const CreatureSettings& settings)
        : Flesh(body), colors_(settings.seed), spine_(body.chains[0].outline), spine_bones_(bones_of(body.chains[0])) {}

    std::vector<Piece> dress() {
        add(Tube{.outline = spine_,
                 .to = 8.2 / 13,
                 .bones = spine_bones_,
                 .up = kBehind,
                 .paint = fading(colors_.tunic * 0.8, colors_.tunic),
                 .open_start = false,
                 .sides = {10, 4},
                 .segments = {12, 4}});
        add(Tube{.outline = spine_,
                 .from = kNeckFrom,
                 .bones = spine_bones_,
                 .up = kBehind,
                 .paint = plain(colors_.skin),
                 .sides = {10},
                 .segments = {10, 4}});
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
    // The bones between two places of a limb, for a piece that covers just that.
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
                 .paint = fading(colors_.trousers, colors_.trousers * 0.8),
                 .sides = {7},
                 .segments = {8, 2}});
        // A boot: shaft and foot.
        add(Tube{.outline = {thicker(flesh, 0.34, 1.16), thicker(flesh, 0.40, 1.15), thicker(flesh, 0.47, 1.15),
                             thicker(flesh, 0.52, 1.1)},
                 .bones = part_of(bones, 0.34, 0.52),
                 .up = leg.up,
                 .paint = fading(colors_.boots * 1.3, colors_.boots),
                 .sides = {7},
                 .segments = {3}});
        const double x = flesh.at(0.5).center.x, out = 0.02 * leg.side;
        add(Tube{.outline = {{{x, 0.07, -0.085}},
                             {{x, 0.062, -0.07}, 0.040, 0.055},
                             {{x, 0.066, 0.0}, 0.048, 0.064},
                             {{x + 0.5 * out, 0.044, 0.09}, 0.056, 0.044},
                             {{x + out, 0.034, 0.17}, 0.050, 0.033},
                             {{x + out, 0.028, 0.215}}},
                 .bones = part_of(bones, 0.42, 0.96),
                 .paint = plain(colors_.boots),
                 .open_start = false,
                 .sides = {7},
                 .segments = {6, 3}});
    }

    void add_arm(const Chain& arm) {
        const Bones bones = bony(arm);
        const Outline& flesh = arm.outline;
        add(Tube{.outline = flesh,
                 .to = 0.5,
                 .bones = bones,
                 .up = arm.up,
                 .paint = fading(colors_.tunic, colors_.tunic * 0.85),
                 .open_start = false,
                 .sides = {7},
                 .segments = {8, 3}});
        add(Tube{.outline = flesh,
                 .from = 0.42,
                 .bones = bones,
                 .up = arm.up,
                 .paint = plain(colors_.skin),
                 .sides = {6},
                 .segments = {5}});
        const Vec palm = flesh.at(0.62).center;
        add(Tube{.outline = {{palm, 0.014},
                             {palm + Vec{-0.012 * arm.side, -0.035, 0.045}, 0.013},
                             {palm + Vec{-0.008 * arm.side, -0.075, 0.055}}},
                 .bones = stiff(influences_at(bones, 0.6)),
                 .paint = plain(colors_.skin),
                 .segments = {2}});
        add(Tube{.outline = {thicker(flesh, 0.36, 1.12), thicker(flesh, 0.42, 1.15), thicker(flesh, 0.47, 1.2)},
                 .bones = part_of(bones, 0.36, 0.47),
                 .up = arm.up,
                 .paint = plain(colors_.leather),
                 .sides = {6},
                 .segments = {2}});
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
                      [c = colors_](double u, double v) {
                          const double border = std::max(smooth_step(0.94, 0.97, u),
                                                         smooth_step(0.44, 0.47, std::abs(v - 0.5)));
                          return lerp(c.cloak * mix(1.1, 0.8, u), c.lining, border);
                      },
                  .mirrored = true,
                  .along = {13, 3},
                  .across = {14, 4}});
        // The collar that holds it.
        const Station neck = spine_.at(7.55 / 13);
        const auto collar = [&](double y, double size) {
            return Station{neck.center + Vec{0, y, -0.01}, 0.115 * size, 0.085 * size};
        };
        add(Tube{.outline = {collar(-0.045, 1.25), collar(-0.01, 1.08), collar(0.03, 0.86), collar(0.05, 0.7)},
                 .bones = stiff(influences_at(spine_bones_, 7 / 13.0)),
                 .up = kBehind,
                 .paint = fading(colors_.cloak, colors_.lining),
                 .sides = {10},
                 .segments = {3}});
    }

    // Of what grows on the head.
    Bones head() const { return stiff(influences_at(spine_bones_, kHeadAt + 0.1)); }

    void add_hair() {
        // From the crown down to the brow in front and to the nape behind.
        const auto at = [base = head().base](double u, double v) {
            // V = 0 and 1 in front, where the seam is under the parting
            const double front = 0.5 + 0.5 * sine(v + 0.25);
            const double fall = mix(0.03, mix(0.36, 0.215, front * front), u),
                         size = mix(1.0, 1.1, std::min(1.0, 3 * u));
            const Vec direction{sine(fall) * sine(v), cosine(fall), sine(fall) * cosine(v)};
            return SkinPoint{
                Vec{0, 1.862, 0.004} + Vec{0.112 * direction.x, 0.162 * direction.y, 0.133 * direction.z} * size, base};
        };
        add(Sheet{
            .at = at, .paint = fading(colors_.hair * 1.1, colors_.hair * 0.85), .along = {6, 3}, .across = {14, 6}});
        for (const Chain& chain : body_.chains_of("hair")) {
            const bool braid = chain.number == 0;
            add_limb(chain, {.paint = fading(colors_.hair, colors_.hair * 1.25),
                             .sides = {braid ? 6.0 : 4.0},
                             .segments = {braid ? 14.0 : 6.0}});
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
                  .paint = fading(colors_.tunic * 0.8, colors_.tunic * 0.95),
                  .mirrored = true,
                  .along = {5, 2},
                  .across = {14, 6}});
        const auto belt = [&](double above) { return thicker(spine_, kWaistAt + above, 1.13); };
        add(Tube{.outline = {belt(-0.012), belt(0.004), belt(0.02), belt(0.036)},
                 .bones = stiff(influences_at(spine_bones_, kWaistAt)),
                 .up = kBehind,
                 .paint = plain(colors_.leather * 0.7),
                 .sides = {10},
                 .segments = {2}});
    }

    void add_face() {
        for (const double side : kSides) {
            const Vec ball{side * 0.037, 1.832, 0.112};
            add(Tube{
                .outline = {{ball, 0.018, 0.020}, {ball + Vec{0, 0, 0.012}, 0.015, 0.017}, {ball + Vec{0, 0, 0.017}}},
                .bones = head(),
                .paint = changing({0.8, 0.8, 0.8}, {{0.2, 0.5, {0.015, 0.015, 0.02}}}),
                .sides = {6},
                .segments = {3, 3}});
        }
        const Vec nose{0, 1.80, 0.115};
        add(Tube{.outline = {{nose + Vec{0, 0.035, 0.0}, 0.010, 0.012},
                             {nose + Vec{0, 0, 0.018}, 0.017, 0.018},
                             {nose + Vec{0, -0.016, 0.006}}},
                 .bones = head(),
                 .up = {0, 0, 1},
                 .paint = plain(colors_.skin * 0.95),
                 .sides = {4},
                 .segments = {2}});
        for (const double side : kSides) {
            const Vec brow{side * 0.016, 1.864, 0.128};
            add(Tube{.outline = {{brow, 0.004, 0.007},
                                 {brow + Vec{side * 0.022, 0.008, -0.003}, 0.004, 0.007},
                                 {brow + Vec{side * 0.044, 0.0, -0.016}}},
                     .bones = head(),
                     .paint = plain(colors_.hair * 0.7),
                     .segments = {2}});
        }
    }

    Colors colors_;
    Outline spine_;
    Bones spine_bones_;
};

}  // namespace

std::vector<Piece> make_walker_flesh(const Body& body, const CreatureSettings& settings) {
    return Tailor(body, settings).dress();
}

}  // namespace throng::creature
