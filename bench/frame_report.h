// The section of the report on whole updates: the records of `throng bench frame`.
#pragma once

#include "bench/report/plot.h"
#include "bench/report/records.h"

#include <span>
#include <string>

namespace throng::bench {

// HTML; empty where there is no such record. Throws as run_gnuplot() does where figures are drawn.
std::string frame_section(std::span<const Json> records, PageFigures& page);

}  // namespace throng::bench
