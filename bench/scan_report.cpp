#include "bench/scan_report.h"

#include "base/failure.h"
#include "bench/frame_report.h"
#include "bench/report/html.h"
#include "bench/report/plot.h"
#include "bench/report/tables.h"
#include "bench/summary.h"

#include <throng/crowd.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace throng::bench {
namespace {

constexpr const char* kPaperFinal = "compressed";
const LineStyle kCopyStyle{{"#6e7781", "#8b949e"}, 1.4, "(1,5)", 0, 0.1};

// What a figure shows: the field, and the words beside its axes.
struct View {
    const char* y;
    const char* y_label;
    const char* x;
    const char* x_label;
    bool log_x;
};
constexpr View kTime{"median_ms", "milliseconds, median and p5–p95", "levels", "levels of the skeleton", false};
constexpr View kTimesCopy{"times_copy", "time over the copy's", "levels", "levels of the skeleton", false};
constexpr View kJoints{"ns_per_joint", "nanoseconds a joint", "joints", "joints of a character", true};
constexpr View kCharacters{"ns_per_joint", "nanoseconds a joint", "characters", "characters", true};

// The copy is timed beside each method; it is drawn once for each x, in the unit of the figure.
Series copy_series(const Cells& cells, const View& view) {
    Series copy{"copy", kCopyStyle, {}};
    std::map<double, std::vector<double>> at;
    for (const Json* cell : cells)
        if (const double y = number(*cell, view.y) * number(*cell, "copy_ms") / number(*cell, "median_ms"); y > 0)
            at[number(*cell, view.x)].push_back(y);
    for (auto& [x, values] : at)
        if (!std::isnan(x)) copy.points.push_back({x, spread_of(values).median, 0, 0});
    return copy;
}

std::vector<Series> series_of(const Cells& cells, const View& view) {
    std::vector<Series> all{copy_series(cells, view)};
    for (const Cells& method : grouped(by_rank(cells), {"method"})) {
        const std::string name = text(*method.front(), "method");
        Series series{name, scan_style(name), {}};
        for (const auto& [x, cell] : best_over(method, view.x, view.y)) {
            const double y = number(*cell, view.y), scale = y / number(*cell, "median_ms");
            const bool has_band = name != kPlanner;  // the method that the planner chose has the same band
            if (y > 0)
                series.points.push_back({x, y, has_band ? number(*cell, "p5_ms") * scale : 0,
                                         has_band ? number(*cell, "p95_ms") * scale : 0});
        }
        all.push_back(std::move(series));
    }
    return all;
}

std::string figure(const std::string& svg, const std::string& caption) {
    return svg.empty() ? ""
                       : "<figure><div class=\"plot\">" + svg + "</div>" +
                             (caption.empty() ? "" : "<figcaption>" + caption + "</figcaption>") + "</figure>\n";
}

std::string heading(const std::string& text, const std::string& setting) {
    return "<h3>" + text + "</h3>\n<p class=\"soft\">" + setting + "</p>\n";
}

std::string joined(const std::vector<std::string>& all) {
    std::string text;
    for (const std::string& one : all) text += (text.empty() ? "" : ", ") + one;
    return text;
}

std::string range(const Cells& cells, const char* field) {
    const std::set<double> all = numbers(cells, field);
    if (all.empty()) return {};
    const auto shown = [](double value) { return value == std::round(value) ? whole(value) : digits(value); };
    return shown(*all.begin()) + (all.size() == 1 ? "" : "–" + shown(*all.rbegin()));
}

// "10,000 characters × 300 joints, random skeletons (seed 1), mean depth 9.46–61.2": those parts that the records have.
std::string setting(const Cells& cells, const char* varied) {
    std::vector<std::string> parts;
    const auto add = [&](const char* field, const std::string& before, const std::string& after) {
        if (const std::string value = range(cells, field); field != std::string_view(varied) && !value.empty())
            parts.push_back(before + value + after);
    };
    add("characters", "", " characters");
    add("joints", "", " joints each");
    add("levels", "", " levels");
    if (const auto shapes = texts(cells, "shape"); !shapes.empty())
        parts.push_back(escape(joined(shapes)) + " skeletons");
    add("mean_depth", "mean depth ", "");
    add("seed", "seed ", "");
    return joined(parts);
}

std::string winner(const Json& cell) {
    const double copy = number(cell, "times_copy");
    return escape(text(cell, "method")) + " (" + digits(number(cell, "median_ms")) + " ms" +
           (std::isnan(copy) ? "" : ", " + digits(copy) + " × the copy") + ")";
}

// Who wins at both ends, and how far the paper's final method is behind.
std::string levels_summary(const Cells& cells) {
    const std::map<double, Cells> at = by_number(cells, "levels");
    std::string sentences;
    for (const auto& [level, level_cells] : {*at.begin(), *at.rbegin()})
        if (const Json* best = fastest(level_cells); best && !std::isnan(level) && (sentences.empty() || at.size() > 1))
            sentences += (sentences.empty() ? "Fastest at " : "; at ") + whole(level) + " levels: " + winner(*best);
    const Best paper = best_over(having(cells, "method", kPaperFinal), "levels", "median_ms"),
               plan = best_over(having(cells, "method", kPlanner), "levels", "median_ms");
    if (const double ratio = geometric_mean_ratio(paper, plan, "median_ms"); !std::isnan(ratio))
        sentences += ". The planner's choice is " + digits(ratio) + " times as fast as " + kPaperFinal +
                     ", the paper's final method, in the geometric mean over these depths";
    return sentences.empty() ? "" : sentences + ".";
}

std::string line_figure(const Cells& cells, const View& view, const std::string& title, PageFigures& page) {
    if (!page.drawn) return {};
    return line_plot({.id = page.next_id(),
                      .title = title,
                      .y_label = view.y_label,
                      .x_label = view.x_label,
                      .log_x = view.log_x,
                      .series = series_of(cells, view)});
}

std::string levels_section(const Cells& cells, PageFigures& page) {
    std::string html;
    for (const Cells& panel : grouped(having(cells, "experiment", "levels"), {"shape", "joints", "characters"})) {
        const std::string time = line_figure(panel, kTime, "", page);
        html += heading("Time over levels", setting(panel, "levels"));
        html += figure(time,
                       levels_summary(panel) +
                           " The dotted line is the copy kernel, which moves the same bytes and computes nothing." +
                           (having(panel, "method", kPlanner).empty() ? "" : " Rings are the planner's choices."));
        const std::string over_copy = line_figure(panel, kTimesCopy, "", page);
        if (!over_copy.empty())
            html += "<h3>Time over the copy's</h3>\n" +
                    figure(over_copy,
                           "The same, divided by the time of the copy kernel in the same rounds. Methods that read "
                           "less than 48 bytes a joint, as the quaternion forms do, or stay in caches can be below 1.");
        html += "<h3>Each depth, with what was computed</h3>\n";
        bool is_first = true;
        for (const auto& [level, level_cells] : by_number(panel, "levels")) {
            const Json* best = fastest(level_cells);
            const double depth = number(*level_cells.front(), "mean_depth"),
                         leaves = number(*level_cells.front(), "leaves");
            html += details(whole(level) + " levels<small>" +
                                (std::isnan(depth) ? "" : "mean depth " + digits(depth) + " · ") +
                                (std::isnan(leaves) ? "" : whole(leaves) + " leaves · ") +
                                (best ? "fastest " + winner(*best) : "") + "</small>",
                            case_table(level_cells), std::exchange(is_first, false));
        }
    }
    return html;
}

std::string scaling_section(const Cells& cells, const std::string& experiment, const std::vector<const char*>& fixed,
                            const View& view, const std::string& title, PageFigures& page) {
    std::string html;
    for (const Cells& panel : grouped(having(cells, "experiment", experiment), fixed)) {
        html += heading(title, setting(panel, view.x)) + figure(line_figure(panel, view, "", page), "");
        html += details("The same as a table, " + std::string(view.y_label),
                        matrix_table(panel, view.x, view.x_label, view.y), false);
    }
    return html;
}

std::string on_chip_section(const Cells& cells, PageFigures& page) {
    std::string html;
    for (const Cells& panel : grouped(having(cells, "experiment", "on_chip"), {"shape"})) {
        std::string figures;
        for (const Cells& level : grouped(panel, {"levels"})) {
            BarPlot plot{.id = page.next_id(),
                         .title = whole(number(*level.front(), "levels")) + " levels",
                         .x_label = "ns a joint",
                         .bars = {}};
            for (const Cells& method : grouped(level, {"method"})) {
                const Best best = best_over(method, "levels", "on_chip_ns_per_joint");
                if (best.empty()) continue;
                const Json& cell = *best.begin()->second;
                const std::string name = text(cell, "method");
                const double ns = number(cell, "on_chip_ns_per_joint"), share = number(cell, "barrier_share");
                plot.bars.push_back({name, scan_style(name).ink, ns, number(cell, "on_chip_p5"),
                                     number(cell, "on_chip_p95"), share > 0 ? share : 0,
                                     digits(ns) + (share > 0 ? " · " + whole(100 * share) + " %" : "")});
            }
            std::stable_sort(plot.bars.begin(), plot.bars.end(),
                             [](const Bar& a, const Bar& b) { return a.value < b.value; });
            figures += page.drawn ? figure(bar_plot(plot), "") : "";
        }
        if (figures.empty() && page.drawn) continue;
        html += heading("On the chip", setting(panel, "levels")) +
                "<p>The scan alone, again and again without going to memory. The pale part of a bar, and the "
                "percentage, is what its barriers take at least."
                "</p>\n<div class=\"pair\">" +
                figures + "</div>\n" + details("The same as a table", on_chip_table(panel), false);
    }
    return html;
}

std::string grid_section(const Cells& cells) {
    std::string html;
    for (const Cells& panel : grouped(having(cells, "experiment", "grid"), {"shape"})) {
        html += heading("The planner on the grid",
                        escape(joined(texts(panel, "shape"))) +
                            " skeletons; each cell names the fastest method, its time, and the time of the planner's "
                            "choice as a multiple of it") +
                grid_table(panel);
    }
    return html;
}

std::string scans_section(const Cells& cells, PageFigures& page) {
    const std::string device = text(*cells.front(), "device");
    return "<section>\n<h2>" + (device.empty() ? "Unnamed device" : escape(device)) + "</h2>\n" +
           levels_section(cells, page) + scaling_section(cells, "joints", {"shape"}, kJoints, "Over joints", page) +
           scaling_section(cells, "characters", {"shape", "joints"}, kCharacters, "Over characters", page) +
           on_chip_section(cells, page) + grid_section(cells) + "</section>\n";
}

std::string facts(const Cells& cells) {
    std::string html = "<dl class=\"facts\">";
    const auto add = [&](const char* name, const std::string& value) {
        if (!value.empty()) html += std::string("<div><dt>") + name + "</dt><dd>" + value + "</dd></div>";
    };
    add("device", escape(joined(texts(cells, "device"))));
    add("driver", escape(joined(texts(cells, "driver"))));
    add("subgroup", range(cells, "subgroup_size"));
    add("commit", escape(joined(texts(cells, "commit"))));
    add("date", escape(joined(texts(cells, "date"))));
    const std::vector<std::string> commands = texts(cells, "command");
    add("again with", "<code>" +
                          (commands.empty() ? "throng bench scan --json records.jsonl --report report.html"
                                            : escape(joined(commands))) +
                          "</code>");
    return html + "</dl>\n";
}

std::string legend(const Cells& cells) {
    std::string html = "<div class=\"legend\" aria-label=\"show or hide a method in the figures\">";
    for (const std::string& method : texts(by_rank(cells), "method"))
        html += "<button aria-pressed=\"true\" data-method=\"" + escape(method) + "\">" + method_name(method) +
                "</button>";
    return html + "</div>\n";
}

std::string methods_section(const Cells& cells) {
    const std::vector<std::string> measured = texts(cells, "method");
    std::string rows;
    for (const ScanMethodInfo& method : scan_methods())
        if (std::find(measured.begin(), measured.end(), method.name) != measured.end())
            rows += "<tr><td>" + method_name(method.name) + "</td><td class=\"wide\">" + escape(method.summary) +
                    "</td><td class=\"note\">" + escape(method.source) + "</td></tr>\n";
    if (std::find(measured.begin(), measured.end(), kPlanner) != measured.end())
        rows += "<tr><td>" + method_name(kPlanner) +
                "</td><td class=\"wide\">the planner's choice, from the skeleton's shape, the number of characters and "
                "the device</td><td></td></tr>\n";
    return "<h2>Methods</h2>\n<div class=\"scroll\"><table><tbody>\n" + rows + "</tbody></table></div>\n";
}

std::string measuring_section(const Cells& cells) {
    const std::string samples = range(cells, "samples");
    return R"(<h2>How it was measured</h2>
<p>Time is the GPU's own, between two timestamps around the scan's dispatches. Before a method is timed its results )"
           R"(are compared with the
double-precision reference; a wrong method is reported as wrong and not timed. <em>error</em> is the largest )"
           R"(difference of an element of any matrix, for
