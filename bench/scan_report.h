// The report of the benchmarks: figures and tables from their records (bench/README.md), separate for each device.
#pragma once

#include "bench/record.h"

#include <span>
#include <string>

namespace throng::bench {

// A self-contained page. If a case was measured again, its last record counts. Benchmarks other than "scan", "frame"
// and "baseline" get a table of times. Both throw kUnsupported if figures are drawn and gnuplot is not installed.
std::string scan_report(std::span<const Json> records, bool with_figures = true);

// The paper's figure as SVG: the first device's time over levels. Throws kInvalidArgument if there are no such records.
std::string scan_levels_plot(std::span<const Json> records);

}  // namespace throng::bench
