// Measures the constants of the planner's cost model on a device: times scans of many kinds, and fits the model to
// them.
#pragma once

#include "bench/rounds.h"
#include "scan/scan_planner.h"

namespace throng::bench {

// A scan as the model sees it, and what it took.
struct ScanObservation {
    ScanChoice choice;
    ScanRig rig;
    uint32_t instance_count = 0;
    double milliseconds = 0;
    double weight = 1;  // how much its error counts
};

// The median factor between prediction and observation, at least 1.
double typical_factor(std::span<const ScanObservation> observations, const ScanLimits& limits, const ScanCosts& costs);

// The constants that predict the observations best, from `start` on: the sum of squared logarithms of prediction over
// observation is lowered along one constant after the other. `units` and `resident_subgroups` of a software device are
// known and stay.
ScanCosts fit_scan_costs(std::span<const ScanObservation> observations, const ScanLimits& limits,
                         const ScanCosts& start);

// Times every method with every number of lanes on rigs and crowds of several sizes; `quick`: on few. Throws as
// measure_scans() does.
std::vector<ScanObservation> observe_scans(const std::shared_ptr<Gpu>& gpu, bool quick, const Progress& progress);

}  // namespace throng::bench
