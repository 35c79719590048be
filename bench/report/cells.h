// Selecting and grouping the records of a benchmark.
#pragma once

#include "bench/report/records.h"
#include "scan/line_style.h"

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace throng::bench {

// A selection of records.
using Cells = std::vector<const Json*>;

inline constexpr const char* kPlanner = "auto";  // among the methods of scans: what the planner has chosen

// How a scan method looks, the same in every figure, and the order in which methods are drawn and listed. Both come
// from the scan table; methods that are not in it get a default, the planner a ring around the point that it chose.
LineStyle scan_style(const std::string& method);
uint32_t scan_rank(const std::string& method);

// The records of benchmark `bench` that have the field `name`. Of several that agree in it and in `fields`, the last
// one is returned, at the position of the first.
Cells latest_cells(std::span<const Json> records, const char* bench, const char* name, std::vector<const char*> fields);
Cells scan_cells(std::span<const Json> records);

// The records whose `field` is `value`.
Cells having(const Cells& cells, const char* field, const std::string& value);

// One group for each combination of the fields' values, in the order of their first appearance.
std::vector<Cells> grouped(const Cells& cells, const std::vector<const char*>& fields);

// By their number in `field`.
std::map<double, Cells> by_number(const Cells& cells, const char* field);

// In the order in which methods are drawn and listed.
Cells by_rank(Cells cells);

// Each text or number once, in the order of appearance; missing ones are left out.
std::vector<std::string> texts(const Cells& cells, const char* field);
std::set<double> numbers(const Cells& cells, const char* field);

// A method's best record at each value of `field` (of several counts of invocations, say) by `quantity`.
using Best = std::map<double, const Json*>;
Best best_over(const Cells& cells, const char* field, const char* quantity);

// The fastest record that is neither wrong nor the planner's, and the record of the planner's choice; null if there is
// none.
const Json* fastest(const Cells& cells);
const Json* planned(const Cells& cells);

// Geometric mean of first over second, over all values of `field` that both have; NaN where there is none.
double geometric_mean_ratio(const Best& first, const Best& second, const char* quantity);

}  // namespace throng::bench
