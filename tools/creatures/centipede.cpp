// The centipede: a trunk of segments behind its head, a pair of legs on each, antennae, and a last pair that trails.
#include "tools/creatures/model.h"

namespace throng::creature {
namespace {

constexpr double kLength = 4.6;                     // from the front of the head to the end of the trunk, m
constexpr double kNeckAt = 0.055, kTailAt = 0.985;  // the first and the last pair of legs
constexpr double kSides[] = {1, -1};

// Its width wherever it is not the head.
double girth_at(double t) { return mix(0.62, 1, smooth_step(0.05, 0.25, t)) * mix(1, 0.6, smooth_step(0.7, 1, t)); }

Outline trunk_outline() {
    std::vector<Station> stations;
    constexpr uint32_t kStations = 41;
    for (uint32_t i = 0; i < kStations; ++i) {
        const double t = double(i) / (kStations - 1), girth = girth_at(t) * smooth_step(1.02, 0.97, t);
        const bool front = i < 2;  // inside the head
        stations.push_back(
            {{0, 0.17, kLength * (0.48 - t)}, front ? 0.05 : 0.165 * girth, front ? 0.035 : 0.085 * girth});
    }
    return Outline(std::move(stations));
}

Outline leg_outline(const Outline& trunk, double t, double side) {
    const Station flesh = trunk.at(t);
    const double reach = mix(0.85, 1.15, smooth_step(0, 0.8, t)) * 0.40, sweep = mix(0.16, -0.30, t);
    const Vec hip = flesh.center + Vec{side * flesh.width * 0.75, -0.2 * flesh.height, 0};
    const auto at = [&](double out, double y, double girth) {
        return Station{{hip.x + side * reach * out, y, hip.z + sweep * out * reach * 2}, girth, girth};
    };
    return Outline(
        {{hip, 0.026, 0.026}, at(0.30, 0.26, 0.023), at(0.60, 0.25, 0.018), at(0.88, 0.10, 0.011), at(1, 0, 0)});
}

// The last pair, behind it, and the antennae before it.
Outline trail_outline(const Outline& trunk, double side) {
    const Vec hip = trunk.at(kTailAt).center;
    const auto at = [&](double x, double y, double z, double girth) {
        return Station{{side * x, y, hip.z - z}, girth, girth};
    };
    return Outline({at(0.03, 0.16, 0, 0.03), at(0.10, 0.22, 0.16, 0.028), at(0.19, 0.17, 0.36, 0.02),
                    at(0.28, 0.09, 0.56, 0.012), at(0.36, 0.05, 0.74, 0)});
}
Outline antenna_outline(double side) {
    const auto at = [&](double x, double y, double z, double girth) {
        return Station{{side * x, y, 0.48 * kLength + z}, girth, girth};
    };
    return Outline({at(0.05, 0.20, -0.02, 0.020), at(0.15, 0.31, 0.16, 0.017), at(0.30, 0.36, 0.36, 0.014),
                    at(0.46, 0.31, 0.54, 0.010), at(0.58, 0.22, 0.72, 0)});
}

class Dealer : Builder {
public:
    explicit Dealer(const CreatureSettings& settings) : Builder(settings) {}

    Body deal() {
        const Outline trunk = trunk_outline();
        add_root(trunk, 0, 1, {0, 1, 0});
        // The longest way ends in the last leg on the left.
        const uint32_t depth = level_count_ - 1, last = std::min(7u, depth / 4);
        Chain spine{.part = Part::kTrunk, .joint_count = depth - last, .outline = trunk};
        spine.begin = spine.step = 1.0 / (spine.joint_count + 1);
        add(std::move(spine));
        add_on_trunk(
            {.part = Part::kTail, .joint_count = last, .outline = trail_outline(trunk, 1), .side = 1, .at_body = 1});
        add_on_trunk(
            {.part = Part::kTail, .joint_count = last, .outline = trail_outline(trunk, -1), .side = -1, .at_body = 1});
        const uint32_t feeler = std::min(12u, left_ / 8);
        for (const double side : kSides)
            add_limb({.part = Part::kAntenna, .joint_count = feeler, .outline = antenna_outline(side), .side = side});
        const uint32_t wish = std::max(3u, left_ / 66);  // about 33 pairs
        const std::vector<uint32_t> lengths = share_out(left_ / 2, wish, 1, [&](uint32_t i, uint32_t count) {
            return room_below(with_room(body_.chains[0].joint_at(site_of(i, count))));
        });
        const uint32_t count = uint32_t(lengths.size());
        for (uint32_t i = 0; i < count; ++i)
            for (const double side : kSides) {
                const double t = site_of(i, count);
                add_on_trunk({.part = Part::kLeg,
                              .joint_count = lengths[i],
                              .outline = leg_outline(trunk, t, side),
                              .side = side,
                              .number = i,
                              .at_body = t});
            }
        // An odd one is its mouth.
        const Vec mouth = trunk.at(0).center;
        if (left_ > 0)
            add_limb(
                {.part = Part::kJaw, .joint_count = 1, .outline = Outline({{mouth}, {mouth + Vec{0, -0.02, 0.1}}})});
        return std::move(body_);
    }

private:
    static double site_of(uint32_t index, uint32_t count) {
        return mix(kNeckAt, kTailAt - 0.02, (index + 0.5) / count);
    }

