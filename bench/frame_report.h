// The section of the report on whole updates: the records of `throng bench frame`.
#pragma once

#include "bench/report/records.h"

#include <span>
#include <string>

namespace throng::bench {

// HTML; empty where there is no such record. Its figures get identifiers from `figure_count` on. Throws as
// run_gnuplot() does.
std::string frame_section(std::span<const Json> records, int& figure_count);

}  // namespace throng::bench