translations as a fraction of the skeleton's extent.</p>
<p>After a warm-up the methods take turns, A B C A B C …, so that a change of clock or load meets all of them alike. )"
           R"(Times are the median
)" + (samples.empty() ? "" : "of " + samples + " rounds ") +
           R"(and the 5th and 95th percentile. <em>lanes</em> are the invocations that share a character: where a )"
           R"(method has a choice, its fastest.</p>
<p><em>copy</em> is a kernel that reads and writes 48 bytes a joint, as a scan of affine transforms must, and )"
           R"(computes nothing: the floor. It takes its turn in the same rounds.</p>
<p><em>On the chip</em>: every character reads the same local transforms from shared memory and scans them repeat )"
           R"(after repeat; only the
last result is stored. The difference between two runs of different repeat counts is free of launching, loading and )"
           R"(storing. It is divided by characters
and joints. What the <em>barriers</em> take at least is what is added when each is issued twice, as a share of the )"
           R"(whole: at the second one no invocation has to wait. Noise can make it negative.
A barrier between repeats is part of every method that shares memory.</p>
<p><em>multiplications</em> counts products of transforms for one character, in all invocations; <em>longest )"
           R"(thread</em> those that must follow one another.</p>
)";
}

std::string baseline_section(std::span<const Json> records) {
    const std::string table = baseline_table(records);
    if (table.empty()) return "";
    return R"(<h2>What baking costs</h2>
<p><em>baked</em> stores skin matrices of every frame, <em>flattened</em> model-space clips without a hierarchy; )"
           R"(neither needs a scan. Both pay with
