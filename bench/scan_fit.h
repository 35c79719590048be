// Fits the constants of the planner's cost model to measured times.
#pragma once

#include "scan/scan_planner.h"

#include <span>

namespace throng::bench {

// A scan as the cost model sees it, and its measured time.
struct ScanObservation {
    ScanChoice choice;
    ScanRig rig;
    uint32_t instance_count = 0;
    double milliseconds = 0;
    double weight = 1;  // how much its error counts
};

// The median factor between prediction and observation, at least 1.
double typical_factor(std::span<const ScanObservation> observations, const ScanLimits& limits, const ScanCosts& costs);

// The constants that predict the observations best, starting from `start`: minimises the sum of squared logarithms of
// prediction over observation along one constant after the other. `units` and `resident_subgroups` of a software device
// are known and stay.
ScanCosts fit_scan_costs(std::span<const ScanObservation> observations, const ScanLimits& limits,
                         const ScanCosts& start);

}  // namespace throng::bench
