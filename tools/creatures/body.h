// A creature's body plan: chains of joints in model space. Its flesh and its motion follow them.
#pragma once

#include "tools/creatures/creature.h"
#include "tools/creatures/creature_math.h"

#include <functional>
#include <ranges>
#include <string_view>
#include <vector>

namespace throng::creature {

struct Influence {
    uint32_t joint;
    double weight;
};
using Influences = std::vector<Influence>;

// Joints one after the other along a limb. Joint k stands at begin + k * step of the outline and moves the flesh from
// there to the next joint. A limb without joints of its own follows what it grows out of.
struct Chain {
    std::string_view part;      // what it is: "tail", "leg"; joints and motion are named after it
    uint32_t parent_joint = 0;  // the joint that the first one hangs from
    uint32_t first_joint = 0, joint_count = 0;
    Outline outline;
    double begin = 0, step = 0;
    Vec up{0, 1, 0};         // the y axis of its joints, as far as it is perpendicular to the limb
    double side = 0;         // +1 left (x > 0), -1 right, 0 in the middle
    double phase_turns = 0;  // phase of its waves
    uint32_t number = 0;     // among the chains of its part, as the kind counts them
    double at_body = 0;      // where it grows out of the body, 0 … 1
    Influences base{};       // what moves the flesh that it grows out of; empty: the parent joint

    double at(uint32_t k) const { return begin + k * step; }
    // The joint that moves the flesh at t of the outline.
    uint32_t joint_at(double t) const;
};

struct Body {
    std::vector<Chain> chains;       // parents first
    std::vector<uint32_t> parent;    // [joint]
    std::vector<uint32_t> level;     // [joint] 1 for the root
    std::vector<Vec> position;       // [joint] at rest, in model space
    std::vector<Rotation> rotation;  // [joint] model_from_joint at rest, z along the limb

    auto chains_of(std::string_view part) const {
        return chains | std::views::filter([part](const Chain& chain) { return chain.part == part; });
    }
    uint32_t joint_count() const { return uint32_t(parent.size()); }
};

// Grows a body with at most the joints and levels that the settings ask for.
class Builder {
public:
    explicit Builder(const CreatureSettings& settings)
        : level_count_(settings.level_count), left_(settings.joint_count) {}

protected:
    uint32_t room_below(uint32_t joint) const { return level_count_ - body_.level[joint]; }
    // The joint itself, or its nearest ancestor with a level left below it. The root has one while joints are left.
    uint32_t with_room(uint32_t joint) const;

    // `sign` is -1 if the joints go against the outline's direction.
    void add_root(const Outline& outline, double t, double sign, const Vec& up);
    // Adds the chain's joints; its outline, begin and step must be set.
    const Chain& add(Chain chain);
    // Adds a limb from its first station to its last, with as many of its joints as there is room for.
    const Chain& add_limb(Chain limb);
    // The same, but attached to the joint that moves the flesh at t of the chain, or to the nearest ancestor of it that
    // has room. The flesh there moves the limb's base.
    const Chain& add_limb_on(const Chain& chain, double t, Chain limb);

    uint32_t level_count_, left_;  // left_: joints not yet used
    Body body_;

private:
    void place(uint32_t joint, double t, double sign, const Outline& outline, const Vec& up);
};

// Distributes `joint_count` joints over limbs of at most `wish` joints each: over nearly as few sites as have room for
// them, but at least `fewest`. Returns the number of joints of each site. `room(site, site_count)` is at least 1.
std::vector<uint32_t> share_out(uint32_t joint_count, uint32_t wish, uint32_t fewest,
                                const std::function<uint32_t(uint32_t, uint32_t)>& room);

}  // namespace throng::creature
