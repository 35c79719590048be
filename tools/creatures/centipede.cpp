// The centipede: a trunk of segments behind its head, a pair of legs on each, antennae, and a last pair that trails.
#include "tools/creatures/model.h"

namespace throng::creature {
namespace {

constexpr double kLength = 4.6;                     // from the front of the head to the end of the trunk, m
constexpr double kNeckAt = 0.055, kTailAt = 0.985;  // the first and the last pair of legs

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
    return stations;
}

Outline leg_outline(const Outline& trunk, double t, double side) {
    const Station flesh = trunk.at(t);
    const double reach = mix(0.85, 1.15, smooth_step(0, 0.8, t)) * 0.40, sweep = mix(0.16, -0.30, t);
    const Vec hip = flesh.center + Vec{side * flesh.width * 0.75, -0.2 * flesh.height, 0};
    const auto at = [&](double out, double y, double girth) {
        return Station{{hip.x + side * reach * out, y, hip.z + sweep * out * reach * 2}, girth};
    };
    return {{hip, 0.026}, at(0.30, 0.26, 0.023), at(0.60, 0.25, 0.018), at(0.88, 0.10, 0.011), at(1, 0, 0)};
}

// The last pair of legs, behind the body, and the antennae in front of it.
Outline trail_outline(const Outline& trunk, double side) {
    const double z = trunk.at(kTailAt).center.z;
    return {{{side * 0.03, 0.16, z}, 0.03},
            {{side * 0.10, 0.22, z - 0.16}, 0.028},
            {{side * 0.19, 0.17, z - 0.36}, 0.02},
            {{side * 0.28, 0.09, z - 0.56}, 0.012},
            {{side * 0.36, 0.05, z - 0.74}}};
}
Outline antenna_outline(double side) {
    constexpr double kZ = 0.48 * kLength;
    return {{{side * 0.05, 0.20, kZ - 0.02}, 0.020},
            {{side * 0.15, 0.31, kZ + 0.16}, 0.017},
            {{side * 0.30, 0.36, kZ + 0.36}, 0.014},
            {{side * 0.46, 0.31, kZ + 0.54}, 0.010},
            {{side * 0.58, 0.22, kZ + 0.72}}};
}

class CentipedeJoints : Builder {
public:
    explicit CentipedeJoints(const CreatureSettings& settings) : Builder(settings) {}

