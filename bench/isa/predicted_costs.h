// The constants of the planner's cost model (scan/scan_costs.h) for a GPU that is not there: from its machine code and
// its data sheet.
#pragma once

#include "bench/rounds.h"
#include "bench/isa/machines.h"
#include "scan/scan_costs.h"

#include <string>

namespace throng::bench {

struct PredictedCosts {
    ScanCosts costs;
    uint32_t scan_count = 0;   // that they are made from
    double typical_slack = 1;  // of the method that the planner chooses by them: its time over the shortest, as
    double largest_slack = 1;  // machine code predicts both; median and largest over rigs and crowds of several sizes
};

// How dear scattered rows are is not in the code: `assumed` has it, and the time of a launch. Throws as Compiler does.
PredictedCosts predict_scan_costs(const Machine& machine, const ScanCosts& assumed, const Progress& progress);

}  // namespace throng::bench
