// The tables of the report, as HTML.
#pragma once

#include "bench/report/cells.h"

#include <functional>
#include <string_view>

namespace throng::bench {

// A spot of colour, for the beginning of a row.
std::string swatch(const Ink& ink);
// A method's name with its colour.
std::string method_name(const std::string& method);

struct Column {
    std::string_view head;
    std::function<std::string(const Json&)> cell;
    bool is_note = false;  // text, not numbers
};
using Shown = std::string (*)(double);  // digits, whole, …
// A number, bold where it is `best`.
Column numbers_of(std::string_view head, const char* field, Shown shown,
                  std::function<bool(const Json&)> best = nullptr);
Column spread_of_times(const char* low, const char* high);

// A row for each record. A record without `time` has only the first `named_by` columns, followed by the reason;
// `not_done` comes before an "unsupported_reason". Empty if there is no record.
std::string record_table(const Cells& cells, const std::vector<Column>& columns, size_t named_by, const char* time,
                         std::string_view not_done);

// Each method of one case: its counts beside its times.
std::string case_table(const Cells& cells);

// Methods over the values of `field`.
std::string matrix_table(const Cells& cells, const char* field, std::string_view field_name, const char* quantity);

// What each method's time on the chip is made of, over levels.
std::string on_chip_table(const Cells& cells);

// The fastest method of each cell of the grid, and how far the planner's choice is from it.
std::string grid_table(const Cells& cells);

std::string baseline_table(std::span<const Json> records);

}  // namespace throng::bench
