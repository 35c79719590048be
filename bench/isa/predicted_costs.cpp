#include "bench/isa/predicted_costs.h"

#include "bench/isa/scan_works.h"
#include "bench/skeletons.h"

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

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// What a workgroup issues is about the sum of these, each times its cost: a start, barriers, multiplications, rows.
using Features = std::array<double, 4>;

Features features_of(const ScanPlan& plan, double subgroups) {
    const double instances = plan.instances_per_workgroup;
    return {1, plan.counts.barriers * subgroups, plan.counts.issue_steps * instances,
            plan.counts.issue_rows * instances};
}

// Costs, none below 0, with the least sum of squared relative errors of their sum: one is mended after the other.
Features costs_behind(std::span<const Features> features, std::span<const double> sums) {
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

std::vector<std::vector<ScanWork>> works_of_rigs(const Compiler& compiler, std::vector<ScanRig>& rigs,
                                                 const Progress& progress) {
    std::vector<std::vector<ScanWork>> works;
    for (const auto& [joints, levels] : kRigs) {
        progress(std::to_string(joints) + " joints, " + std::to_string(levels) + " levels");
        rigs.emplace_back(make_skeleton(SkeletonShape::kRandom, joints, levels, 1), true);
        works.emplace_back();
        visit_scan_works(compiler, rigs.back(), ScanPlace::kMemory, [&](const ScanWork& work) {
            if (!work.plan.counts.scattered && work.choice.method->layout == ScanLayout::kCharacterMajor)
                works.back().push_back(work);
        });
    }
    return works;
}

}  // namespace

PredictedCosts predict_scan_costs(const Machine& machine, const ScanCosts& assumed, const Progress& progress) {
    const Compiler compiler(std::string(machine.code), std::max(machine.simd->smallest_subgroup, 32u));
    std::vector<ScanRig> rigs;
    const std::vector<std::vector<ScanWork>> works = works_of_rigs(compiler, rigs, progress);

    std::vector<Features> features;
    std::vector<double> issue_ns, latency_ns, occupancies;  // of a workgroup; of a multiplication
    for (const std::vector<ScanWork>& of_rig : works)
        for (const ScanWork& work : of_rig) {
            const double subgroups = subgroups_of(work.kernel.needs());
            const Waiting waiting = waiting_of(work.of(1), machine);
            features.push_back(features_of(work.plan, subgroups));
            issue_ns.push_back(subgroups * waiting.issue_ns);
            if (work.plan.counts.longest_thread > 0)
                latency_ns.push_back((waiting.issue_ns + waiting.wait_ns) / work.plan.counts.longest_thread);
            occupancies.push_back(occupancy_of(work.kernel.needs(), *machine.simd).subgroups);
        }
    const auto [start, barrier, multiplication, row] = costs_behind(features, issue_ns);

    constexpr double kLeast = 1e-3;  // a cost that does not show does not vanish
    PredictedCosts predicted{.costs = assumed, .scan_count = static_cast<uint32_t>(features.size())};
    ScanCosts& costs = predicted.costs;
    costs.workgroup_ns = std::max(start, kLeast);
    costs.barrier_ns = std::max(barrier, kLeast);
    costs.multiplication_ns = std::max(multiplication, kLeast);
    costs.row_ns = std::max(row, kLeast);
    costs.latency_ns = std::max(median(latency_ns) - kRowsOfAffine * row, kLeast);
    costs.units = machine.simd_count;
    costs.resident_subgroups = machine.simd_count * median(occupancies);
    costs.bytes_per_ns = machine.bytes_per_ns;
    costs.origin = "predicted from machine code for " + std::string(machine.name);

    std::vector<double> slacks;
    for (size_t r = 0; r < works.size(); ++r)
        for (const uint32_t characters : kCrowds) {
            const auto by_code = [&](const ScanWork& work) { return predict(work.of(characters), machine).ms(); };
            const auto by_costs = [&](const ScanWork& work) {
                return predict_ms(work.plan, rigs[r], *work.choice.method, characters, compiler.scan_limits(), costs);
            };
            slacks.push_back((costs.launch_ms + by_code(*std::ranges::min_element(works[r], {}, by_costs))) /
                             (costs.launch_ms + by_code(*std::ranges::min_element(works[r], {}, by_code))));
        }
    predicted.typical_slack = median(slacks);
    predicted.largest_slack = std::ranges::max(slacks);
    return predicted;
}

}  // namespace throng::bench