memory for each clip, and with vertices in the wrong place when two clips are blended: the distances are )"
           R"(to the double-precision reference.
On software devices they move 64-bit words, which throng's sample, blend and bind do not do yet; this favours them.</p>
)" + table;
}

}  // namespace

std::string scan_report(std::span<const Json> records, bool with_figures) {
    const Cells cells = scan_cells(records);
    PageFigures page{.drawn = with_figures};
    const std::string frames = frame_section(records, page);
    const char* title = cells.empty() && !frames.empty() ? "A frame of animation" : "Hierarchy-Scan, every method";
    std::string body = std::string("<h1>") + title + "</h1>\n";
    if (!cells.empty()) body += facts(cells) + legend(cells);
    for (const Cells& device : grouped(cells, {"device", "driver"})) body += scans_section(device, page);
    body += frames + summary_section(records) + baseline_section(records);
    if (!cells.empty())
        body += methods_section(cells) + measuring_section(cells);
    else if (frames.empty())
        body += "<p>The records contain no record of the scan benchmark.</p>\n";
    return html_page(std::string("throng: ") + title, body);
}

std::string scan_levels_plot(std::span<const Json> records) {
    const std::vector<Cells> panels = grouped(having(scan_cells(records), "experiment", "levels"),
                                              {"device", "driver", "shape", "joints", "characters"});
    std::string svg;
    if (!panels.empty()) {
        const Cells& panel = panels.front();
        PageFigures page;
        svg = line_figure(panel, kTime,
                          "Hierarchy-Scan of " + range(panel, "characters") + " characters × " +
                              range(panel, "joints") + " joints, " + text(*panel.front(), "device"),
                          page);
    }
    if (svg.empty())
        throw Failure(ErrorCode::kInvalidArgument, "records",
                      "they contain no time of the scan benchmark's experiment 'levels'");
    return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n" + svg;
}

}  // namespace throng::bench
