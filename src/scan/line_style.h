// How a scan method's line looks in a figure.
#pragma once

namespace throng {

// A colour on a light and on a dark page: "#rrggbb".
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
