// The dragon: a long axis from the snout to the tip of the tail, four legs, two wings, tendrils.
#include "tools/creatures/model.h"

namespace throng::creature {
namespace {

// Where a wing's membrane meets the body.
struct Flank {
    Vec shoulder, hip;
};

// The axis goes from the snout at 0 to the tip of the tail at 1. The root joint stands on it, at the hips; the trunk
// goes from there forward to the head, the tail backward. A creature with no joints left for a trunk is a snake: its
// root is its head.
struct Dragon {
    Body body;  // the tail and the trunk (either may be missing) come first
    Outline axis;
    Bones axis_bones;
    Flank left_flank, right_flank;
};

constexpr double kRootAt = 10.0 / 16, kHeadAt = 4.0 / 16;  // stations of axis_outline()
constexpr double kChestAt = 8.0 / 16;

// What makes one creature differ from the next.
struct Build {
    double girth, neck, tail_curl, wing;
};

Outline axis_outline(const Build& b, bool has_legs) {
    struct Row {
        double z, y, width, height;
    };
    const Row rows[] = {{1.52, 1.80, 0.040, 0.030},  {1.40, 1.83, 0.085, 0.065},  {1.25, 1.89, 0.100, 0.085},
                        {1.09, 1.98, 0.150, 0.135},  {0.93, 1.99, 0.135, 0.140},  {0.80, 1.85, 0.095, 0.115},
                        {0.73, 1.60, 0.105, 0.135},  {0.60, 1.34, 0.150, 0.200},  {0.32, 1.11, 0.250, 0.300},
                        {-0.03, 1.02, 0.270, 0.285}, {-0.40, 1.02, 0.220, 0.245}, {-0.80, 0.96, 0.140, 0.160},
                        {-1.17, 0.80, 0.100, 0.110}, {-1.53, 0.60, 0.072, 0.080}, {-1.90, 0.48, 0.050, 0.055},
                        {-2.25, 0.53, 0.032, 0.035}, {-2.52, 0.74, 0, 0}};
    std::vector<Station> stations;
    for (const Row& row : rows) {
        const double neck = smooth_step(0.5, 0.9, row.z) * (b.neck - 1);
        const double curl = smooth_step(-1.7, -2.5, row.z) * b.tail_curl;
        stations.push_back(
            {{0, row.y + 0.9 * neck + curl, row.z + 0.4 * neck}, row.width * b.girth, row.height * b.girth});
    }
    // Without legs the body lies on the ground from the chest backward, the neck raised.
    for (Station& s : stations)
        if (!has_legs) s.center.y = s.center.z > 0.5 ? s.center.y - 0.75 : s.height;
    return stations;
}

Outline leg_outline(uint32_t number, double side, double girth) {
    static const std::vector<Station> kFront = {{{0.12, 1.08, 0.33}, 0.06, 0.10},
                                                {{0.26, 0.70, 0.25}, 0.095, 0.125},
                                                {{0.28, 0.33, 0.40}, 0.05, 0.06},
                                                {{0.28, 0.06, 0.42}, 0.05, 0.055},
                                                {{0.28, 0.03, 0.60}, 0.045, 0.022}};
    static const std::vector<Station> kHind = {{{0.10, 1.02, -0.36}, 0.08, 0.15},
                                               {{0.26, 0.66, -0.20}, 0.11, 0.165},
                                               {{0.28, 0.34, -0.50}, 0.048, 0.06},
                                               {{0.28, 0.06, -0.42}, 0.05, 0.055},
                                               {{0.28, 0.03, -0.22}, 0.045, 0.022}};
    std::vector<Station> stations = number == 0 ? kFront : kHind;
    for (Station& s : stations) s.center.x *= side, s.width *= girth, s.height *= girth;
    return stations;
}

Vec wing_point(Vec point, const Build& b, double side) {
    const Vec shoulder{0.2, 1.25, 0.33};
    point = shoulder + (point - shoulder) * b.wing;
    return {point.x * side, point.y, point.z};
}

// Distributes the joints: first the longest chain (root and tail), then trunk, legs, wings, jaw and toes as far as
// joints and levels allow. The rest become tendrils over the back.
class DragonJoints : Builder {
public:
    explicit DragonJoints(const CreatureSettings& settings) : Builder(settings), random_(settings.seed) {
        build_ = {random_.between(0.92, 1.12), random_.between(0.9, 1.12), random_.between(-0.15, 0.35),
                  random_.between(0.9, 1.08)};
    }

