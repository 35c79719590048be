// The dragon's flesh: one tube from the snout to the tip of the tail, a tube along every other chain, sheets between
// the fingers of the wings.
#include "tools/creatures/dragon.h"

namespace throng::creature {
namespace {

struct Colors {
    Vec back, stripe, flank, belly, accent, membrane, horn;

    explicit Colors(uint64_t seed) {
        Random random(~seed);
        const double hue = random.unit();
        const double tip = hue + random.between(0.38, 0.62);
        back = color_of(hue, 0.72, 0.42);
        stripe = color_of(hue - 0.04, 0.8, 0.25);
        flank = color_of(hue + 0.02, 0.68, 0.66);
        belly = color_of(hue + 0.11, 0.34, 0.93);
        accent = color_of(tip, 0.66, 0.90);
        membrane = color_of(tip + 0.05, 0.55, 0.72);
        horn = color_of(0.11, 0.22, 0.9);
    }

    Paint body() const {
        return [c = *this](double t, double dorsal) {
            const double stripes = smooth_step(0.1, 0.9, sine(t * 19)) * smooth_step(0.2, 0.8, dorsal) *
                                   smooth_step(0.24, 0.3, t);
            Vec color = lerp(c.belly, c.flank, smooth_step(-0.75, -0.1, dorsal));
            color = lerp(color, c.back, smooth_step(-0.1, 0.8, dorsal));
            color = lerp(color, c.stripe, 0.7 * stripes);
            return lerp(color, c.accent, 0.9 * smooth_step(0.8, 1.0, t));
        };
    }
    Paint jaw() const {
        return [c = *this](double, double dorsal) { return lerp(c.flank, c.belly, smooth_step(0.2, -0.6, dorsal)); };
    }
};

// A sheet of skin between two edges, from u = 0 (the arm or the wrist) to the free border at u = 1.
struct Membrane {
    const Chain& first;   // finger
    const Chain* second;  // next finger; none for the sheet between the last finger and the flank
    const Chain& arm;
    Flank flank;
    Bones axis_bones;

    static SkinPoint on_limb(const Chain& chain, double t, double weight) {
        return {chain.outline.at(t).center, influences_at(bones_of(chain), t, weight)};
    }

    // The point u of the way from the arm to the border, v of the way from the first finger to the next edge.
    SkinPoint at(double u, double v) const {
        // Not from the very wrist, where the fingers meet and the first triangles would vanish.
        if (second) u = std::max(0.01, u);
        // The border is drawn in between its fingers.
        const double reach = u * (1 - 0.85 * v * (1 - v) * u * (second ? 1 : 0.7));
        const SkinPoint a = on_limb(first, reach, 1 - v);
        if (second) {
            const SkinPoint b = on_limb(*second, reach, v);
            Vec position = lerp(a.position, b.position, v);
            position.y -= 0.14 * v * (1 - v) * u;  // hangs through
            return {position, joined(a.influences, b.influences)};
        }
        constexpr double kShoulderAt = 0.47, kHipAt = 0.65;  // on the axis
        // Coons patch: finger, flank, arm and a straight border. The arm holds the skin near it, the body at the flank.
        const Vec on_flank = lerp(flank.shoulder, flank.hip, reach);
        const Vec bulge = arm.outline.at(1 - v * 2 / 3).center - lerp(arm.outline.at(1).center, flank.shoulder, v);
        Vec position = lerp(a.position, on_flank, v) + bulge * (1 - reach);
        position.y -= 0.3 * v * (1 - v) * u;
        const double arm_share = (1 - reach) * 4 * v * (1 - v);
        const SkinPoint upper = on_limb(arm, 1 - v * 2 / 3, arm_share);
        const Influences body = influences_at(axis_bones, mix(kShoulderAt, kHipAt, reach), v * (1 - arm_share));
        return {position, joined(joined(scaled(a.influences, 1 - arm_share), upper.influences), body)};
    }
};

class Sculptor : Flesh {
public:
    Sculptor(const Dragon& dragon, const CreatureSettings& settings)
        : Flesh(dragon.body), dragon_(dragon), colors_(settings.seed), face_budget_(settings.face_count) {}

    std::vector<Piece> sculpt() {
        const Colors& c = colors_;
        add(Tube{.outline = dragon_.axis,
                 .bones = dragon_.axis_bones,
                 .paint = c.body(),
                 .open_start = false,
                 .sides = {11, 4},
                 .segments = {40, 4}});
        add_limbs("leg",
                  {.paint = changing(c.flank, {{0, 0.5, c.back}, {0.5, 1, c.stripe}}), .sides = {6}, .segments = {7}});
        // The membranes' edges meet the rings of arms and fingers.
        const Paint finger = changing(c.back, {{0, 0.7, c.stripe}});
        add_limbs("arm", {.paint = finger, .sides = {5}, .segments = {4, 1, 3}, .segments_fixed = true});
        add_limbs("finger", {.paint = finger, .segments = {4}, .segments_fixed = true});
        for (const Chain& arm : body_.chains_of("arm")) add_membranes(arm);
        add_limbs("jaw", {.paint = c.jaw(), .sides = {6}, .segments = {4}});
        add_face();
        add_crest();
        add_tendrils();
        add_limbs("toe", {.paint = changing(c.stripe, {{0.3, 0.8, c.horn}}), .segments = {2}});
        return std::move(pieces_);
    }

private:
    // Bones of what is stuck on the body's flesh at t of the axis.
    Bones stuck_at(double t) const { return stiff(influences_at(dragon_.axis_bones, t)); }
    Paint horn() const { return fading(colors_.horn * 0.55, colors_.horn); }

