#include "bench/isa/predicted_costs.h"

#include "bench/isa/scan_works.h"
#include "bench/skeletons.h"
#include "tools/cli/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng::bench {
namespace {

struct RigSize {
    uint32_t joints, levels;
};
constexpr std::array kRigs{RigSize{32, 8}, RigSize{100, 20}, RigSize{300, 15}, RigSize{300, 100}, RigSize{1'000, 60}};
constexpr std::array kCrowds{100u, 1'000u, 10'000u};

// What a workgroup issues is roughly the sum of these counts, each times its cost: a start, barriers, multiplications,
// rows.
using Features = std::array<double, 4>;

Features features_of(const ScanPlan& plan, double subgroups) {
    const double instances = plan.instances_per_workgroup;
    return {1, plan.counts.barriers * subgroups, plan.counts.issue_steps * instances,
            plan.counts.issue_rows * instances};
}

// The costs, none below 0, that bring the weighted sums closest to `sums` (least squares of relative errors), by
// coordinate descent.
Features fitted_costs(std::span<const Features> features, std::span<const double> sums) {
    Features costs{};
    for (uint32_t round = 0; round < 10'000; ++round)
        for (size_t c = 0; c < costs.size(); ++c) {
            double along = 0, squares = 0;
            for (size_t i = 0; i < sums.size(); ++i) {
                double rest = sums[i];
                for (size_t other = 0; other < costs.size(); ++other)
                    if (other != c) rest -= costs[other] * features[i][other];
                const double weight = features[i][c] / (sums[i] * sums[i]);
                along += weight * rest;
                squares += weight * features[i][c];
            }
            if (squares > 0) costs[c] = std::max(along / squares, 0.0);
        }
    return costs;
}

struct CompiledRig {
    ScanRig rig;
    std::vector<ScanWork> works;
};

std::vector<CompiledRig> compile_rigs(const Compiler& compiler, const Progress& progress) {
    std::vector<CompiledRig> compiled;
    for (const auto& [joints, levels] : kRigs) {
        progress(std::to_string(joints) + " joints, " + std::to_string(levels) + " levels");
        CompiledRig& of = compiled.emplace_back(
            CompiledRig{ScanRig(make_skeleton(SkeletonShape::kRandom, joints, levels, 1), true), {}});
        visit_scan_works(compiler, of.rig, ScanPlace::kMemory, [&](const ScanWork& work) {
            const ScanMethod& method = *work.choice.method;
            const std::vector<uint32_t> planned = planned_choices(method, compiler.scan_limits());
            const bool is_planned = std::ranges::find(planned, work.choice.threads) != planned.end();
            if (is_planned && !work.plan.counts.scattered && method.layout == ScanLayout::kCharacterMajor)
                of.works.push_back(work);
        });
    }
    return compiled;
}

// The slack (see PredictedCosts) for each rig and number of characters.
std::vector<double> slacks_of(std::span<const CompiledRig> rigs, const ScanCosts& costs, const ScanLimits& limits,
                              const Machine& machine) {
    std::vector<double> slacks;
    for (const auto& [rig, works] : rigs)
        for (const uint32_t characters : kCrowds) {
            const auto by_code = [&](const ScanWork& work) {
                return costs.launch_ms + predict(work.of(characters), machine).ms();
            };
            const auto by_costs = [&](const ScanWork& work) {
                return predict_ms(work.plan, rig, *work.choice.method, characters, limits, costs);
            };
            slacks.push_back(by_code(*std::ranges::min_element(works, {}, by_costs)) /
                             by_code(*std::ranges::min_element(works, {}, by_code)));
        }
    return slacks;
}

}  // namespace

PredictedCosts predict_scan_costs(const Machine& machine, const ScanCosts& assumed, const Progress& progress) {
    const Compiler compiler(std::string(machine.code), std::max(machine.simd->smallest_subgroup, 32u));
    const std::vector<CompiledRig> rigs = compile_rigs(compiler, progress);

    std::vector<Features> features;
    std::vector<double> issue_ns, latency_ns, occupancies;  // per workgroup; per multiplication; per SIMD
    for (const CompiledRig& of : rigs)
        for (const ScanWork& work : of.works) {
            const double subgroups = subgroups_of(work.kernel.needs());
            const SubgroupTime alone = subgroup_time(work.of(1), machine);
            features.push_back(features_of(work.plan, subgroups));
            issue_ns.push_back(subgroups * alone.issue_ns);
            if (work.plan.counts.longest_thread > 0)
                latency_ns.push_back((alone.issue_ns + alone.wait_ns) / work.plan.counts.longest_thread);
            occupancies.push_back(occupancy_of(work.kernel.needs(), *machine.simd).subgroups);
        }
    const auto [start, barrier, multiplication, row] = fitted_costs(features, issue_ns);

    constexpr double kMinimum = 1e-3;  // the lower bound: a cost that is too small to show is not 0
    PredictedCosts predicted{.costs = assumed, .scan_count = static_cast<uint32_t>(features.size())};
    ScanCosts& costs = predicted.costs;
    costs.workgroup_ns = std::max(start, kMinimum);
    costs.barrier_ns = std::max(barrier, kMinimum);
    costs.multiplication_ns = std::max(multiplication, kMinimum);
    costs.row_ns = std::max(row, kMinimum);
    costs.latency_ns = std::max(spread_of(latency_ns).median - kRowsOfAffine * row, kMinimum);
    costs.units = machine.simd_count;
    costs.resident_subgroups = machine.simd_count * spread_of(occupancies).median;
    costs.bytes_per_ns = machine.bytes_per_ns;
    costs.origin = "predicted from machine code for " + std::string(machine.name);

    const std::vector<double> slacks = slacks_of(rigs, costs, compiler.scan_limits(), machine);
    predicted.median_slack = spread_of(slacks).median;
    predicted.largest_slack = std::ranges::max(slacks);
    return predicted;
}

}  // namespace throng::bench