    Dragon deal() {
        const uint32_t tail = level_count_ - 1;
        const uint32_t rest = left_ - 1 - tail;
        const uint32_t trunk = std::min({2 + rest / 20, rest, 24u, std::max(1u, tail * 2 / 3), tail});
        axis_ = axis_outline(build_, rest - trunk >= 2);
        root_at_ = trunk > 0 ? kRootAt : 0;
        head_at_ = trunk > 0 ? kHeadAt : 0;
        add_root(axis_, root_at_, trunk > 0 ? -1 : 1, {0, 1, 0});
        deal_axis(tail, trunk);
        deal_legs();
        deal_wings();
        deal_jaw();
        deal_toes();
        deal_tendrils();
        return {std::move(body_), std::move(axis_), std::move(axis_bones_), left_flank_, right_flank_};
    }

private:
    void add_limb(Chain limb) {
        if (limb.joint_count > 0) Builder::add_limb(std::move(limb));
    }
    // The joint that moves the body's flesh at t of the axis.
    uint32_t axis_joint(double t) const {
        for (const Chain& chain : body_.chains_of(t > root_at_ ? "tail" : "trunk"))
            if (const double steps = (t - root_at_) / chain.step; steps >= 1)  // from the root
                return chain.first_joint + std::min(uint32_t(steps), chain.joint_count) - 1;
        return 0;
    }

    void deal_axis(uint32_t tail, uint32_t trunk) {
        add_on_axis("tail", tail, (1 - root_at_) / (tail + 1));
        add_on_axis("trunk", trunk, (head_at_ - root_at_) / std::max(trunk, 1u));
        if (trunk > 0) head_joint_ = body_.joint_count() - 1;
        for (const Chain& chain : body_.chains)
            for (uint32_t k = 0; k < chain.joint_count; ++k) {
                const bool forward = chain.step < 0;  // towards the head: inserted first, so that the bounds ascend
                axis_bones_.joints.insert(forward ? axis_bones_.joints.begin() : axis_bones_.joints.end(),
                                          chain.first_joint + k);
                axis_bones_.bounds.insert(forward ? axis_bones_.bounds.begin() + 1 : axis_bones_.bounds.end() - 1,
                                          chain.at(k));
            }
    }
    void add_on_axis(std::string_view part, uint32_t count, double step) {
        if (count > 0)
            add({.part = part,
                 .joint_count = count,
                 .outline = axis_,
                 .begin = root_at_ + step,
                 .step = step,
                 .phase_turns = random_.unit()});
    }

    void deal_legs() {
        const uint32_t wish = std::clamp(left_ / 12, 1u, 4u);
        for (const uint32_t number : {1u, 0u}) {
            const uint32_t parent = number == 0 ? axis_joint(kChestAt) : 0;
            const uint32_t count = std::min({wish, room_below(parent), left_ / 2});
            for (const double side : kSides)
                add_limb({.part = "leg",
                          .parent_joint = parent,
                          .joint_count = count,
                          .outline = leg_outline(number, side, build_.girth),
                          .up = {0, 0, 1},
                          .side = side,
                          .number = number,
                          .base = influences_at(axis_bones_, number == 0 ? kChestAt : kRootAt)});
        }
    }

    void deal_wings() {
        const uint32_t shoulder = axis_joint(kChestAt);
        const uint32_t room = room_below(shoulder);
        const uint32_t each = std::min({3 + left_ / 6, left_ / 2, 64u});
        if (root_at_ == 0 || each < 2 || room < 2) return;
        const uint32_t arm = std::min(each < 6 ? 1u : 3u, room - 1);
        const uint32_t fingers = each - arm < 4 ? std::min(each - arm, 2u) : std::clamp((each - arm) / 3, 2u, 5u);
        const double phase_turns = random_.unit();
        const Outline tips({{{2.05, 2.42, 0.62}}, {{2.18, 1.98, -0.30}}, {{1.75, 1.55, -0.98}}, {{1.12, 1.22, -1.22}}});
        for (const double side : kSides) {
            const auto at = [&](double x, double y, double z) { return wing_point({x, y, z}, build_, side); };
            const Vec wrist = at(1.12, 1.98, 0.50);
            add_limb({.part = "arm",
                      .parent_joint = shoulder,
                      .joint_count = arm,
                      .outline = {{at(0.06, 1.14, 0.30), 0.09, 0.11},
                                  {at(0.26, 1.30, 0.34), 0.075, 0.085},
                                  {at(0.72, 1.74, 0.16), 0.05, 0.055},
                                  {wrist, 0.04, 0.042}},
                      .side = side,
                      .phase_turns = phase_turns,
                      .base = influences_at(axis_bones_, kChestAt)});
            const uint32_t hand = body_.joint_count() - 1;
            uint32_t rest = each - arm;
            for (uint32_t finger = 0; finger < fingers; ++finger) {
                const uint32_t count = std::min(rest / (fingers - finger), room_below(hand));
                rest -= rest / (fingers - finger);
                const Vec tip = wing_point(tips.at(fingers > 1 ? double(finger) / (fingers - 1) : 0).center, build_,
                                           side);
                const Vec bow = lerp(wrist, tip, 0.5) + Vec{0, 0.10, 0.06};
                add_limb({.part = "finger",
                          .parent_joint = hand,
                          .joint_count = count,
                          .outline = {{wrist, 0.032}, {bow, 0.02}, {tip}},
                          .side = side,
                          .phase_turns = phase_turns,
                          .number = finger});
            }
            (side > 0 ? left_flank_ : right_flank_) = {at(0.12, 1.28, 0.30), {0.14 * side, 1.16, -0.62}};
        }
    }

