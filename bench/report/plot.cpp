#include "bench/report/plot.h"

#include "bench/report/gnuplot.h"
#include "bench/report/html.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace throng::bench {
namespace {

const Ink kTitle{"#1f2328", "#e6edf3"}, kText{"#59636e", "#9da7b1"}, kGrid{"#e1e5e9", "#2a3038"};
constexpr const char* kFonts = "Inter, system-ui, Helvetica Neue, Helvetica, Arial, sans-serif";
constexpr double kFontSize = 14;

std::string number(double value) { return gnuplot_number(value); }

void replace_all(std::string& text, const std::string& old, const std::string& with) {
    for (size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += with.size())
        text.replace(at, old.size(), with);
}

// 1234567 -> "1,234,567"; 0.5 -> "0.5".
std::string tic_text(double value) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "%.10g", value);
    std::string all = text.data();
    if (value >= 1000)
        for (size_t place = all.size(); place > 3;) all.insert(place -= 3, ",");
    return all;
}

// A script that is written element by element, and what is needed to finish the SVG.
class Figure {
public:
    Figure(std::string id, double width, double height) : id_(std::move(id)), width_(width), height_(height) {
        script_ = "set terminal svg size " + number(width) + "," + number(height) + " noenhanced rounded name " +
                  gnuplot_text(id_) + " font 'Helvetica," + number(kFontSize) +
                  "'\nset encoding utf8\nunset key\nunset border\nunset xtics\nunset ytics\n";
    }

    void command(const std::string& line) { script_ += line + "\n"; }
    void margins(double left, double right, double top, double bottom) {
        command("set lmargin at screen " + number(left / width_) + "\nset rmargin at screen " +
                number(1 - right / width_) + "\nset tmargin at screen " + number(1 - top / height_) +
                "\nset bmargin at screen " + number(bottom / height_));
    }
    // In pixels from the top left.
    void caption(const std::string& text, double x, double y, const Ink& ink, const std::string& alignment = "left",
                 const std::string& font = "") {
        command("set label " + gnuplot_text(text) + " at screen " + number(x / width_) + "," + number(1 - y / height_) +
                " " + alignment + " textcolor " + rgb(ink) + (font.empty() ? "" : " font '" + font + "'"));
    }
    // Each row is a line of a gnuplot data block; an empty row lifts the pen. `series` is the series that the element
    // belongs to, or empty.
    void element(const std::string& series, const std::vector<std::string>& rows, const std::string& style) {
        const std::string block = "$data" + std::to_string(owners_.size());
        std::string data = block + " << END\n";
        for (const std::string& row : rows) data += row + "\n";
        script_ += data + "END\n";
        elements_ += (elements_.empty() ? "" : ", ") + block + " " + style;
        owners_.push_back(series);
    }
    void lines(const std::string& series, const std::vector<std::string>& rows, double width, const Ink& ink) {
        element(series, rows, "with lines linewidth " + number(width) + " linecolor " + rgb(ink));
    }
    void range(const char* axis, double from, double to) {
        command("set " + std::string(axis) + "range [" + number(from) + ":" + number(to) + "]");
    }
    std::string rgb(const Ink& ink) {
        inks_[ink.light] = ink.dark;
        return std::string("rgb '") + ink.light + "'";
    }

