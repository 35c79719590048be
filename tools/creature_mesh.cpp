// Flesh on the body plan: one tube from the snout to the tip of the tail, a tube along every other chain, sheets
// between the fingers of the wings. Every piece says how fine it would like to be; one factor on all of them meets the
// face budget.
#include "creature_bones.h"
#include "creature_palette.h"

#include <span>

namespace throng::creature {
namespace {

// A limb's skin: rings of `sides` vertices, the ends drawn together to a point; the start open where it is inside
// another piece.
struct Tube {
    Outline outline;
    Bones bones;
    Vec up{0, 1, 0};
    Paint paint = Paint::kBody;
    bool open_start = true;
    double wanted_sides = 3, wanted_segments = 1;  // at the usual 1,500 faces
    uint32_t least_sides = 3, least_segments = 1;
    uint32_t segments_per_step = 1;  // segments come in multiples of it
    uint32_t sides = 0, segments = 0;

    uint64_t face_count() const { return uint64_t(sides) * (2 * segments - (open_start ? 1 : 2)); }
    void refine(double factor) {
        sides = std::max(least_sides, uint32_t(wanted_sides * factor + 0.5));
        const uint32_t steps = std::max(1u, uint32_t(wanted_segments / segments_per_step * factor + 0.5));
        segments = std::max(least_segments, steps * segments_per_step);
    }
};

// A sheet of skin between two edges, from u = 0 (the arm or the wrist) to the free border at u = 1.
struct Membrane {
    const Chain* first = nullptr;   // finger
    const Chain* second = nullptr;  // next finger; none for the sheet between the last finger and the flank
    const Chain* arm = nullptr;
    double side = 1;
    uint32_t along = 0, across = 0;

    uint64_t face_count() const { return 2 * uint64_t(along) * across; }
    void refine(double factor) {
        along = std::max(1u, uint32_t(4 * factor + 0.5));
        // At the flank, two for every three rings of the arm, which carries the sheet from its second third on.
        across = second ? along : 2 * std::max(1u, uint32_t(4.0 / 3 * factor + 0.5));
    }
};

class Sculptor {
public:
    Sculptor(const Body& body, const CreatureSettings& settings)
        : body_(body), palette_(settings.seed), face_budget_(settings.face_count), axis_bones_(bones_of_axis(body)) {}

    AssetMesh sculpt() {
        choose_pieces();
        meet_budget();
        for (const Tube& tube : tubes_) build(tube);
        for (const Membrane& membrane : membranes_) build(membrane);
        smooth_normals();
        out_.material = 0;
        out_.influence_count = 4;
        return {.name = "creature", .primitives = {std::move(out_)}};
    }

private:
    // Most important first: what does not fit the budget is left out from the end.
    void choose_pieces() {
        tubes_.push_back({.outline = body_.axis,
                          .bones = axis_bones_,
                          .paint = Paint::kBody,
                          .open_start = false,
                          .wanted_sides = 11,
                          .wanted_segments = 40,
                          .least_sides = 4,
                          .least_segments = 4});
        for (const Chain& c : body_.chains)
            if (c.part == Part::kLeg) add_limb(c, Paint::kLeg, 6, 7);
        for (const Chain& c : body_.chains)
            if (c.part == Part::kArm) {
                add_limb(c, Paint::kFinger, 5, 4);
                tubes_.back().segments_per_step = 3;
            }
        tubes_with_arms_ = tubes_.size();
        for (const Chain& c : body_.chains)
            if (c.part == Part::kFinger) add_limb(c, Paint::kFinger, 3, 4);
        if (const Chain* jaw = body_.find(Part::kJaw)) add_limb(*jaw, Paint::kJaw, 6, 4);
        choose_face();
        choose_crest();
        choose_tendrils();
        for (const Chain& c : body_.chains)
            if (c.part == Part::kToe) add_limb(c, Paint::kClaw, 3, 2);
        choose_membranes();
    }