    void add_on_trunk(Chain limb) {
        const Chain& trunk = body_.chains[0];
        limb.parent_joint = with_room(trunk.joint_at(limb.at_body));
        limb.base = influences_at(bones_of(trunk), std::min(limb.at_body, kTailAt));
        add_limb(std::move(limb));
    }
};

struct Colors {
    Vec back, edge, belly, leg, foot, head;

    explicit Colors(uint64_t seed) {
        Random random(~seed);
        const double hue = random.between(-0.03, 0.09) + (random.unit() < 0.2 ? 0.45 : 0);
        back = color_of(hue, 0.75, random.between(0.22, 0.38));
        edge = color_of(hue + 0.02, 0.8, 0.55);
        belly = color_of(hue + 0.05, 0.5, 0.6);
        leg = color_of(hue + random.between(0.04, 0.09), 0.85, 0.85);
        foot = color_of(hue, 0.8, 0.4);
        head = color_of(hue - 0.02, 0.82, random.between(0.5, 0.7));
    }
};

class Sculptor {
public:
    Sculptor(const Body& body, const CreatureSettings& settings)
        : body_(body), trunk_(bones_of(body.chains[0])), colors_(settings.seed) {}

    std::vector<Piece> sculpt() {
        pieces_.push_back(
            Tube{.outline = body_.chains[0].outline,
                 .bones = trunk_,
                 .paint = [c = colors_](
                              double, double dorsal) { return lerp(c.belly, c.back, smooth_step(-0.6, 0.3, dorsal)); },
                 .open_start = false,
                 .wanted_sides = 7,
                 .wanted_segments = 42,
                 .least_sides = 4,
                 .least_segments = 4});
        add_head();
        add_limbs(Part::kAntenna, fading(colors_.head, colors_.leg), 3, 6);
        add_limbs(Part::kTail, fading(colors_.leg, colors_.foot), 4, 5);
        add_limbs(Part::kLeg, fading(colors_.leg, colors_.foot), 4, 4);
        add_plates();
        add_lods();
        return std::move(pieces_);
    }

private:
    // Legs that the face budget cannot show are left out evenly.
    void add_limbs(Part part, const Paint& paint, double sides, double segments) {
        for (const Chain& chain : body_.chains)
            if (chain.part == part)
                pieces_.push_back(Tube{.outline = chain.outline,
                                       .bones = bones_of(chain),
                                       .paint = paint,
                                       .wanted_sides = sides,
                                       .wanted_segments = segments});
    }

    void add_head() {
        const Vec front = body_.chains[0].outline.at(0).center;
        const auto at = [&](double z, double width, double height) {
            return Station{front + Vec{0, 0.01, z}, width, height};
        };
        pieces_.push_back(Tube{.outline = Outline({at(0.09, 0, 0), at(0.06, 0.085, 0.05), at(-0.01, 0.125, 0.075),
                                                   at(-0.11, 0.125, 0.08), at(-0.19, 0.07, 0.05), at(-0.22, 0, 0)}),
                               .bones = stiff({{0, 1}}),
                               .paint = fading(colors_.head * 1.2, colors_.head),
                               .open_start = false,
                               .wanted_sides = 8,
                               .wanted_segments = 7});
    }

    // A plate of armour on the back of every segment, over the front of the next.
    void add_plates() {
        uint32_t pairs = 0;
        for (const Chain& chain : body_.chains)
            if (chain.part == Part::kLeg) pairs = chain.number + 1;
        const uint32_t plates = std::clamp(pairs, 20u, 50u);
        for (uint32_t i = 0; i < plates; ++i) {
            const double from = mix(kNeckAt - 0.02, 0.985, double(i) / plates), length = 1.18 / plates;
            const auto at = [outline = body_.chains[0].outline, bones = trunk_, from, length](double u, double v) {
                const double t = std::min(0.995, from + length * u), turns = 0.25 + 0.62 * (v - 0.5);
                const Station flesh = outline.at(t);
                const double swell = 1.03 + 0.16 * u;  // each lies over the next
                return SkinPoint{flesh.center + Vec{flesh.width * 1.06 * swell * cosine(turns),
                                                    flesh.height * swell * sine(turns), 0},
                                 influences_at(bones, t)};
            };
            pieces_.push_back(Sheet{.at = at,
                                    .paint =
                                        [c = colors_](double u, double v) {
                                            return lerp(c.back * 0.8, c.edge,
                                                        std::max(0.55 * u, smooth_step(0.33, 0.5, std::abs(v - 0.5))));
                                        },
                                    .wanted_along = 1,
                                    .wanted_across = 5,
                                    .least_across = 3});
        }
    }