    void deal_jaw() {
        if (left_ < 6 || root_at_ == 0 || room_below(head_joint_) == 0) return;
        const auto under = [&](double t, double down, double size) {
            const Station s = axis_.at(t);
            return Station{s.center - Vec{0, s.height * down, 0}, s.width * size, s.height * size * 0.5};
        };
        add_limb({.part = "jaw",
                  .parent_joint = head_joint_,
                  .joint_count = 1,
                  .outline = {under(0.22, 0.55, 0.7), under(0.16, 0.95, 0.75), under(0.10, 1.1, 0.8),
                              under(0.07, 1.15, 0.8), under(0.035, 1.2, 0)},
                  .phase_turns = random_.unit(),
                  .base = influences_at(axis_bones_, 0.22)});
    }

    void deal_toes() {
        const uint32_t count = left_ >= 120 ? 2 : left_ >= 60 ? 1 : 0;
        const std::vector<Chain> chains = body_.chains;
        for (const Chain& leg : chains) {
            if (leg.part != "leg") continue;
            const uint32_t foot = leg.first_joint + leg.joint_count - 1;
            for (uint32_t toe = 0; toe < 3; ++toe) {
                const double spread = 0.05 * (double(toe) - 1);
                const Vec base = leg.outline.at(0.92).center;
                add_limb({.part = "toe",
                          .parent_joint = foot,
                          .joint_count = std::min(count, room_below(foot)),
                          .outline = {{base + Vec{spread * 0.6, 0, 0}, 0.026, 0.024},
                                      {base + Vec{spread * 1.3, -0.01, 0.09}, 0.022, 0.02},
                                      {base + Vec{spread * 1.7, -0.03, 0.18}}},
                          .side = leg.side,
                          .number = toe});
            }
        }
    }

    // Where tendril pair `index` of `count` grows: in rows from the crest downwards, each from the head to the tail.
    struct Site {
        double t, angle_turns;
    };
    Site site(uint32_t index, uint32_t count) const {
        const uint32_t rows = std::max(1u, uint32_t(std::sqrt(count / 12.0)));
        const uint32_t in_row = (count + rows - 1) / rows;
        const double along = (index % in_row + 0.5) / in_row;
        const double row = double(index / in_row);
        return {mix(first_site_, last_site_, along), 0.05 + 0.35 * row / rows};
    }

    void deal_tendrils() {
        if (left_ == 0) return;
        // If the outermost joint of the axis has no level left below it, tendrils grow only on the joints before it.
        const Chain& tail = body_.chains[0];
        last_site_ = tail.at(tail.joint_count - 1);
        first_site_ = room_below(head_joint_) > 0 ? std::min(0.235, root_at_) : head_at_;
        const uint32_t wish = 2 + uint32_t(0.5 * std::sqrt(double(left_)));
        const std::vector<uint32_t> lengths = share_out(left_ / 2, wish, 0, [&](uint32_t i, uint32_t count) {
            return room_below(with_room(axis_joint(site(i, count).t)));
        });
        const uint32_t count = uint32_t(lengths.size());
        for (uint32_t i = 0; i < count; ++i) {
            const Tendril tendril{lengths[i], random_.between(0.85, 1.15), random_.unit()};
            for (const double side : kSides) add_tendril(tendril, site(i, count), side, count);
        }
        if (left_ > 0) add_tendril({}, {last_site_, 0}, 0, count);
    }

