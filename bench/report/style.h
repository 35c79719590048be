// How each scan method looks, the same in every figure: the paper's methods orange and dashed, the plain ones grey,
// ours blue to violet and solid, the planner's choice a ring around the point that it chose.
#pragma once

#include "bench/report/plot.h"

#include <string>

namespace throng::bench {

inline constexpr const char* kPlanner = "auto";

LineStyle scan_style(const std::string& method);

// The order in which methods are drawn and listed: plain, paper's, ours, the planner. Unknown ones are ours.
size_t scan_rank(const std::string& method);

}  // namespace throng::bench
