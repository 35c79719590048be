#include "bench/scan_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace throng::bench {
namespace {

using Constant = double ScanCosts::*;
constexpr std::array<Constant, 5> kOfEveryDevice{&ScanCosts::launch_ms, &ScanCosts::row_ns,
                                                 &ScanCosts::multiplication_ns, &ScanCosts::barrier_ns,
                                                 &ScanCosts::workgroup_ns};
constexpr std::array<Constant, 5> kOfGpus{&ScanCosts::scattered_rows, &ScanCosts::latency_ns, &ScanCosts::units,
                                          &ScanCosts::resident_subgroups, &ScanCosts::bytes_per_ns};

constexpr double kMinimum = 1e-3;  // lower bound, in each constant's unit: a cost that is too small to show is not 0

// An observation with its plan, which does not depend on the constants.
struct PlannedObservation {
    const ScanObservation* observation;
    ScanPlan plan;
};

std::vector<PlannedObservation> plan_all(std::span<const ScanObservation> observations, const ScanLimits& limits) {
    std::vector<PlannedObservation> planned;
    for (const ScanObservation& o : observations)
        planned.push_back({&o, plan_scan(*o.choice.method, o.rig, limits, o.choice.threads)});
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
    for (double factor = 4;
         factor > 1.01;) {  // the model is cheap, and smooth in the constants' logarithms except for kinks
        bool improved = false;
        for (const Constant constant : constants) {
            for (const double step : {factor, 1 / factor}) {
                ScanCosts trial = best;
                trial.*constant = std::max(trial.*constant * step, kMinimum);
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

}  // namespace throng::bench
