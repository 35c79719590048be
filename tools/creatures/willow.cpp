// The willow: a trunk that forks into limbs, boughs that arch outward from them, and strands of leaves that hang from
// both. Wood and leaves look the same for every number of joints, which only decides how finely they bend.
#include "tools/creatures/model.h"

namespace throng::creature {
namespace {

constexpr uint32_t kLimbs = 5, kBoughs = 3;  // boughs on each limb
constexpr uint32_t kBranches = kLimbs * (1 + kBoughs);

bool is_limb(uint32_t branch) { return branch % (1 + kBoughs) == 0; }
double fork_at(uint32_t branch) { return 0.19 + 0.17 * (branch % (1 + kBoughs)); }  // of a bough, on its limb
Vec around(double turns, double radius, double y) { return {radius * cosine(turns), y, radius * sine(turns)}; }

// Where strand `index` of `count` hangs. Strands go along the branches in their order.
struct Site {
    uint32_t branch;
    double t;
};
Site site_of(uint32_t index, uint32_t count) {
    const double place = (index + 0.5) / count * kBranches;
    const uint32_t branch = std::min(uint32_t(place), kBranches - 1);
    return {branch, mix(is_limb(branch) ? 0.45 : 0.2, 1, place - branch)};  // limbs are bare at the fork
}

// The tree's shape, by its seed.
struct Tree {
    uint64_t seed;
    Outline trunk;
    std::vector<Outline> branches;  // each limb before its boughs
    std::vector<double> toward_turns;

    explicit Tree(const CreatureSettings& settings) : seed(settings.seed) {
        Random random(seed);
        const double lean = random.between(-0.08, 0.08), turn = random.unit(), spread = random.between(0.9, 1.1);
        trunk = {{{}, 0.21},
                 {{0.2 * lean, 0.10, 0.01}, 0.15},
                 {{0.8 * lean, 0.34, 0.03}, 0.115, 0.12},
                 {{0.9 * lean, 0.58, 0.0}, 0.105, 0.11},
                 {{1.1 * lean, 0.80, -0.03}, 0.12, 0.115},
                 {{1.1 * lean, 0.96, -0.03}, 0.07}};
        for (uint32_t i = 0; i < kLimbs; ++i) {
            const bool leads = i + 1 == kLimbs;  // up through the middle
            const double toward = turn + (leads ? random.unit() : (i + random.between(-0.15, 0.15)) / (kLimbs - 1));
            const double reach = spread * (leads ? 0.45 : random.between(0.92, 1.08));
            const double height = leads ? 1.09 : random.between(0.92, 1.03);
            const Vec foot = trunk.at(leads ? 0.85 : random.between(0.68, 0.8)).center;
            const auto at = [&](double out, double y, double girth) {
                return Station{foot + around(toward, out * reach, (y - foot.y) * height), girth};
            };
            add_branch({{foot, 0.075},
                        at(0.16, 1.12, 0.062),
                        at(0.33, 1.50, 0.047),
                        at(0.54, 1.80, 0.032),
                        at(0.78, 1.91, 0.016),
                        at(1.02, 1.74, 0.004)},
                       toward);
            for (uint32_t k = 1; k <= kBoughs; ++k)
                add_bough(uint32_t(branches.size()), branches[branches.size() - k], toward, spread * (leads ? 0.8 : 1),
                          random);
        }
    }

    Outline strand(const Site& site, uint32_t number) const {
        Random random(seed + 7919 * (number + 1));
        const Vec top = branches[site.branch].at(site.t).center;
        const double toward = toward_turns[site.branch] + random.between(-0.16, 0.16);
        const double end = random.between(0.08, 0.45) + 0.2 * random.unit();
        const double drop = std::max(0.25, (top.y - end) * random.between(0.8, 1.0)), out = random.between(0.06, 0.17);
        const auto at = [&](double reach, double fall) {
            return Station{top + around(toward, out * reach, -drop * fall)};
        };
        return {at(0, 0), at(0.75, 0.03), at(1.2, 0.30), at(1.25, 0.65), at(1.2, 1)};
    }

private:
    void add_branch(Outline outline, double toward) {
        branches.push_back(std::move(outline));
        toward_turns.push_back(toward);
    }
    void add_bough(uint32_t number, const Outline& limb, double toward, double spread, Random& random) {
        const Station fork = limb.at(fork_at(number));
        const double size = spread * random.between(0.8, 1.1), girth = 0.8 * fork.width;
        const double aside = toward + (number % 2 == 0 ? 1 : -1) * random.between(0.10, 0.17);
        const auto at = [&](double out, double y, double thin) {
            return Station{fork.center + around(aside, out * size, y * size), girth * thin};
        };
        add_branch({at(0, 0, 1), at(0.16, 0.15, 0.75), at(0.36, 0.21, 0.5), at(0.56, 0.10, 0.3), at(0.68, -0.12, 0.1)},
                   aside);
    }
};

// All limbs bend about axes of the same direction, so that the wind moves them the same way: a positive pitch goes
// towards -x.
constexpr Vec kWindward{1};
// Gusts pass through the crown.
double phase_at(const Vec& point) { return 0.16 * point.x + 0.07 * point.z; }

class WillowJoints : Builder {
public:
    explicit WillowJoints(const CreatureSettings& settings) : Builder(settings), tree_(settings) {}