    struct Tendril {
        uint32_t joint_count = 1;
        double stretch = 1, phase_turns = 0;
    };
    // `count` is the number of pairs that share the body.
    void add_tendril(const Tendril& tendril, const Site& s, double side, uint32_t count) {
        const Station flesh = axis_.at(s.t);
        const Vec along = axis_.direction(s.t);
        const Vec up = perpendicular({0, 1, 0}, along);
        const Vec across = cross(up, along);
        const double x = sine(s.angle_turns) * side * (across.x < 0 ? -1 : 1), y = cosine(s.angle_turns);
        const Vec outward = normalized(across * x + up * y);
        const Vec base = flesh.center + across * (x * flesh.width * 0.75) + up * (y * flesh.height * 0.75);
        // Long at the head and at the end of the tail, short on the back; thinner where there are many.
        const double size = 0.17 + 0.30 * smooth_step(0.5, 0.24, s.t) + 0.22 * smooth_step(0.85, 0.99, s.t);
        const double reach = size * tendril.stretch * mix(1, 0.6, smooth_step(30, 400, count));
        const double width = std::min(reach * mix(0.085, 0.03, smooth_step(30, 400, count)),
                                      0.3 * flesh.height + 0.004);
        const auto station = [&](double out, double back, double sink, double girth) {
            return Station{base + outward * (reach * out) + along * (reach * back) - Vec{0, reach * sink, 0},
                           width * girth, width * girth};
        };
        const Outline outline({station(0, 0, 0, 1), station(0.28, 0.10, 0, 0.9), station(0.50, 0.32, 0, 0.7),
                               station(0.64, 0.62, 0.03, 0.4), station(0.70, 0.95, 0.10, 0)});
        add_limb({.part = "tendril",
                  .parent_joint = with_room(axis_joint(s.t)),
                  .joint_count = tendril.joint_count,
                  .outline = outline,
                  .up = outward,
                  .side = side,
                  .phase_turns = tendril.phase_turns,
                  .base = influences_at(axis_bones_, s.t)});
    }

    Random random_;
    Build build_{};
    Outline axis_;
    Bones axis_bones_;
    double root_at_ = 0;  // on the axis
    Flank left_flank_, right_flank_;
    uint32_t head_joint_ = 0;
    double head_at_ = 0;                     // on the axis
    double first_site_ = 0, last_site_ = 1;  // where tendrils may grow, on the axis
};

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

    // A point of the sheet: u of the way from the arm to the border, v of the way from the first finger to the next
    // edge.
    SkinPoint at(double u, double v) const {
        // Starts a little beyond the wrist: the fingers meet there, and the first triangles would vanish.
        if (second) u = std::max(0.01, u);
        // The border is drawn in between its fingers.
        const double reach = u * (1 - 0.85 * v * (1 - v) * u * (second ? 1 : 0.7));
        const SkinPoint a = on_limb(first, reach, 1 - v);
        if (second) {
            const SkinPoint b = on_limb(*second, reach, v);
            Vec position = lerp(a.position, b.position, v);
            position.y -= 0.14 * v * (1 - v) * u;  // sags
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

// One tube from the snout to the tip of the tail, a tube along every other chain, sheets between the fingers of the
// wings.
class DragonPieces : BodyPieces {
public:
    DragonPieces(const Dragon& dragon, const CreatureSettings& settings)
        : BodyPieces(dragon.body), dragon_(dragon), colors_(settings.seed), face_budget_(settings.face_count) {}

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
    // The bones of a piece stuck on the body's flesh at t of the axis.
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

    // At most a quarter of the faces. If the creature has more tendrils than that can show, they are chosen evenly.
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
        // Across the sheet at the flank, two edges for every three rings of the arm, which carries it from its second
        // third on.
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

// Waves that travel along the chains.
enum Clip { kIdle, kWalk, kFly, kGlide, kRoar };

bool in_air(uint32_t clip) { return clip == kFly || clip == kGlide; }
// How far the roar has built up, 0 … 1.
double swell(double loop) { return smooth_step(0.1, 0.4, loop) * smooth_step(0.95, 0.65, loop); }

Bend bend_of_tail(const Moment& m) {
    const double loop = m.loop, along = m.along();
    const double share = 1.0 / (m.chain.joint_count + 2);  // so that a tail of few joints does not kink
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

// The hip's bend swings the leg back, the knee's the shin, the foot's the foot.
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

// Fingers follow the arm's beat with a delay. On the ground they half close the fan, the first fingers most.
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
    Dragon dragon = DragonJoints(settings).deal();
    std::vector<Piece> flesh = DragonPieces(dragon, settings).sculpt();
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
