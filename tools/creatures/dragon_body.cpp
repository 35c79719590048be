// Deals the joints out: the longest chain (root and tail) first, then trunk, legs, wings, jaw and toes as far as joints
// and levels allow, and the rest as tendrils over the back.
#include "tools/creatures/dragon.h"

namespace throng::creature {
namespace {

constexpr double kRootAt = 10.0 / 16, kHeadAt = 4.0 / 16;  // stations of axis_outline()
constexpr double kChestAt = 8.0 / 16;

// How one creature differs from the next.
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
                        {-2.25, 0.53, 0.032, 0.035}, {-2.52, 0.74, 0.0}};
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

class Dealer : Builder {
public:
    explicit Dealer(const CreatureSettings& settings) : Builder(settings), random_(settings.seed) {
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
        axis_bones_ = {{0}, {0, 1}};
        for (const Chain& chain : body_.chains)
            for (uint32_t k = 0; k < chain.joint_count; ++k) {
                const bool forward = chain.step < 0;  // joints ascend along the axis, bounds between 0 and 1
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

    // Where tendril pair `index` of `count` grows: rows from the crest downwards, each from the head to the tail.
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
        // Where the outermost joint of the axis has no level left below it, tendrils grow only on the joints before it.
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

}  // namespace

Dragon make_dragon_body(const CreatureSettings& settings) { return Dealer(settings).deal(); }

}  // namespace throng::creature