    void add_face() {
        constexpr double kBrowAt = 0.185, kCrownAt = 0.24;  // on the axis
        const Station brow = dragon_.axis.at(kBrowAt), crown = dragon_.axis.at(kCrownAt);
        for (const double side : kSides) {
            const Vec ball = brow.center + Vec{side * brow.width * 0.78, brow.height * 0.42, 0};
            const Vec out = normalized(Vec{side, 0.25, 0.35});
            add(Tube{.outline = {{ball, 0.042}, {ball + out * 0.022, 0.036}, {ball + out * 0.034}},
                     .bones = stuck_at(kBrowAt),
                     .paint = changing(color_of(0.13, 0.85, 1.0), {{0.4, 0.6, {0.01, 0.01, 0.015}}}),
                     .sides = {6, 5},
                     .segments = {3, 3}});
        }
        for (const double side : kSides) {
            const Vec base = crown.center + Vec{side * crown.width * 0.45, crown.height * 0.45, 0};
            const auto at = [&](double x, double y, double z) { return base + Vec{side * x, y, z}; };
            add(Tube{.outline = {{base, 0.05},
                                 {at(0.05, 0.13, -0.12), 0.035},
                                 {at(0.08, 0.19, -0.28), 0.02},
                                 {at(0.07, 0.30, -0.40)}},
                     .bones = stuck_at(kCrownAt),
                     .paint = horn(),
                     .sides = {5},
                     .segments = {4}});
        }
    }

    // Spikes from the neck to the tail, larger over the shoulders.
    void add_crest() {
        constexpr uint32_t kSpikes = 16;
        for (uint32_t i = 0; i < kSpikes; ++i) {
            const double t = mix(0.27, 0.92, double(i) / (kSpikes - 1));
            const Station flesh = dragon_.axis.at(t);
            const Vec along = dragon_.axis.direction(t), up = perpendicular({0, 1, 0}, along);
            const double reach = 0.035 + 0.3 * flesh.height;
            const Vec base = flesh.center + up * (flesh.height * 0.9);
            add(Tube{.outline = {{base, 0.016, 0.05}, {base + up * reach + along * (0.6 * reach)}},
                     .bones = stuck_at(t),
                     .up = along,
                     .paint = horn()});
        }
    }

    // At most a quarter of the faces; evenly chosen where the creature has more tendrils than that can show.
    void add_tendrils() {
        std::vector<const Chain*> tendrils;
        for (const Chain& c : body_.chains_of("tendril")) tendrils.push_back(&c);
        const size_t most = std::max<size_t>(2, face_budget_ / 4 / 9);
        const size_t shown = std::min(tendrils.size(), most);
        for (size_t i = 0; i < shown; ++i)
            add_limb(*tendrils[i * tendrils.size() / shown],
                     {.paint = changing(colors_.back, {{0, 0.7, colors_.accent}}), .segments = {4}});
    }

    void add_membranes(const Chain& arm) {
        const Chain* before = nullptr;
        for (const Chain& finger : body_.chains_of("finger")) {
            if (finger.side != arm.side) continue;
            if (before) add_membrane(arm, *before, &finger);
            before = &finger;
        }
        if (before) add_membrane(arm, *before, nullptr);
    }
    void add_membrane(const Chain& arm, const Chain& first, const Chain* second) {
        const bool left = arm.side > 0;
        const Membrane membrane{first, second, arm, left ? dragon_.left_flank : dragon_.right_flank,
                                dragon_.axis_bones};
        // At the flank, two for every three rings of the arm, which carries the sheet from its second third on.
        add(Sheet{.at = [=](double u, double v) { return membrane.at(u, v); },
                  .paint = changing(colors_.back, {{0, 0.35, colors_.membrane}, {0.7, 1, colors_.accent}}),
                  .mirrored = !left,  // up is outside on both wings
                  .along = {4},
                  .across = second ? Cuts{4} : Cuts{8.0 / 3, 1, 2}});
    }

    const Dragon& dragon_;
    Colors colors_;
    uint64_t face_budget_;
};

}  // namespace

std::vector<Piece> make_dragon_flesh(const Dragon& dragon, const CreatureSettings& settings) {
    return Sculptor(dragon, settings).sculpt();
}

}  // namespace throng::creature