    std::string draw() const {
        std::string svg = run_gnuplot(script_ + "plot " + elements_ + "\n");
        svg.erase(0, svg.find("<svg"));
        for (size_t i = 0; i < owners_.size(); ++i) {
            const std::string owner = escape(owners_[i]),
                              opening = "id=\"" + id_ + "_plot_" + std::to_string(i + 1) + "\" ><title>",
                              closing = "</title>";
            const size_t start = svg.find(opening);
            if (start == std::string::npos) continue;
            svg.replace(start, svg.find(closing, start) + closing.size() - start,
                        owner.empty() ? ">" : "data-series=\"" + owner + "\"><title>" + owner + closing);
        }
        for (size_t filter; (filter = svg.find("<filter")) != std::string::npos;)
            svg.erase(filter, svg.find("</filter>", filter) + 9 - filter);
        const std::string fonts = std::string("font-family=\"") + kFonts + "\"";
        // Several figures share a page, and identifiers of one must not be found in another.
        for (const auto& [old, with] : {std::pair{"<title>" + id_ + "</title>\n", std::string()},
                                        {"id='gp", "id='" + id_ + "-"},
                                        {"#gp", "#" + id_ + "-"},
                                        {"id=\"gnuplot_canvas\"", "id=\"" + id_ + "\""},
                                        {"font-family=\"Helvetica\"", fonts},
                                        {"font-family=\"Helvetica:Bold\"", "font-weight=\"600\" " + fonts}})
            replace_all(svg, old, with);
        return with_dark_page(with_hexadecimal_colours(svg));
    }

private:
    // gnuplot writes "rgb( 18,52, 86)".
    static std::string with_hexadecimal_colours(std::string svg) {
        for (size_t at = 0; (at = svg.find("rgb(", at)) != std::string::npos; ++at) {
            unsigned red = 0, green = 0, blue = 0;
            std::array<char, 16> text;
            if (std::sscanf(svg.c_str() + at, "rgb(%u,%u,%u)", &red, &green, &blue) != 3) continue;
            std::snprintf(text.data(), text.size(), "#%02x%02x%02x", red & 255, green & 255, blue & 255);
            svg.replace(at, svg.find(')', at) + 1 - at, text.data());
        }
        return svg;
    }

    // A style rule overrides the attribute that gnuplot writes.
    std::string with_dark_page(std::string svg) const {
        std::string style = "<style>@media (prefers-color-scheme: dark) {";
        for (const auto& [light, dark] : inks_)
            for (const std::string property : {"stroke", "fill", "color"})
                style += " [" + property + "=\"" + light + "\"] { " + property + ": " + dark + " }";
        replace_all(svg, "fill = '", "fill='");
        return svg.insert(svg.find("<defs>"), style + " }</style>\n");
    }

    std::string id_;
    double width_, height_;
    std::string script_, elements_;
    std::vector<std::string> owners_;
    std::map<std::string, std::string> inks_;  // light to dark
};

// Moves positions apart until neighbours keep `gap`, as little as possible in the sense of least squares (pool adjacent
// violators), within [low, high] where that has room.
std::vector<double> spread(const std::vector<double>& positions, double gap, double low, double high) {
    std::vector<size_t> order(positions.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return positions[a] < positions[b]; });
    struct Pool {
        double sum = 0;
        size_t count = 0;
        double mean() const { return sum / static_cast<double>(count); }
    };
    std::vector<Pool> pools;
    for (size_t i = 0; i < order.size(); ++i) {
        pools.push_back({positions[order[i]] - gap * static_cast<double>(i), 1});
        for (; pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean(); pools.pop_back()) {
            pools[pools.size() - 2].sum += pools.back().sum;
            pools[pools.size() - 2].count += pools.back().count;
        }
    }
    std::vector<double> result(positions.size());
    size_t i = 0;
    const double last = std::max(low, high - gap * static_cast<double>(positions.size() - 1));
    for (const Pool& pool : pools)
        for (size_t k = 0; k < pool.count; ++k, ++i)
            result[order[i]] = std::clamp(pool.mean(), low, last) + gap * static_cast<double>(i);
    return result;
}

// 1, 2, 5, 10, … in the range; fewer where it is long, more where it is short.
std::vector<double> logarithmic_tics(double low, double high) {
    const double decades = std::log10(high / low);
    const std::vector<double> steps = decades > 4     ? std::vector<double>{1}
                                      : decades > 0.7 ? std::vector<double>{1, 2, 5}
                                                      : std::vector<double>{1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9};
    std::vector<double> tics;
    for (double decade = std::floor(std::log10(low)); decade <= std::log10(high); ++decade)
        for (const double step : steps)
            if (const double tic = step * std::pow(10, decade); tic >= low && tic <= high) tics.push_back(tic);
    return tics;
}

// An axis in pixels: from the smallest to the largest value, with room at both ends.
struct Axis {
    bool logarithmic = false;
    double low = 0, high = 1;   // of the range, logarithms where the axis is logarithmic
    double start = 0, end = 1;  // pixels

    double scaled(double value) const { return logarithmic ? std::log10(value) : value; }
    double pixel(double value) const { return start + (scaled(value) - low) / (high - low) * (end - start); }
    double value(double pixel) const {
        const double s = low + (pixel - start) / (end - start) * (high - low);
        return logarithmic ? std::pow(10, s) : s;
    }
};

