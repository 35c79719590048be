// Measures the constants of the planner's cost model on a device: times scans of many kinds, to which scan_fit.h fits
// the model.
#pragma once

#include "bench/rounds.h"
#include "bench/scan_fit.h"

namespace throng::bench {

// Times every character-major method, with each number of threads that the planner chooses among, on rigs and crowds of
// several sizes; if `quick`, on only a few. Throws as measure_scans() does.
std::vector<ScanObservation> observe_scans(const std::shared_ptr<Gpu>& gpu, bool quick, const Progress& progress);

}  // namespace throng::bench
