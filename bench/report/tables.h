// The tables of the scan benchmark's report, as HTML.
#pragma once

#include "bench/report/cells.h"

#include <string>
#include <string_view>

namespace throng::bench {

// A spot of colour, for the beginning of a row.
std::string swatch(const Ink& ink);
// A method's name with its colour.
std::string method_name(const std::string& method);

// Each method of one case: its counts beside its times.
std::string case_table(const Cells& cells);

// Methods over the values of `field`.
std::string matrix_table(const Cells& cells, const char* field, std::string_view field_name, const char* quantity);

// What each method's time on the chip is made of, over levels.
std::string on_chip_table(const Cells& cells);

// The fastest method of each cell of the grid, and how far from it the planner's choice is.
std::string grid_table(const Cells& cells);

std::string baseline_table(std::span<const Json> records);

}  // namespace throng::bench