Axis axis(bool logarithmic, double smallest, double largest, double start, double end, double room_before,
          double room_after) {
    Axis a{.logarithmic = logarithmic, .start = start, .end = end};
    const double low = a.scaled(smallest),
                 high = std::max(a.scaled(largest), low + 1e-6 * std::max(1.0, std::abs(low)));
    const double per_pixel = (high - low) / (std::abs(end - start) - room_before - room_after);
    a.low = low - per_pixel * room_before;
    a.high = high + per_pixel * room_after;
    return a;
}

std::string row(std::initializer_list<double> values) {
    std::string text;
    for (const double value : values) text += number(value) + " ";
    return text;
}

// Only the values at least `gap` pixels from the one before.
std::vector<double> readable_tics(const std::set<double>& values, const Axis& x, double gap) {
    std::vector<double> tics;
    for (const double value : values)
        if (tics.empty() || x.pixel(value) - x.pixel(tics.back()) >= gap) tics.push_back(value);
    return tics;
}

}  // namespace

std::string line_plot(const LinePlot& given) {
    LinePlot plot = given;
    std::set<double> xs, ys;
    for (Series& series : plot.series)  // the others have no logarithm
        std::erase_if(series.points,
                      [&](const PlotPoint& point) { return !(point.y > 0) || (plot.log_x && !(point.x > 0)); });
    for (const Series& series : plot.series)
        for (const PlotPoint& point : series.points) {
            xs.insert(point.x);
            for (const double y : {point.y, point.low, point.high})
                if (y > 0) ys.insert(y);
        }
    if (xs.empty()) return {};

    constexpr double kWidth = 960, kHeight = 560, kLeft = 58, kNames = 192, kBottom = 54, kLineHeight = 17;
    const double top = plot.title.empty() ? 34 : 70;
    const Axis x = axis(plot.log_x, *xs.begin(), *xs.rbegin(), kLeft, kWidth, 14, kNames);
    const Axis y = axis(true, *ys.begin(), *ys.rbegin(), kHeight - kBottom, top, 12, 12);
    const double names_left = kWidth - kNames + 30;

    Figure figure(plot.id, kWidth, kHeight);
    figure.margins(kLeft, 0, top, kBottom);
    figure.command("set logscale y" + std::string(plot.log_x ? "\nset logscale x" : ""));
    figure.range("x", x.value(x.start), x.value(x.end));
    figure.range("y", y.value(y.start), y.value(y.end));
    if (!plot.title.empty()) figure.caption(plot.title, 12, 20, kTitle, "left", "Helvetica:Bold,17");
    figure.caption(plot.y_label, 12, top - 18, kText);
    figure.caption(plot.x_label, (kLeft + kWidth - kNames) / 2, kHeight - 14, kText, "center");

    std::vector<std::string> grid;
    const double grid_end = x.value(kWidth - kNames + 8);
    for (const double tic : logarithmic_tics(y.value(y.start), y.value(y.end))) {
        grid.insert(grid.end(), {row({x.value(kLeft), tic}), row({grid_end, tic}), ""});
        figure.caption(tic_text(tic), kLeft - 8, y.pixel(tic), kText, "right");
    }
    for (const double tic : readable_tics(xs, x, 44)) {
        grid.insert(grid.end(),
                    {row({tic, y.value(kHeight - kBottom)}), row({tic, y.value(kHeight - kBottom - 5)}), ""});
        figure.caption(tic_text(tic), x.pixel(tic), kHeight - kBottom + 14, kText, "center");
    }
    grid.insert(grid.end(),
                {row({x.value(kLeft), y.value(kHeight - kBottom)}), row({grid_end, y.value(kHeight - kBottom)})});
    figure.lines("", grid, 1, kGrid);

    std::vector<double> ends;
    for (const Series& series : plot.series)
        if (!series.points.empty()) ends.push_back(y.pixel(series.points.back().y));
    const std::vector<double> names = spread(ends, kLineHeight, top + 4, kHeight - kBottom - 6);

    size_t named = 0;
    for (const Series& series : plot.series) {
        if (series.points.empty()) continue;
        const LineStyle& style = series.style;
        const std::string colour = figure.rgb(style.ink);
        std::vector<std::string> band, line;
        for (const PlotPoint& point : series.points) {
            if (point.low > 0 && point.high > 0) band.push_back(row({point.x, point.low, point.high}));
            line.push_back(row({point.x, point.y}));
        }
        if (band.size() > 1)
            figure.element(
                series.name, band,
                "using 1:2:3 with filledcurves fillcolor " + colour + " fillstyle transparent solid 0.1 noborder");
        figure.element(series.name, line,
                       "with linespoints linewidth " + number(style.width) + " pointtype " +
                           std::to_string(style.point_type) + " pointsize " + number(style.point_size) +
                           (*style.dashes ? " dashtype " + std::string(style.dashes) : "") + " linecolor " + colour);
        const PlotPoint& last = series.points.back();
        const double name_y = y.value(names[named++]);
        figure.lines(series.name, {row({x.value(x.pixel(last.x) + 5), last.y}), row({x.value(names_left - 4), name_y})},
                     0.6, style.ink);
        figure.element(series.name, {row({x.value(names_left), name_y}) + gnuplot_text(series.name)},
                       "using 1:2:3 with labels left textcolor " + colour);
    }
    return figure.draw();
}