    void add_limb(const Chain& c, Paint paint, double sides, double segments) {
        tubes_.push_back({.outline = c.outline,
                          .bones = bones_of_limb(c, axis_bones_),
                          .up = c.up,
                          .paint = paint,
                          .wanted_sides = sides,
                          .wanted_segments = segments});
    }
    // Bones of what is stuck on the body's flesh at t of the axis.
    Bones stuck_at(double t) const { return {{0}, {0, 1}, influences_at(axis_bones_, t)}; }

    void choose_face() {
        constexpr double kBrowAt = 0.185, kCrownAt = 0.24;  // on the axis
        const double sides[] = {1, -1};
        const Station brow = body_.axis.at(kBrowAt), crown = body_.axis.at(kCrownAt);
        for (const double side : sides) {
            const Vec eye = brow.center + Vec{side * brow.width * 0.78, brow.height * 0.42, 0};
            const Vec out = normalized(Vec{side, 0.25, 0.35});
            tubes_.push_back({.outline = Outline(
                                  {{eye, 0.042, 0.042}, {eye + out * 0.022, 0.036, 0.036}, {eye + out * 0.034, 0, 0}}),
                              .bones = stuck_at(kBrowAt),
                              .paint = Paint::kEye,
                              .wanted_sides = 6,
                              .wanted_segments = 3,
                              .least_sides = 5,
                              .least_segments = 3});
        }
        for (const double side : sides) {
            const Vec horn = crown.center + Vec{side * crown.width * 0.45, crown.height * 0.45, 0};
            const auto at = [&](double x, double y, double z) { return horn + Vec{side * x, y, z}; };
            tubes_.push_back({.outline = Outline({{horn, 0.05, 0.05},
                                                  {at(0.05, 0.13, -0.12), 0.035, 0.035},
                                                  {at(0.08, 0.19, -0.28), 0.02, 0.02},
                                                  {at(0.07, 0.30, -0.40), 0, 0}}),
                              .bones = stuck_at(kCrownAt),
                              .paint = Paint::kHorn,
                              .wanted_sides = 5,
                              .wanted_segments = 4});
        }
    }

    // Spikes from the neck to the tail, larger over the shoulders.
    void choose_crest() {
        constexpr uint32_t kSpikes = 16;
        for (uint32_t i = 0; i < kSpikes; ++i) {
            const double t = mix(0.27, 0.92, double(i) / (kSpikes - 1));
            const Station flesh = body_.axis.at(t);
            const Vec along = body_.axis.direction(t), up = perpendicular({0, 1, 0}, along);
            const double reach = 0.035 + 0.3 * flesh.height;
            const Vec base = flesh.center + up * (flesh.height * 0.9);
            tubes_.push_back(
                {.outline = Outline({{base, 0.016, 0.05}, {base + up * reach + along * (0.6 * reach), 0, 0}}),
                 .bones = stuck_at(t),
                 .up = along,
                 .paint = Paint::kHorn,
                 .wanted_sides = 3,
                 .wanted_segments = 1});
        }
    }

    // At most a quarter of the faces; evenly chosen where the creature has more tendrils than that can show.
    void choose_tendrils() {
        std::vector<const Chain*> tendrils;
        for (const Chain& c : body_.chains)
            if (c.part == Part::kTendril) tendrils.push_back(&c);
        const size_t most = std::max<size_t>(2, face_budget_ / 4 / 9);
        const size_t shown = std::min(tendrils.size(), most);
        for (size_t i = 0; i < shown; ++i) add_limb(*tendrils[i * tendrils.size() / shown], Paint::kTendril, 3, 4);
    }

    void choose_membranes() {
        for (const double side : {1.0, -1.0}) {
            const Chain *arm = nullptr, *finger = nullptr;
            for (const Chain& c : body_.chains) {
                if (c.side != side) continue;
                if (c.part == Part::kArm) arm = &c;
                if (c.part != Part::kFinger) continue;
                if (finger) membranes_.push_back({finger, &c, arm, side});
                finger = &c;
            }
            if (finger) membranes_.push_back({finger, nullptr, arm, side});
        }
    }

