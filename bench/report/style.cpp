#include "bench/report/style.h"

#include <algorithm>
#include <array>

namespace throng::bench {
namespace {

struct Row {
    const char* method;
    LineStyle style;
};

// Within a family lightness, dashes and the shape of the points tell methods apart, so no pair rests on hue alone.
const std::array kRows{
    Row{"serial_transposed", {{"#98a0a9", "#6e7681"}, 1.6, "", 6, 0.5}},
    Row{"levels", {{"#7f8790", "#8b949e"}, 1.6, "(3,4)", 4, 0.45}},
    Row{"serial", {{"#4f565e", "#b1bac4"}, 1.6, "", 7, 0.4}},
    Row{"gateau2012_walk", {{"#d29922", "#f2cc60"}, 1.8, "(3,4)", 8, 0.6}},
    Row{"kandar2024_leaves", {{"#c4761a", "#ffb757"}, 1.8, "(11,4)", 5, 0.45}},
    Row{"doubling", {{"#e0703c", "#ff9b6a"}, 1.7, "(11,4,3,4)", 10, 0.6}},
    Row{"blocks64", {{"#b34a1f", "#ff8552"}, 1.8, "(6,3)", 12, 0.55}},
    Row{"compressed", {{"#8f2613", "#ff6a4d"}, 2.2, "(14,4)", 9, 0.65}},
    Row{"subgroup", {{"#0a8a94", "#39d3c3"}, 2.2, "", 7, 0.45}},
    Row{"fragments", {{"#2f81f7", "#58a6ff"}, 2.2, "", 7, 0.45}},
    Row{"subgroup_quaternion", {{"#075a73", "#8ee8f5"}, 2.4, "", 5, 0.45}},
    Row{"fragments_quaternion", {{"#0b3d91", "#a5c8ff"}, 2.4, "", 5, 0.45}},
    Row{"serial_quaternion", {{"#7a4fd6", "#b08cff"}, 2.4, "", 13, 0.55}},
};
// For methods that have no row yet, told apart by their names at the lines' ends.
const LineStyle kOther{{"#3d6fb6", "#9cc2f0"}, 2.0, "", 11, 0.5};
const LineStyle kPlannerStyle{{"#1f2328", "#f0f6fc"}, 0.9, "(1,3)", 6, 1.05};

}  // namespace

LineStyle scan_style(const std::string& method) {
    if (method == kPlanner) return kPlannerStyle;
    const auto row = std::find_if(kRows.begin(), kRows.end(), [&](const Row& r) { return r.method == method; });
    return row == kRows.end() ? kOther : row->style;
}

size_t scan_rank(const std::string& method) {
    if (method == kPlanner) return kRows.size() + 1;
    return static_cast<size_t>(
        std::find_if(kRows.begin(), kRows.end(), [&](const Row& r) { return r.method == method; }) - kRows.begin());
}

}  // namespace throng::bench
