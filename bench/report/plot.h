// Figures, drawn by gnuplot to SVG, all in the same style. Lines carry their names at their right ends, the background
// is transparent, and colours change when the page is dark. Groups in the SVG carry data-series.
#pragma once

#include "scan/line_style.h"

#include <string>
#include <vector>

namespace throng::bench {

// The figures of a page.
struct PageFigures {
    bool drawn = true;  // else there are only tables, and gnuplot is not needed
    int count = 0;

    std::string next_id() { return "figure" + std::to_string(++count); }
};

// Low to high is drawn as a band if both are given.
struct PlotPoint {
    double x = 0, y = 0, low = 0, high = 0;
};

struct Series {
    std::string name;
    LineStyle style;
    std::vector<PlotPoint> points;
};

// y is logarithmic, since ratios are compared. Points that are not positive on a logarithmic axis are left out.
struct LinePlot {
    std::string id;  // keeps the parts of several figures on one page apart
    std::string title, y_label, x_label;
    bool log_x = false;
    std::vector<Series> series;  // later ones lie over earlier ones
};
// Empty where there is no point. Throws as run_gnuplot() does.
std::string line_plot(const LinePlot& plot);

struct Bar {
    std::string name;
    Ink ink;
    double value = 0, low = 0, high = 0;
    double pale_share = 0;  // 0..1, the right part of the bar
    std::string note;       // to the right of it
};
struct BarPlot {
    std::string id;
    std::string title, x_label;
    bool log_x = false;     // bars then begin somewhat below the smallest value, and the axis has numbers
    std::vector<Bar> bars;  // from the top
};
std::string bar_plot(const BarPlot& plot);

}  // namespace throng::bench