std::string bar_plot(const BarPlot& plot) {
    double smallest = std::numeric_limits<double>::infinity(), largest = 0;
    for (const Bar& bar : plot.bars) {
        largest = std::max({largest, bar.value, bar.high});
        for (const double value : {bar.value, bar.low})
            if (value > 0) smallest = std::min(smallest, value);
    }
    if (!(largest > 0)) return {};

    constexpr double kWidth = 560, kNames = 158, kNotes = 92, kRow = 25, kTop = 34, kBegin = 30, kEnd = 26;
    const double bottom_margin = plot.log_x ? 30 : 12, rows = static_cast<double>(plot.bars.size()),
                 height = kTop + bottom_margin + kRow * rows;
    const Axis x = plot.log_x ? axis(true, smallest, largest, kNames, kWidth - kNotes, kBegin, kEnd)
                              : axis(false, 0, largest, kNames, kWidth - kNotes, 0, 0);
    const double begin = x.value(x.start);

    Figure figure(plot.id, kWidth, height);
    figure.margins(kNames, kNotes, kTop, bottom_margin);
    figure.range("x", begin, x.value(x.end));
    figure.range("y", rows, 0);
    if (plot.log_x) figure.command("set logscale x");
    figure.caption(plot.title, kNames, 14, kTitle, "left", "Helvetica:Bold,14");
    figure.caption(plot.x_label, kWidth - 4, 14, kText, "right");
    if (plot.log_x) {
        std::vector<std::string> grid;
        for (const double tic : logarithmic_tics(begin, x.value(x.end))) {
            grid.insert(grid.end(), {row({tic, 0}), row({tic, rows}), ""});
            figure.caption(tic_text(tic), x.pixel(tic), height - bottom_margin + 14, kText, "center");
        }
        if (!grid.empty()) figure.lines("", grid, 1, kGrid);
    }
    for (size_t i = 0; i < plot.bars.size(); ++i) {
        const Bar& bar = plot.bars[i];
        const auto above = static_cast<double>(i);
        const double middle = above + 0.5;
        const double split = bar.value * (1 - std::clamp(bar.pale_share, 0.0, 1.0));
        const auto box = [&](double from, double to, const char* density) {
            if (to > from)
                figure.element(bar.name, {row({from, middle, from, to, above + 0.16, above + 0.84})},
                               "using 1:2:3:4:5:6 with boxxyerror fillcolor " + figure.rgb(bar.ink) +
                                   " fillstyle transparent solid " + density + " noborder");
        };
        box(begin, split, "0.92");
        box(split, bar.value, "0.38");
        if (bar.high > bar.low) figure.lines(bar.name, {row({bar.low, middle}), row({bar.high, middle})}, 1.2, kTitle);
        figure.caption(bar.name, kNames - 8, kTop + kRow * middle, kTitle, "right");
        figure.caption(bar.note, std::max(x.pixel(bar.value), x.pixel(bar.high)) + 7, kTop + kRow * middle, kText);
    }
    figure.lines("", {row({begin, 0}), row({begin, rows})}, 1, kText);
    return figure.draw();
}

}  // namespace throng::bench
