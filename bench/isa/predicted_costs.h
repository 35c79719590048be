// The constants of the planner's cost model (scan/scan_costs.h) for a GPU that is not at hand, from its machine code
// and its data sheet.
#pragma once

#include "bench/isa/machines.h"
#include "bench/rounds.h"
#include "scan/scan_costs.h"

#include <string>

namespace throng::bench {

struct PredictedCosts {
    ScanCosts costs;
    uint32_t scan_count = 0;  // combinations of method, threads and skeleton in the fit
    // The slack: how many times as long the planner's choice with these constants takes as the fastest choice, both
    // predicted from machine code. Median and largest over rigs and crowds of several sizes.
    double median_slack = 1, largest_slack = 1;
};

// `assumed` has the costs that machine code does not show: of scattered rows, and of a launch. Throws as Compiler does.
PredictedCosts predict_scan_costs(const Machine& machine, const ScanCosts& assumed, const Progress& progress);

}  // namespace throng::bench
