#include "procedural/procedural_plan.h"

#include "base/failure.h"
#include "base/find_name.h"
#include "json/known_names.h"
#include "procedural/procedural_io.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

// Processes the rules in order, and cuts the joints that each one moves into chains.
class Planner {
public:
    Planner(const ProceduralRules& rules, const Character& character)
        : rules_(rules),
          character_(character),
          rig_(character.rig),
          read_(rig_.joint_count()),
          written_(rig_.joint_count()),
          chain_below_(rig_.joint_count(), kNone) {
        for (uint32_t joint = 0; joint < rig_.joint_count(); ++joint) {
            const Vec3<double> scale = rig_.rest[joint].scale.as<double>();
            const double largest = std::max({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)});
            scales_.push_back(largest * (rig_.parents[joint] == kNone ? 1 : scales_[rig_.parents[joint]]));
        }
        // A chain goes on with the child that has the tallest subtree. An invocation first walks from its chain up to
        // the root, so few chains should begin far down.
        std::vector<uint32_t> heights(rig_.joint_count());
        for (uint32_t joint = rig_.joint_count(); joint-- > 0;) {
            const uint32_t parent = rig_.parents[joint];
            if (parent == kNone || (chain_below_[parent] != kNone && heights[joint] + 1 < heights[parent])) continue;
            heights[parent] = heights[joint] + 1;
            chain_below_[parent] = joint;
        }
    }

    ProceduralPlan plan() {
        for (size_t i = 0; i < rules_.targets.size(); ++i)
            if (std::find(rules_.targets.begin(), rules_.targets.begin() + static_cast<std::ptrdiff_t>(i),
                          rules_.targets[i]) != rules_.targets.begin() + static_cast<std::ptrdiff_t>(i))
                throw Failure(ErrorCode::kInvalidArgument, character_.name + ": procedural rules",
                              "two targets are named '" + rules_.targets[i] + "'");
        for (rule_ = 0; rule_ < rules_.rules.size(); ++rule_)
            std::visit([&](const auto& rule) { add(rule); }, rules_.rules[rule_]);
        return std::move(plan_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw Failure(ErrorCode::kInvalidArgument, place(), what); }
    [[noreturn]] void fail_unknown(const char* kind, const std::string& name,
                                   const std::vector<std::string>& all) const {
        KnownNames names(kind);
        for (const std::string& one : all) names.add(one);
        fail(names.unknown(name));
    }
    std::string place() const { return character_.name + ": procedural rule " + std::to_string(rule_); }

    void require(bool holds, const char* what) const {
        if (!holds) fail(what);
    }

    static bool is_within_range(float value) { return std::abs(value) <= io::kFarthest; }
    static bool is_within_range(const Vec3<float>& v) {
        return is_within_range(v.x) && is_within_range(v.y) && is_within_range(v.z);
    }

    static bool is_direction(const Vec3<float>& v) {
        const double size = length(v.as<double>());
        return size >= 1 / double{io::kFarthest} && size <= double{io::kFarthest};
    }

    uint32_t joint_named(const std::string& name) const {
        const auto found = std::ranges::find(rig_.names, name);
        if (found == rig_.names.end()) fail_unknown("joint", name, rig_.names);
        if (std::find(found + 1, rig_.names.end(), name) != rig_.names.end())
            fail("several joints are named '" + name + "'");
        return static_cast<uint32_t>(found - rig_.names.begin());
    }

    void check_target(const std::string& name) const {
        if (std::ranges::find(rules_.targets, name) == rules_.targets.end())
            fail_unknown("target", name, rules_.targets);
    }

    void add(const WindRule& rule) {
        require(std::isfinite(rule.bend_rad) && std::isfinite(rule.sway_rad), "bend_rad and sway_rad must be finite");
        require(rule.sway_hz >= 0 && rule.sway_hz <= 64, "sway_hz must be within 0..64");
        add_below(joint_named(rule.joint), {});
    }

    void add(const SpringRule& rule) {
        require(rule.frequency_hz >= 0 && rule.frequency_hz <= 1000, "frequency_hz must be within 0..1000");
        require(rule.damping >= 0 && rule.damping <= 1000, "damping must be within 0..1000");
        require(is_within_range(rule.gravity) && is_within_range(rule.drag), "gravity and drag must be within +-1e15");
        require(is_within_range(rule.radius) && rule.radius >= 0, "radius must be within 0..1e15");
        if (rule.colliders.size() > io::kColliderLimit)
            throw Failure(
                ErrorCode::kLimit, place(),
                std::to_string(rule.colliders.size()) + " colliders; at most " + std::to_string(io::kColliderLimit));
        std::vector<uint32_t> read;
        for (const Collider& collider : rule.colliders) {
            require(is_within_range(collider.a) && is_within_range(collider.b) && is_within_range(collider.radius) &&
                        collider.radius >= 0,
                    "a collider's places must be within +-1e15 and its radius within 0..1e15");
            read.push_back(joint_named(collider.joint));
        }
        const size_t first = plan_.chains.size();
        add_below(joint_named(rule.joint), read);
        for (size_t i = first; i < plan_.chains.size(); ++i) {
            plan_.chains[i].first_spring = plan_.spring_count;
            plan_.spring_count += static_cast<uint32_t>(plan_.chains[i].joints.size());
        }
    }

    void add(const LookAtRule& rule) {
        require(is_direction(rule.forward), "forward must have a length within 1e-15..1e15");
        require(rule.limit_rad >= 0 && rule.limit_rad <= std::numbers::pi_v<float>, "limit_rad must be within 0..pi");
        require(rule.weight >= 0 && rule.weight <= 1, "weight must be within 0..1");
        check_target(rule.target);
        add_chain({joint_named(rule.joint)}, 0, {});
    }

    void add(const ReachRule& rule) {
        require(is_direction(rule.pole), "pole must have a length within 1e-15..1e15");
        require(rule.weight >= 0 && rule.weight <= 1, "weight must be within 0..1");
        check_target(rule.target);
        const uint32_t joint = joint_named(rule.joint), parent = rig_.parents[joint];
        if (parent == kNone || rig_.parents[parent] == kNone)
            fail("joint '" + rule.joint + "' has no parent and grandparent to bend");
        add_chain({rig_.parents[parent], parent, joint}, 0, {});
    }

    // Adds chains for a joint and all its descendants: a chain follows the longest path down, and each other child
    // begins a chain of its own.
    void add_below(uint32_t top, const std::vector<uint32_t>& read) {
        std::vector<uint32_t> generations(rig_.joint_count(), kNone);
        for (uint32_t joint = top; joint < rig_.joint_count(); ++joint) {  // parents come first
            const uint32_t parent = rig_.parents[joint];
            const bool is_below = joint != top && parent != kNone && generations[parent] != kNone;
            if (joint != top && !is_below) continue;
            generations[joint] = is_below ? generations[parent] + 1 : 0;
            if (is_below && chain_below_[parent] == joint) continue;
            std::vector<uint32_t> joints{joint};
            while (chain_below_[joints.back()] != kNone) joints.push_back(chain_below_[joints.back()]);
            add_chain(std::move(joints), generations[joint], read);
        }
    }

    void add_chain(std::vector<uint32_t> joints, uint32_t generation, const std::vector<uint32_t>& also_read) {
        PlannedChain chain{
            .rule = rule_, .rank = 0, .joints = std::move(joints), .bones = {}, .first_generation = generation};
        for (size_t k = 0; k < chain.joints.size(); ++k) chain.bones.push_back(bone_of(chain, k));
        for (uint32_t joint = chain.joints.front(); joint != kNone; joint = rig_.parents[joint]) ++chain.steps;
        for (const uint32_t collider : also_read)
            for (uint32_t joint = collider; joint != kNone; joint = rig_.parents[joint]) ++chain.steps;
        chain.steps += chain.joints.size() * (also_read.size() + 2) + also_read.size() + 2;
        const auto for_each_read = [&](const auto& visit) {
            const auto upwards = [&](uint32_t joint) {
                for (; joint != kNone; joint = rig_.parents[joint]) visit(joint);
            };
            upwards(chain.joints.back());
            for (const uint32_t joint : also_read) upwards(joint);
        };
        for_each_read([&](uint32_t joint) { chain.rank = std::max(chain.rank, written_[joint]); });
        for (const uint32_t joint : chain.joints) chain.rank = std::max(chain.rank, read_[joint]);
        for_each_read([&](uint32_t joint) { read_[joint] = std::max(read_[joint], chain.rank + 1); });
        for (const uint32_t joint : chain.joints) written_[joint] = chain.rank + 1;
        plan_.rank_count = std::max(plan_.rank_count, chain.rank + 1);
        plan_.chains.push_back(std::move(chain));
    }

    // Zero if the bone is so short that its direction comes only from rounding, or from how an exporter wrote a zero
    // length.
    Vec3<float> bone_of(const PlannedChain& chain, size_t k) const {
        constexpr double kShortest = 1e-5;  // of the character's size
        const Vec3<float> bone = any_bone_of(chain, k);
        const double size = length(bone.as<double>()) * scales_[chain.joints[k]];
        return size > kShortest * double{character_.size} ? bone : Vec3<float>();
    }

    // From the joint to the next one; for the last joint, the bone before it continued.
    Vec3<float> any_bone_of(const PlannedChain& chain, size_t k) const {
        if (k + 1 < chain.joints.size()) return rig_.rest[chain.joints[k + 1]].translation;
        const Trs<float>& rest = rig_.rest[chain.joints[k]];
        const Quaternion<float> back{-rest.rotation.x, -rest.rotation.y, -rest.rotation.z, rest.rotation.w};
        return transform_vector(to_affine(Trs<float>{.rotation = back}), rest.translation);
    }

    const ProceduralRules& rules_;
    const Character& character_;
    const Rig& rig_;
    uint32_t rule_ = 0;
    std::vector<double> scales_;            // [joint], upper bound of its space's scale in the rest pose
    std::vector<uint32_t> read_, written_;  // [joint], 1 + the last rank that reads or writes it
    std::vector<uint32_t> chain_below_;     // [joint], the child that continues its chain
    ProceduralPlan plan_;
};

}  // namespace

TargetIndex ProceduralRules::find_target(std::string_view target_name) const { return find_name(targets, target_name); }
Result<TargetIndex> ProceduralRules::target_named(std::string_view target_name) const {
    return index_named<TargetIndex>("procedural rules", "target", targets, target_name);
}

void check_target(uint32_t target, uint32_t target_count, const TargetPlace& value, const ErrorPlace& place) {
    const auto refuse = [&](const std::string& why) { throw Failure(ErrorCode::kInvalidArgument, place, why); };
    if (target >= target_count)
        refuse(joined(numbered("target", target), " is out of range: the rules have ", target_count, " targets"));
    const auto& [x, y, z] = value.world_place;
    for (const float coordinate : {x, y, z})
        if (!(std::abs(coordinate) <= io::kFarthest)) refuse("world_place must be within +-1e15");
    if (!(value.weight >= 0 && value.weight <= 1)) refuse("its weight must be within 0..1");
}

ProceduralPlan plan_procedural(const ProceduralRules& rules, const Character& character) {
    return Planner(rules, character).plan();
}

}  // namespace throng