    Body grow() {
        add_root(tree_.trunk, 0, 1, kWindward);
        // First one path to the deepest leaf, then wood; the rest of the joints go to the strands.
        const uint32_t depth = level_count_ - 1, trunk = std::min(8u, (depth + 5) / 6), limb = std::min(8u, depth / 6);
        const uint32_t spare = left_ - depth;
        add_limb({.part = "trunk", .joint_count = trunk, .outline = tree_.trunk, .up = kWindward});
        add_branch(0, limb);
        add_strand({0, 1}, depth - trunk - limb, 0);
        for (uint32_t branch = 1; branch < kBranches; ++branch)
            add_branch(branch, std::min(limb, spare / (2 * kBranches)));
        const uint32_t wish = 3 + uint32_t(0.35 * std::sqrt(double(left_)));
        const std::vector<uint32_t> lengths = share_out(left_, wish, 0, [&](uint32_t i, uint32_t count) {
            const Site site = site_of(i, count);
            return room_below(with_room(wood_of(site.branch).joint_at(site.t)));
        });
        for (uint32_t i = 0; i < lengths.size(); ++i)
            add_strand(site_of(i, uint32_t(lengths.size())), lengths[i], i + 1);
        return std::move(body_);
    }

private:
    // Chain 2 is the deepest strand
    const Chain& wood_of(uint32_t branch) const { return body_.chains[branch == 0 ? 1 : branch + 2]; }

    void add_branch(uint32_t branch, uint32_t joint_count) {
        const Chain& from = is_limb(branch) ? body_.chains[0] : wood_of(branch - branch % (1 + kBoughs));
        add({.part = is_limb(branch) ? "limb" : "bough",
             .joint_count = joint_count,
             .outline = tree_.branches[branch],
             .number = branch},
            from, is_limb(branch) ? 1 : fork_at(branch));
    }
    void add_strand(const Site& site, uint32_t joint_count, uint32_t number) {
        add({.part = "strand",
             .joint_count = joint_count,
             .outline = tree_.strand(site, number),
             .number = site.branch,
             .at_body = site.t},
            wood_of(site.branch), site.t);
    }
    void add(Chain chain, const Chain& from, double t) {
        chain.up = kWindward;
        chain.phase_turns = phase_at(chain.outline.at(0).center);
        add_limb_on(from, t, std::move(chain));
    }

    Tree tree_;
};

class WillowPieces : BodyPieces {
public:
    explicit WillowPieces(const Body& body) : BodyPieces(body) {}

    std::vector<Piece> grow(uint64_t seed) {
        Random random(~seed);
        const Vec bark = color_of(random.between(0.06, 0.10), random.between(0.25, 0.40), random.between(0.30, 0.38));
        const Vec twig = color_of(random.between(0.13, 0.18), 0.5, 0.42);
        add_limbs("trunk", {.paint = fading(bark * 0.75, bark * 1.2), .sides = {8}, .segments = {7}});
        add_limbs("limb", {.paint = fading(bark, twig), .sides = {4}, .segments = {7}});
        for (uint32_t i = 0; i < 5; ++i) {
            const double toward = (i + random.between(-0.2, 0.2)) / 5;
            add(Tube{.outline = {{around(toward, 0.06, 0.16), 0.07, 0.08},
                                 {around(toward, 0.19, 0.05), 0.05, 0.045},
                                 {around(toward + 0.02, 0.32, -0.005), 0.025, 0.02},
                                 {around(toward + 0.03, 0.42, -0.02)}},
                     .paint = plain(bark * 0.8),
                     .sides = {4},
                     .segments = {3}});
        }
        add_limbs("bough", {.paint = fading(bark, twig), .segments = {3}});
        return std::move(pieces_);
    }
};

// Places the leaves. More leaves make more strands, each of which hangs at its own place of a branch.
class Foliage {
public:
    Foliage(const Tree& tree, const Body& body) : tree_(tree) {
        Random random(3 * tree.seed + 1);
        const double hue = random.between(0.19, 0.27);
        shade_ = color_of(hue + 0.03, 0.65, 0.30);
        light_ = color_of(hue, 0.62, 0.66);
        branches_.resize(kBranches);
        for (const Chain& chain : body.chains)
            if (chain.part == "strand") {
                if (chain.joint_count > 0) branches_[chain.number].strands.push_back({chain.at_body, bones_of(chain)});
            } else if (chain.part != "trunk") {
                branches_[chain.number].wood = bones_of(chain);
            }
        for (Branch& branch : branches_)
            std::stable_sort(branch.strands.begin(), branch.strands.end(),
                             [](const Strand& a, const Strand& b) { return a.at_branch < b.at_branch; });
    }