    Body deal() {
        const Outline trunk = trunk_outline();
        add_root(trunk, 0, 1, {0, 1, 0});
        // The longest path ends in the last leg on the left.
        const uint32_t depth = level_count_ - 1, last = std::min(7u, depth / 4);
        Chain spine{.part = "trunk", .joint_count = depth - last, .outline = trunk};
        spine.begin = spine.step = 1.0 / (spine.joint_count + 1);
        add(std::move(spine));
        for (const double side : kSides)
            add_on_trunk({.part = "tail",
                          .joint_count = last,
                          .outline = trail_outline(trunk, side),
                          .side = side,
                          .at_body = 1});
        const uint32_t feeler = std::min(12u, left_ / 8);
        for (const double side : kSides)
            add_limb({.part = "antenna", .joint_count = feeler, .outline = antenna_outline(side), .side = side});
        const uint32_t wish = std::max(3u, left_ / 66);  // about 33 pairs
        const std::vector<uint32_t> lengths = share_out(left_ / 2, wish, 1, [&](uint32_t i, uint32_t count) {
            return room_below(with_room(body_.chains[0].joint_at(site_of(i, count))));
        });
        const uint32_t count = uint32_t(lengths.size());
        for (uint32_t i = 0; i < count; ++i)
            for (const double side : kSides) {
                const double t = site_of(i, count);
                add_on_trunk({.part = "leg",
                              .joint_count = lengths[i],
                              .outline = leg_outline(trunk, t, side),
                              .side = side,
                              .number = i,
                              .at_body = t});
            }
        // A joint left over becomes its mouth.
        const Vec mouth = trunk.at(0).center;
        if (left_ > 0) add_limb({.part = "jaw", .joint_count = 1, .outline = {{mouth}, {mouth + Vec{0, -0.02, 0.1}}}});
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

class CentipedePieces : BodyPieces {
public:
    CentipedePieces(const Body& body, const CreatureSettings& settings)
        : BodyPieces(body),
          outline_(body.chains[0].outline),
          trunk_(bones_of(body.chains[0])),
          colors_(settings.seed) {}

    std::vector<Piece> sculpt() {
        const Colors& c = colors_;
        add(Tube{.outline = outline_,
                 .bones = trunk_,
                 .paint = [c](double, double dorsal) { return lerp(c.belly, c.back, smooth_step(-0.6, 0.3, dorsal)); },
                 .open_start = false,
                 .sides = {7, 4},
                 .segments = {42, 4}});
        const auto at = [&](double z, double width, double height) {
            return Station{outline_.at(0).center + Vec{0, 0.01, z}, width, height};
        };
        add(Tube{.outline = {at(0.09, 0, 0), at(0.06, 0.085, 0.05), at(-0.01, 0.125, 0.075), at(-0.11, 0.125, 0.08),
                             at(-0.19, 0.07, 0.05), at(-0.22, 0, 0)},
                 .paint = fading(c.head * 1.2, c.head),
                 .open_start = false,
                 .sides = {8},
                 .segments = {7}});
        // If the face budget cannot show all legs, the ones left out are spread evenly.
        add_limbs("antenna", {.paint = fading(c.head, c.leg), .segments = {6}});
        add_limbs("tail", {.paint = fading(c.leg, c.foot), .sides = {4}, .segments = {5}});
        add_limbs("leg", {.paint = fading(c.leg, c.foot), .sides = {4}, .segments = {4}});
        add_plates();
        add_face();
        return std::move(pieces_);
    }

private:
    // A plate of armour on the back of every segment, over the front of the next.
    void add_plates() {
        uint32_t pairs = 0;
        for (const Chain& leg : body_.chains_of("leg")) pairs = leg.number + 1;
        const uint32_t plates = std::clamp(pairs, 20u, 50u);
        for (uint32_t i = 0; i < plates; ++i) {
            const double from = mix(kNeckAt - 0.02, 0.985, double(i) / plates), length = 1.18 / plates;
            const auto at = [outline = outline_, bones = trunk_, from, length](double u, double v) {
                const double t = std::min(0.995, from + length * u), turns = 0.25 + 0.62 * (v - 0.5);
                const Station flesh = outline.at(t);
                const double swell = 1.03 + 0.16 * u;  // each lies over the next
                return SkinPoint{flesh.center + Vec{flesh.width * 1.06 * swell * cosine(turns),
                                                    flesh.height * swell * sine(turns), 0},
                                 influences_at(bones, t)};
            };
            const auto paint = [c = colors_](double u, double v) {
                return lerp(c.back * 0.8, c.edge, std::max(0.55 * u, smooth_step(0.33, 0.5, std::abs(v - 0.5))));
            };
            add(Sheet{.at = at, .paint = paint, .across = {5, 3}});
        }
    }

    // Jaws and eyes.
    void add_face() {
        for (const double side : kSides) {
            const auto at = [&](double x, double y, double z) { return outline_.at(0).center + Vec{side * x, y, z}; };
            add(Tube{.outline = {{at(0.10, -0.02, -0.10), 0.035, 0.03},
                                 {at(0.15, -0.05, 0.04), 0.03, 0.025},
                                 {at(0.10, -0.07, 0.13), 0.016},
                                 {at(0.02, -0.08, 0.15)}},
                     .paint = fading(colors_.head, colors_.foot * 0.3),
                     .sides = {4},
                     .segments = {4}});
            const Vec ball = at(0.075, 0.055, 0.02), out = normalized(Vec{side, 0.5, 0.5});
            add(Tube{.outline = {{ball, 0.02}, {ball + out * 0.014, 0.016}, {ball + out * 0.02}},
                     .paint = plain({0.01, 0.01, 0.012}),
                     .sides = {5},
                     .segments = {2, 2}});
        }
    }

    Outline outline_;
    Bones trunk_;
    Colors colors_;
};

enum Clip { kIdle, kWalk, kCurl };

constexpr double kBodyWaves = 2, kLegWaves = 4;                           // along the body at a time
double bend_of_wave(uint32_t clip) { return clip == kWalk ? 4.2 : 1.5; }  // radians over its length, at most
double coil(double loop) { return 0.5 - 0.5 * cosine(loop); }
double relaxed(uint32_t clip, double loop) { return clip == kCurl ? 1 - coil(loop) : 1; }

// The steps of the legs run along the body: each leg follows the one in front of it.
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

Bend bend_of_trunk(const Moment& m) {
    const double wave = relaxed(m.clip, m.loop) * bend_of_wave(m.clip) *
                        sine((m.clip == kCurl ? 0 : m.loop) - kBodyWaves * m.along());
    const double gentle = 1.0 / (m.chain.joint_count + 4);  // so that a body of few joints does not kink
    return {0, gentle * (wave + (m.clip == kCurl ? coil(m.loop) * (3.2 + 7.5 * m.along()) : 0))};
}

Bend bend_of_antenna(const Moment& m) {
    const double turns = (m.clip == kWalk ? 1 : 2) * m.loop + (m.chain.side > 0 ? 0.3 : 0) - 0.4 * m.along();
    return {m.share() * 0.35 * sine(turns), m.share() * 0.5 * sine(turns + 0.2)};
}

Bend bend_of_tail(const Moment& m) {
    return {m.share() * 0.06 * sine(m.loop - 0.3 * m.along()), m.share() * 0.25 * sine(m.loop - 0.2 * m.along())};
}

Bend bend_of_jaw(const Moment& m) { return {m.share() * 0.1 * sine(m.loop)}; }

// The head leads the wave of the body: it turns and swerves so that the middle line stays where it is.
RootMotion root_motion(uint32_t clip, double loop) {
    const double turns = clip == kCurl ? 0 : loop,
                 size = relaxed(clip, loop) * bend_of_wave(clip) / (2 * std::numbers::pi * kBodyWaves);
    const double across = size * kLength / (2 * std::numbers::pi * kBodyWaves), coiled = clip == kCurl ? coil(loop) : 0;
    return {{-across * sine(turns), 0, -1.5 * coiled}, {0, size * cosine(turns), 0}};
}

}  // namespace

Model make_centipede(const CreatureSettings& settings) {
    Body body = CentipedeJoints(settings).deal();
    std::vector<Piece> pieces = CentipedePieces(body, settings).sculpt();
    return {std::move(body),
            std::move(pieces),
            {{{"idle", 72}, {"walk", 36}, {"curl", 144}},
             {{"trunk", bend_of_trunk},
              {"leg", bend_of_leg},
              {"antenna", bend_of_antenna},
              {"tail", bend_of_tail},
              {"jaw", bend_of_jaw}},
             root_motion}};
}

}  // namespace throng::creature