    void add_lods() {
        const Vec front = body_.chains[0].outline.at(0).center;
        for (const double side : kSides) {
            const auto at = [&](double x, double y, double z) { return front + Vec{side * x, y, z}; };
            pieces_.push_back(Tube{.outline = Outline({{at(0.10, -0.02, -0.10), 0.035, 0.03},
                                                       {at(0.15, -0.05, 0.04), 0.03, 0.025},
                                                       {at(0.10, -0.07, 0.13), 0.016, 0.016},
                                                       {at(0.02, -0.08, 0.15), 0, 0}}),
                                   .bones = stiff({{0, 1}}),
                                   .paint = fading(colors_.head, colors_.foot * 0.3),
                                   .wanted_sides = 4,
                                   .wanted_segments = 4});
            const Vec ball = at(0.075, 0.055, 0.02), out = normalized(Vec{side, 0.5, 0.5});
            pieces_.push_back(Tube{
                .outline = Outline({{ball, 0.02, 0.02}, {ball + out * 0.014, 0.016, 0.016}, {ball + out * 0.02, 0, 0}}),
                .bones = stiff({{0, 1}}),
                .paint = plain({0.01, 0.01, 0.012}),
                .wanted_sides = 5,
                .wanted_segments = 2,
                .least_segments = 2});
        }
    }

    const Body& body_;
    Bones trunk_;
    Colors colors_;
    std::vector<Piece> pieces_;
};

enum Clip { kIdle, kWalk, kCurl };
constexpr ClipPlan kPlans[] = {{"idle", 72}, {"walk", 36}, {"curl", 144}};

constexpr double kBodyWaves = 2, kLegWaves = 4;                           // along the body at a time
double bend_of_wave(uint32_t clip) { return clip == kWalk ? 4.2 : 1.5; }  // radians a length, at most
double coil(double loop) { return 0.5 - 0.5 * cosine(loop); }
double relaxed(uint32_t clip, double loop) { return clip == kCurl ? 1 - coil(loop) : 1; }

// Up and down the steps of the legs: those behind follow those before.
Bend bend_of_leg(const Moment& m) {
    const double side = m.chain.side,
                 step = m.loop * (m.clip == kWalk ? 1 : 0) + kLegWaves * m.chain.at_body + (side > 0 ? 0.5 : 0);
    const double hip = m.share_between(0, 0.34), foot = m.share_between(0.4, 1);
    if (m.clip == kWalk) {
        const double lifted = std::max(0.0, cosine(step));
        return {-0.42 * hip * lifted + 0.25 * foot * lifted, hip * -0.42 * side * sine(step), 0};
    }
    const double tucked = m.clip == kCurl ? coil(m.loop) : 0, stir = sine(m.loop + m.chain.at_body);
    return {hip * (0.02 * stir - 0.05 * tucked) + foot * (0.25 * tucked - 0.01 * stir),
            side * hip * (0.05 * stir + 0.35 * tucked), 0};
}

Bend bend_of(const Moment& m) {
    const double share = m.share(), along = m.along(), side = m.chain.side;
    switch (m.chain.part) {
        case Part::kTrunk: {
            const double wave = relaxed(m.clip, m.loop) * bend_of_wave(m.clip) *
                                sine((m.clip == kCurl ? 0 : m.loop) - kBodyWaves * along);
            const double gentle = 1.0 / (m.chain.joint_count + 4);  // few joints may not break the body where they bend
            return {0, gentle * (wave + (m.clip == kCurl ? coil(m.loop) * (3.2 + 7.5 * along) : 0)), 0};
        }
        case Part::kLeg: return bend_of_leg(m);
        case Part::kAntenna: {
            const double turns = (m.clip == kWalk ? 1 : 2) * m.loop + (side > 0 ? 0.3 : 0) - 0.4 * along;
            return {share * 0.35 * sine(turns), share * 0.5 * sine(turns + 0.2), 0};
        }
        case Part::kTail:
            return {share * 0.06 * sine(m.loop - 0.3 * along), share * 0.25 * sine(m.loop - 0.2 * along), 0};
        default: return {share * 0.1 * sine(m.loop), 0, 0};
    }
}

// The head leads the wave of the body: it turns and swerves so that the middle line stays where it is.
RootMotion root_motion(uint32_t clip, double loop) {
    const double turns = clip == kCurl ? 0 : loop,
                 size = relaxed(clip, loop) * bend_of_wave(clip) / (2 * std::numbers::pi * kBodyWaves);
    const double across = size * kLength / (2 * std::numbers::pi * kBodyWaves), coiled = clip == kCurl ? coil(loop) : 0;
    return {{-across * sine(turns), 0, -1.5 * coiled}, {0, size * cosine(turns), 0}};
}

}  // namespace

Model make_centipede(const CreatureSettings& settings) {
    Body body = Dealer(settings).deal();
    std::vector<Piece> pieces = Sculptor(body, settings).sculpt();
    return {std::move(body), std::move(pieces), {kPlans, bend_of, root_motion}};
}

}  // namespace throng::creature