    Leaf at(uint32_t index, uint32_t count) const {
        const uint32_t strands = std::clamp(count / 7, 12u, 500u);
        const uint32_t number = index % strands;
        const Site site = site_of(number, strands);
        Random random(tree_.seed ^ (uint64_t{index} << 20));
        const Outline outline = tree_.strand(site, number + 100);
        // Some leaves cover the wood from which the strands hang: shorter, and in all directions.
        const bool at_top = random.unit() < 0.18;
        const double part = (index / strands + random.unit()) * strands / (count + strands),
                     t = at_top ? 0.12 * part : part * (0.75 + 0.25 * part);
        const Vec base = outline.at(t).center + Vec{0, at_top ? random.between(0, 0.07) : 0, 0},
                  down = outline.direction(t);
        const double turns = random.unit(),
                     size = random.between(0.8, 1.2) * (at_top ? 0.75 : 1) * std::sqrt(1150.0 / count);
        const Vec along = normalized(down + around(turns, at_top ? 0.9 : 0.27, at_top ? -0.5 : 0)) * (0.29 * size);
        const Vec outward = normalized(Vec{base.x, 0.8 * (base.y - 1.0) + 0.25, base.z} +
                                       around(random.unit(), 0.25, 0));
        const Vec across = cross(normalized(along), outward + around(random.unit(), 0.8, 0));
        const double sunny = std::clamp(0.25 + 0.5 * random.unit() + 0.35 * (base.y - 1.0), 0.0, 1.0);
        return {
            base, along, normalized(across) * (0.031 * size), outward, lerp(shade_, light_, sunny), moved_by(site, t)};
    }

private:
    struct Strand {
        double at_branch;
        Bones bones;
    };
    struct Branch {
        Bones wood;
        std::vector<Strand> strands;  // along it
    };
    // The joints of the branch's nearest strand. On a branch without strands, leaves hang stiffly from the wood.
    Influences moved_by(const Site& site, double t) const {
        const std::vector<Strand>& strands = branches_[site.branch].strands;
        if (strands.empty()) return influences_at(branches_[site.branch].wood, site.t);
        const auto after = std::lower_bound(strands.begin(), strands.end(), site.t,
                                            [](const Strand& s, double place) { return s.at_branch < place; });
        const bool before = after == strands.end() ||
                            (after != strands.begin() && site.t - (after - 1)->at_branch < after->at_branch - site.t);
        return influences_at((before ? after - 1 : after)->bones, t);
    }

    Tree tree_;
    Vec shade_, light_;
    std::vector<Branch> branches_;
};

enum Clip { kCalm, kGust };

// A sum of two waves of different length, so that it does not look like clockwork.
double sway(const Moment& m, double lag) {
    const double turns = m.loop - m.chain.phase_turns;
    return 0.7 * sine(turns - lag) + 0.3 * sine(2 * turns - 1.7 * lag + 0.2);
}

// How far wood leans in the wind, and how far it sways.
struct Stiffness {
    double lean, gust, calm, aside, lag, lag_aside;
};
Bend bend_of_wood(const Moment& m, const Stiffness& wood) {
    const double swing = sway(m, wood.lag), share = m.share();
    return {share * (m.clip == kGust ? wood.lean + wood.gust * swing : wood.calm * swing),
            share * wood.aside * sway(m, wood.lag_aside)};
}

Bend bend_of_strand(const Moment& m) {
    const double share = m.share(), lag = 0.15 + 0.45 * m.along();
    if (m.clip == kCalm) return {share * 0.16 * sway(m, lag), share * 0.12 * sway(m, lag + 0.25)};
    const double flutter = 0.18 * m.along() * sine(4 * (m.loop - m.chain.phase_turns) - 2 * lag);
    return {share * (0.85 + 0.5 * sway(m, lag) + flutter), share * 0.28 * sway(m, lag + 0.25)};
}

// The roots hold: the trunk moves only as little as the ground gives.
RootMotion root_motion(uint32_t clip, double loop) {
    const double give = clip == kGust ? 0.006 : 0.002;
    return {{0.1 * give * sine(loop)}, {0, 0, give * sine(loop)}};
}

}  // namespace

Model make_willow(const CreatureSettings& settings) {
    Body body = WillowJoints(settings).grow();
    std::vector<Piece> pieces = WillowPieces(body).grow(settings.seed);
    pieces.push_back(Leaves{.at = [foliage = Foliage(Tree(settings), body)](
                                      uint32_t index, uint32_t count) { return foliage.at(index, count); },
                            .count = {1150}});
    return {std::move(body),
            std::move(pieces),
            {{{"calm", 144}, {"gust", 96}},
             {{"trunk",
               [](const Moment& m) {
                   return bend_of_wood(m, {0.05, 0.025, 0.008, 0.008, 0, 0.3});
               }},
              {"limb",
               [](const Moment& m) {
                   return bend_of_wood(m, {0.10, 0.06, 0.02, 0.02, 0.05, 0.35});
               }},
              {"bough",
               [](const Moment& m) {
                   return bend_of_wood(m, {0.14, 0.10, 0.03, 0.04, 0.08, 0.4});
               }},
              {"strand", bend_of_strand}},
             root_motion}};
}

}  // namespace throng::creature
