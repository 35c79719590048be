#include "bench/scan_tune.h"

#include "base/failure.h"
#include "bench/scan_cell.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace throng::bench {
namespace {

using Constant = double ScanCosts::*;
constexpr std::array<Constant, 5> kOfEveryDevice{&ScanCosts::launch_ms, &ScanCosts::row_ns,
                                                 &ScanCosts::multiplication_ns, &ScanCosts::barrier_ns,
                                                 &ScanCosts::workgroup_ns};
constexpr std::array<Constant, 5> kOfGpus{&ScanCosts::scattered_rows, &ScanCosts::latency_ns, &ScanCosts::units,
                                          &ScanCosts::resident_subgroups, &ScanCosts::bytes_per_ns};

constexpr double kLeast = 1e-3;  // of a constant, in its unit: a cost that does not show does not vanish

// An observation with its plan, which does not depend on the constants.
struct PlannedObservation {
    const ScanObservation* observation;
    ScanPlan plan;
};

std::vector<PlannedObservation> plan_all(std::span<const ScanObservation> observations, const ScanLimits& limits) {
    std::vector<PlannedObservation> planned;
    for (const ScanObservation& o : observations)
        planned.push_back({&o, plan_scan(*o.choice.method, o.rig, limits, o.choice.lanes)});
    return planned;
}

double log_factor(const PlannedObservation& planned, const ScanLimits& limits, const ScanCosts& costs) {
    const ScanObservation& o = *planned.observation;
    return std::log(predict_ms(planned.plan, o.rig, *o.choice.method, o.instance_count, limits, costs) /
                    o.milliseconds);
}

double cost_of(const std::vector<PlannedObservation>& planned, const ScanLimits& limits, const ScanCosts& costs) {
    double sum = 0;
    for (const PlannedObservation& p : planned)
        sum += p.observation->weight * std::pow(log_factor(p, limits, costs), 2);
    return sum;
}

// A method far behind the fastest of its cell is never chosen, so its error matters less.
void weigh(std::span<ScanObservation> of_cell) {
    double fastest = std::numeric_limits<double>::infinity();
    for (const ScanObservation& o : of_cell) fastest = std::min(fastest, o.milliseconds);
    for (ScanObservation& o : of_cell) o.weight = fastest / o.milliseconds;
}

}  // namespace

double typical_factor(std::span<const ScanObservation> observations, const ScanLimits& limits, const ScanCosts& costs) {
    std::vector<double> factors;
    for (const PlannedObservation& p : plan_all(observations, limits))
        factors.push_back(std::exp(std::abs(log_factor(p, limits, costs))));
    if (factors.empty()) return 1;
    std::nth_element(factors.begin(), factors.begin() + static_cast<std::ptrdiff_t>(factors.size() / 2), factors.end());
    return factors[factors.size() / 2];
}

ScanCosts fit_scan_costs(std::span<const ScanObservation> observations, const ScanLimits& limits,
                         const ScanCosts& start) {
    const std::vector<PlannedObservation> planned = plan_all(observations, limits);
    std::vector<Constant> constants(kOfEveryDevice.begin(), kOfEveryDevice.end());
    if (!limits.is_cpu) constants.insert(constants.end(), kOfGpus.begin(), kOfGpus.end());
    ScanCosts best = start;
    double best_cost = cost_of(planned, limits, best);
    // The model is cheap, and smooth in the constants' logarithms but for kinks
    for (double factor = 4; factor > 1.01;) {
        bool improved = false;
        for (const Constant constant : constants) {
            for (const double step : {factor, 1 / factor}) {
                ScanCosts trial = best;
                trial.*constant = std::max(trial.*constant * step, kLeast);
                const double cost = cost_of(planned, limits, trial);
                if (cost >= best_cost) continue;
                best = trial;
                best_cost = cost;
                improved = true;
            }
        }
        if (!improved) factor = std::sqrt(factor);
    }
    return best;
}

std::vector<ScanObservation> observe_scans(const std::shared_ptr<Gpu>& gpu, bool quick, const Progress& progress) {
    const ScanLimits limits = scan_limits(*gpu);
    std::vector<Entrant> entrants;
    for (const ScanMethod& method : scan_table())
        if (method.layout == ScanLayout::kCharacterMajor)
            for (const uint32_t lanes : method.lane_choices(limits))
                entrants.push_back({name_of(ScanChoice{&method, lanes}), {{&method, lanes}}});

    // What launches, what latency holds back, and what fills the device; a GPU is not full before.
    const uint32_t many = limits.is_cpu ? 1'000 : 20'000;
    std::vector<std::pair<uint32_t, uint32_t>> rigs{{32, 8}, {300, 15}, {300, 100}, {1'000, 60}};  // joints, levels
    std::vector<uint32_t> crowds{1, 20, 300, many};
    if (quick) rigs = {{32, 8}, {300, 60}}, crowds = {1, 100};
    std::vector<ScanObservation> observations;
    for (const auto& [joints, levels] : rigs) {
        for (const uint32_t characters : crowds) {
            const ScanCell cell{.experiment = "tune", .characters = characters, .joints = joints, .levels = levels};
            const auto cell_progress = [&](const std::string& text) {
                progress(std::to_string(joints) + " joints, " + std::to_string(characters) + " characters: " + text);
            };
            const std::vector<nlohmann::json> records = measure_scans(
                gpu, cell, entrants, {.samples = quick ? 3u : 7u, .least_samples = 2, .budget_s = quick ? 2.0 : 6.0},
                cell_progress);
            const size_t first = observations.size();
            for (size_t i = 0; i < entrants.size(); ++i) {
                if (records[i].contains("wrong"))
                    throw Failure(ErrorCode::kVulkan, "scan method '" + entrants[i].name + "'",
                                  "gives wrong results on this device; nothing was kept");
                const double median_ms = records[i].value("median_ms", 0.0);
                if (median_ms > 0)
                    observations.push_back({entrants[i].choices.front(), cell.rig(), characters, median_ms});
            }
            weigh(std::span(observations).subspan(first));
        }
    }
    return observations;
}

}  // namespace throng::bench
