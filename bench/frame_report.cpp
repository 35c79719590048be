#include "bench/frame_report.h"

#include "bench/report/html.h"
#include "bench/report/plot.h"
#include "bench/report/tables.h"

#include <throng/crowd.h>

#include <cmath>

namespace throng::bench {
namespace {

const Ink kStaged{"#c4761a", "#ffb757"}, kFused{"#2f81f7", "#58a6ff"}, kFloor{"#98a0a9", "#6e7681"};

Ink ink_of(const Json& record) {
    const std::string path = text(record, "path");
    return path == "staged" ? kStaged : path == "fused" ? kFused : kFloor;
}

std::string stages_of(const Json& record) {
    std::string all;
    for (const char* stage : stage_names())
        if (const double ms = number(record, std::string("stages/") + stage); !std::isnan(ms))
            all += (all.empty() ? "" : ", ") + std::string(stage) + " " + digits(ms);
    return all;
}

// How many rounds were timed by the host's clock; empty if none was.
std::string host_share_of(const Json& record) {
    const double by_host = number(record, "host_samples");
    return by_host > 0 ? "; host's time in " + whole(by_host) + " of " + whole(number(record, "samples")) + " rounds"
                       : "";
}

std::string table_of(const Cells& cells) {
    return record_table(
        cells,
        {{"variant", [](const Json& record) { return swatch(ink_of(record)) + escape(text(record, "variant")); }},
         numbers_of("ms", "ms/median", digits),
         spread_of_times("ms/p5", "ms/p95"),
         numbers_of("ns a joint", "ns_per_joint", digits),
         numbers_of("MB moved", "bytes", [](double bytes) { return digits(bytes * 1e-6); }),
         numbers_of("GB/s", "gb_per_s", digits),
         numbers_of("× fill", "times_fill_floor", digits),
         numbers_of("error", "max_error", digits),
         {"stages, ms",
          [](const Json& record) {
              const std::string by = text(record, "by");
              return "<small>" + (by.empty() ? stages_of(record) : "by " + escape(by)) + host_share_of(record) +
                     "</small>";
          },
          true}},
        1, "ms/median", "not measured");
}

double median_of(const Cells& cells, const char* variant) {
    const Cells found = having(cells, "variant", variant);
    return found.empty() ? std::nan("") : number(*found.front(), "ms/median");
}

std::string summary_of(const Cells& cells) {
    const double ratio = median_of(cells, "staged") / median_of(cells, "fused");
    const Cells fused = having(cells, "variant", "fused");
    const double times_fill = fused.empty() ? std::nan("") : number(*fused.front(), "times_fill_floor");
    std::string sentence;
    if (!std::isnan(ratio)) sentence = "Fused is " + digits(ratio) + " times as fast as staged";
    if (!std::isnan(times_fill))
        sentence += (sentence.empty() ? "Fused takes " : " and takes ") + digits(times_fill) +
                    " times as long as writing its result";
    return sentence.empty() ? sentence : sentence + ".";
}

std::string figure_of(const Cells& cells, PageFigures& page) {
    BarPlot plot{.id = page.next_id(),
                 .title = text(*cells.front(), "configuration"),
                 .x_label = "ms",
                 .log_x = true,
                 .bars = {}};
    for (const Json* record : cells) {
        const double ms = number(*record, "ms/median");
        if (!(ms > 0)) continue;
        const double times_fill = number(*record, "times_fill_floor");
        plot.bars.push_back({.name = text(*record, "variant"),
                             .ink = ink_of(*record),
                             .value = ms,
                             .low = number(*record, "ms/p5"),
                             .high = number(*record, "ms/p95"),
                             .note = digits(ms) + (std::isnan(times_fill) ? "" : " · " + digits(times_fill) + " ×")});
    }
    const std::string svg = page.drawn ? bar_plot(plot) : "", summary = summary_of(cells);
    return svg.empty()
               ? ""
               : "<figure><div class=\"plot\">" + svg + "</div><figcaption>" + summary + "</figcaption></figure>\n";
}

std::string updates_section(const Cells& cells, PageFigures& page) {
    std::string figures, tables;
    for (const Cells& configuration : grouped(cells, {"configuration", "characters", "joints", "levels"})) {
        const Json& first = *configuration.front();
        figures += figure_of(configuration, page);
        tables += details(escape(text(first, "configuration")) + "<small>" + whole(number(first, "characters")) +
                              " characters × " + whole(number(first, "joints")) + " joints · mean depth " +
                              digits(number(first, "mean_depth")) + " · keys " + escape(text(first, "keys")) +
                              "</small>",
                          table_of(configuration), true);
    }
    const Json& any = *cells.front();
    const std::string device = text(any, "device"), driver = text(any, "driver"), commit = text(any, "commit"),
                      date = text(any, "date");
    return "<section>\n<h2>Whole updates: " + (device.empty() ? "unnamed device" : escape(device)) +
           "</h2>\n<p class=\"soft\">" + escape(driver) + (commit.empty() ? "" : ", commit " + escape(commit)) +
           (date.empty() ? "" : ", " + escape(date)) + "</p>\n<div class=\"pair\">" + figures + "</div>\n" + tables +
           "</section>\n";
}

constexpr const char* kMethod =
    R"(<p>An update takes every character from its clips' times to its skin matrices. <em>staged</em>: sample, blend,)"
    R"( scan and bind one after another, each
through memory; <em>fused</em>: all four in one pass. Unless said otherwise two clips are blended in each character, )"
    R"(and a skin matrix has 48 bytes. Each is first compared with
the double-precision reference: <em>error</em> is the largest difference, as a fraction of the character's size. )"
    R"(Then all take turns with the floors, A B C A B C …; given
are the median, and the 5th and 95th percentile, of times by timestamps on the device. On a software device whose )"
    R"(timestamps span less than half of the time that the host
waited, the host's time counts instead; the last column says in how many rounds.</p>
<p><em>fill</em> is a kernel that writes as many bytes as the skin matrices have and computes nothing; <em>× )"
    R"(fill</em> is an update's time over that. <em>copy as staged</em> moves the
bytes that the staged update moves between its stages, and computes nothing. <em>MB moved</em> is predicted from the )"
    R"(sizes of what passes through memory for each character;
keys and tables, which all characters share, are not counted. Bars are logarithmic.</p>
)";

}  // namespace

std::string frame_section(std::span<const Json> records, PageFigures& page) {
    const Cells cells = latest_cells(records, "frame", "variant",
                                     {"device", "driver", "configuration", "characters", "joints", "levels"});
    std::string html;
    for (const Cells& device : grouped(cells, {"device", "driver"})) html += updates_section(device, page);
    return html.empty() ? html : html + kMethod;
}

}  // namespace throng::bench