    uint64_t refine(double factor) {
        uint64_t total = 0;
        for (Tube& tube : tubes_) tube.refine(factor), total += tube.face_count();
        for (Membrane& m : membranes_) m.refine(factor), total += m.face_count();
        return total;
    }

    void meet_budget() {
        // Few pieces in a recognisable shape are better than all of them as splinters.
        constexpr double kCoarsest = 0.3;
        while (refine(kCoarsest) > face_budget_ && tubes_.size() > 1) {
            tubes_.pop_back();
            if (tubes_.size() < tubes_with_arms_) membranes_.clear();
        }
        double low = 0, high = 4;
        while (refine(high) < face_budget_) high *= 2;
        for (int i = 0; i < 40; ++i) {
            const double middle = (low + high) / 2;
            (refine(middle) <= face_budget_ ? low : high) = middle;
        }
        uint64_t total = refine(low);
        // What rounding left over: more rings, the body first.
        for (Tube& tube : tubes_) {
            if (tube.paint == Paint::kFinger) continue;  // their rings meet the membranes' edges
            const uint32_t most = &tube == &tubes_.front() ? 0xFFFFFFFFu : 1;
            const uint32_t more = uint32_t(std::min<uint64_t>(most, (face_budget_ - total) / (2 * tube.sides)));
            tube.segments += more;
            total += 2 * uint64_t(tube.sides) * more;
        }
    }

