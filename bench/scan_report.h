// The report of the benchmarks: figures and tables from its records (bench/README.md), each device for itself.
#pragma once

#include "bench/record.h"

#include <span>
#include <string>

namespace throng::bench {

// A page that stands alone. Where a case was measured again, its last record counts. Of benchmarks other than "scan",
// "frame" and "baseline" it has a table of times. Both throw kUnsupported where figures are drawn and gnuplot is not
// installed.
std::string scan_report(std::span<const Json> records, bool with_figures = true);

// The paper's figure as SVG: the first device's time over levels. Throws kInvalidArgument where there are no such
// records.
std::string scan_levels_plot(std::span<const Json> records);

}  // namespace throng::bench
