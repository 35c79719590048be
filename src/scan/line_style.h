// The style of a scan method's line in figures.
#pragma once

namespace throng {

// A colour for light pages and one for dark pages: "#rrggbb".
struct Ink {
    const char *light, *dark;
};

struct LineStyle {
    Ink ink{"#3d6fb6", "#9cc2f0"};
    double width = 2;
    const char* dashes = "";  // gnuplot's dashtype, "(6,3)"; empty: solid
    int point_type = 11;      // gnuplot's pointtype
    double point_size = 0.5;
};

}  // namespace throng