    uint32_t add_vertex(const Vec& position, const Vec& color, Influences influences) {
        std::stable_sort(influences.begin(), influences.end(),
                         [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
        influences.resize(4, {0, 0});
        double sum = 0;
        for (const Influence& i : influences) sum += i.weight;
        for (const Influence& i : influences) {
            out_.influence_joints.push_back(uint16_t(i.weight > 0 ? i.joint : 0));
            out_.influence_weights.push_back(float(i.weight / sum));
        }
        out_.positions.push_back(position.as<float>());
        out_.colors.push_back({float(color.x), float(color.y), float(color.z), 1});
        return uint32_t(out_.positions.size() - 1);
    }
    void add_face(uint32_t a, uint32_t b, uint32_t c) { out_.indices.insert(out_.indices.end(), {a, b, c}); }

    void build(const Tube& tube) {
        Vec up = tube.up;
        uint32_t before = 0;  // the first vertex of the ring before, or the point that the tube starts with
        for (uint32_t ring = 0; ring <= tube.segments; ++ring) {
            const double t = double(ring) / tube.segments;
            const Station station = tube.outline.at(t);
            const Influences influences = influences_at(tube.bones, t);
            const bool is_start = ring == 0, is_end = ring == tube.segments;
            if (is_end || (is_start && !tube.open_start)) {
                const uint32_t point = add_vertex(station.center, palette_.at(tube.paint, t, 0), influences);
                for (uint32_t k = 0; is_end && k < tube.sides; ++k)
                    add_face(before + k, before + (k + 1) % tube.sides, point);
                before = point;
                continue;
            }
            const Vec forward = tube.outline.direction(t);
            up = perpendicular(up, forward);
            const Vec side = cross(up, forward);
            const uint32_t first = uint32_t(out_.positions.size());
            for (uint32_t k = 0; k < tube.sides; ++k) {
                const double angle_turns = 0.25 + double(k) / tube.sides;
                const double x = cosine(angle_turns), y = sine(angle_turns);
                add_vertex(station.center + side * (x * station.width) + up * (y * station.height),
                           palette_.at(tube.paint, t, y), influences);
            }
            for (uint32_t k = 0; k < tube.sides && !is_start; ++k) {
                const uint32_t next = (k + 1) % tube.sides;
                if (ring == 1 && !tube.open_start) {
                    add_face(before, first + next, first + k);
                } else {
                    add_face(before + k, before + next, first + next);
                    add_face(before + k, first + next, first + k);
                }
            }
            before = first;
        }
    }

    struct Point {
        Vec position;
        Influences influences;
    };
    Point on_limb(const Chain& chain, double t, double weight) const {
        return {chain.outline.at(t).center, influences_at(bones_of_limb(chain, axis_bones_), t, weight)};
    }

    // The point u of the way from the arm to the border, v of the way from the first finger to the next edge.
    Point on_membrane(const Membrane& m, double u, double v) const {
        // The border is drawn in between its fingers.
        const double reach = u * (1 - 0.85 * v * (1 - v) * u * (m.second ? 1 : 0.7));
        Point a = on_limb(*m.first, reach, 1 - v);
        if (m.second) {
            Point b = on_limb(*m.second, reach, v);
            Vec position = lerp(a.position, b.position, v);
            position.y -= 0.14 * v * (1 - v) * u;  // hangs through
            a.influences.insert(a.influences.end(), b.influences.begin(), b.influences.end());
            return {position, a.influences};
        }
        constexpr double kShoulderAt = 0.47, kHipAt = 0.65;  // on the axis
        // Coons patch: finger, flank, arm and a straight border. The arm holds the skin near it, the body at the flank.
        const Flank& flank = m.side > 0 ? body_.left_flank : body_.right_flank;
        const Vec on_flank = lerp(flank.shoulder, flank.hip, reach);
        const Vec bulge =
            m.arm->outline.at(1 - v * 2 / 3).center - lerp(m.arm->outline.at(1).center, flank.shoulder, v);
        Vec position = lerp(a.position, on_flank, v) + bulge * (1 - reach);
        position.y -= 0.3 * v * (1 - v) * u;
        const double arm_share = (1 - reach) * 4 * v * (1 - v);
        for (Influence& i : a.influences) i.weight *= 1 - arm_share;
        const Point arm = on_limb(*m.arm, 1 - v * 2 / 3, arm_share);
        a.influences.insert(a.influences.end(), arm.influences.begin(), arm.influences.end());
        const Influences body = influences_at(axis_bones_, mix(kShoulderAt, kHipAt, reach), v * (1 - arm_share));
        a.influences.insert(a.influences.end(), body.begin(), body.end());
        return {position, a.influences};
    }

    void build(const Membrane& m) {
        const uint32_t first = uint32_t(out_.positions.size());
        for (uint32_t i = 0; i <= m.along; ++i)
            for (uint32_t k = 0; k <= m.across; ++k) {
                const double u = double(i) / m.along, v = double(k) / m.across;
                // Not from the very wrist, where the fingers meet and the first triangles would vanish.
                const Point point = on_membrane(m, m.second ? std::max(0.01, u) : u, v);
                add_vertex(point.position, palette_.at(Paint::kWing, u, 0), point.influences);
            }
        const uint32_t row = m.across + 1;
        for (uint32_t i = 0; i < m.along; ++i)
            for (uint32_t k = 0; k < m.across; ++k) {
                const uint32_t a = first + i * row + k;
                uint32_t left = a + row, right = a + 1;
                if (m.side < 0) std::swap(left, right);  // up is outside on both wings
                add_face(a, left, a + row + 1);
                add_face(a, a + row + 1, right);
            }
    }

    // The sum of the faces around a vertex, each by its area.
    void smooth_normals() {
        std::vector<Vec> sum(out_.positions.size());
        const std::span<const uint32_t> indices = out_.indices;
        for (size_t i = 0; i + 2 < indices.size(); i += 3) {
            const auto corner = [&](size_t k) { return out_.positions[indices[i + k]].as<double>(); };
            const Vec area = cross(corner(1) - corner(0), corner(2) - corner(0));
            for (size_t k = 0; k < 3; ++k) sum[indices[i + k]] = sum[indices[i + k]] + area;
        }
        for (const Vec& s : sum) out_.normals.push_back(normalized(s).as<float>());
    }

    const Body& body_;
    Palette palette_;
    uint64_t face_budget_;
    Bones axis_bones_;
    std::vector<Tube> tubes_;
    std::vector<Membrane> membranes_;
    size_t tubes_with_arms_ = 0;
    AssetPrimitive out_;
};

}  // namespace

AssetMesh make_mesh(const Body& body, const CreatureSettings& settings) { return Sculptor(body, settings).sculpt(); }

}  // namespace throng::creature
