#include "procedural/procedural_tables.h"

#include "procedural/procedural_io.h"
#include "procedural/wind_clock.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

class Words {
public:
    // Returns the index of its first word.
    template <class T>
    uint32_t add(const T& item) {
        const auto words = std::bit_cast<std::array<uint32_t, sizeof(T) / sizeof(uint32_t)>>(item);
        return add(std::span<const uint32_t>(words));
    }
    uint32_t add(std::span<const uint32_t> words) {
        const auto begin = static_cast<uint32_t>(words_.size());
        words_.insert(words_.end(), words.begin(), words.end());
        return begin;
    }
    std::vector<uint32_t> take() { return std::move(words_); }

private:
    std::vector<uint32_t> words_;
};

uint32_t index_of(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<uint32_t>(std::ranges::find(names, name) - names.begin());
}

struct RuleWriter {
    const ProceduralRules& rules;
    const Rig& rig;
    Words& words;

    std::pair<uint32_t, uint32_t> operator()(const WindRule& rule) const {
        return {io::kChainWind, words.add(io::WindSettings{rule.bend_rad, rule.sway_rad,
                                                           static_cast<float>(rounded_sway_hz(rule.sway_hz))})};
    }
    std::pair<uint32_t, uint32_t> operator()(const SpringRule& rule) const {
        const uint32_t count = static_cast<uint32_t>(rule.colliders.size());
        uint32_t first = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const Collider& c = rule.colliders[i];
            const uint32_t word = words.add(
                io::ColliderShape{index_of(rig.names, c.joint), c.a.x, c.a.y, c.a.z, c.b.x, c.b.y, c.b.z, c.radius});
            if (i == 0) first = word;
        }
        const float omega = 2 * std::numbers::pi_v<float> * rule.frequency_hz;
        return {io::kChainSpring,
                words.add(io::SpringSettings{omega * omega, 2 * rule.damping * omega, rule.gravity.x, rule.gravity.y,
                                             rule.gravity.z, rule.drag, rule.radius, first, count})};
    }
    std::pair<uint32_t, uint32_t> operator()(const LookAtRule& rule) const {
        const Vec3<float> forward = normalized(rule.forward.as<double>()).as<float>();
        return {io::kChainLookAt, words.add(io::LookAtSettings{forward.x, forward.y, forward.z, rule.limit_rad,
                                                               rule.weight, index_of(rules.targets, rule.target)})};
    }
    std::pair<uint32_t, uint32_t> operator()(const ReachRule& rule) const {
        const Vec3<float> pole = normalized(rule.pole.as<double>()).as<float>();
        return {io::kChainReach, words.add(io::ReachSettings{pole.x, pole.y, pole.z, rule.weight,
                                                             index_of(rules.targets, rule.target)})};
    }
};

}  // namespace

ProceduralTables make_procedural_tables(const ProceduralRules& rules, const Character& character) {
    const ProceduralPlan plan = plan_procedural(rules, character);
    ProceduralTables tables{.words = {},
                            .dispatches = {},
                            .spring_count = plan.spring_count,
                            .target_count = static_cast<uint32_t>(rules.targets.size())};
    for (const PlannedChain& chain : plan.chains) tables.max_steps = std::max(tables.max_steps, chain.steps);
    Words words;
    words.add(std::span<const uint32_t>(character.rig.parents));
    std::vector<std::pair<uint32_t, uint32_t>> kinds_and_rules;
    for (const ProceduralRule& rule : rules.rules)
        kinds_and_rules.push_back(std::visit(RuleWriter{rules, character.rig, words}, rule));
    std::vector<uint32_t> first_joints;
    for (const PlannedChain& chain : plan.chains)
        for (size_t k = 0; k < chain.joints.size(); ++k) {
            const uint32_t word = words.add(
                io::ProceduralJoint{chain.joints[k], chain.bones[k].x, chain.bones[k].y, chain.bones[k].z});
            if (k == 0) first_joints.push_back(word);
        }
    for (uint32_t rank = 0; rank < plan.rank_count; ++rank)
        for (uint32_t kind = 0; kind < io::kChainKindCount; ++kind) {
            ProceduralTables::Dispatch dispatch{.rank = rank, .kind = kind};
            for (size_t i = 0; i < plan.chains.size(); ++i) {
                const PlannedChain& chain = plan.chains[i];
                const auto [chain_kind, rule] = kinds_and_rules[chain.rule];
                if (chain.rank != rank || chain_kind != kind) continue;
                const uint32_t word = words.add(io::ProceduralChain{rule, first_joints[i],
                                                                    static_cast<uint32_t>(chain.joints.size()),
                                                                    chain.first_generation, chain.first_spring});
                if (dispatch.chain_count++ == 0) dispatch.first_chain = word;
            }
            if (dispatch.chain_count > 0) tables.dispatches.push_back(dispatch);
        }
    tables.words = words.take();
    return tables;
}

}  // namespace throng
