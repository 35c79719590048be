// The section of the report on whole updates: the records of `throng bench frame`.
#pragma once

#include "bench/report/plot.h"
#include "bench/report/records.h"

#include <span>
#include <string>

namespace throng::bench {

// HTML; empty if there is no such record. If figures are drawn, throws as run_gnuplot() does.
std::string frame_section(std::span<const Json> records, PageFigures& page);

}  // namespace throng::bench
