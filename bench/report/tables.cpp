#include "bench/report/tables.h"

#include "bench/report/html.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace throng::bench {
namespace {

constexpr double kNearFastest = 1.05;

std::string td(const std::string& content) { return "<td>" + content + "</td>"; }
std::string best_td(const std::string& content, bool best) { return td(best ? "<b>" + content + "</b>" : content); }
std::string spread_td(const Json& cell, const char* low = "p5_ms", const char* high = "p95_ms") {
    return td("<small>" + digits(number(cell, low)) + "–" + digits(number(cell, high)) + "</small>");
}
std::string table(const std::string& head, const std::string& rows) {
    return rows.empty() ? ""
                        : "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>\n" + rows +
                              "</tbody></table></div>\n";
}
std::string heads(std::initializer_list<std::string_view> names) {
    std::string all;
    for (const std::string_view name : names) all += "<th>" + std::string(name) + "</th>";
    return all;
}

Cells by_rank(Cells cells) {
    std::stable_sort(cells.begin(), cells.end(), [](const Json* a, const Json* b) {
        return scan_rank(text(*a, "method")) < scan_rank(text(*b, "method"));
    });
    return cells;
}

double least(const Cells& cells, const char* field) {
    const std::set<double> all = numbers(cells, field);
    return all.empty() ? std::nan("") : *all.begin();
}

// An obstacle or a wrong result stands where the times would.
std::string why_untimed(const Json& cell) {
    if (flag(cell, "wrong")) return "<span class=\"bad\">wrong result, not timed</span>";
    const std::string unsupported_reason = text(cell, "unsupported_reason");
    return unsupported_reason.empty() ? "not timed" : "does not apply: " + escape(unsupported_reason);
}

std::string percent(double share) { return std::isnan(share) ? "–" : whole(100 * share) + " %"; }

std::string size(double bytes) {
    if (std::isnan(bytes)) return "–";
    if (bytes < 1024) return whole(bytes);
    return bytes < 1024.0 * 1024 ? digits(bytes / 1024) + " Ki" : digits(bytes / 1024 / 1024) + " Mi";
}

}  // namespace

std::string swatch(const Ink& ink) {
    return std::string("<span class=\"swatch\" style=\"--light:") + ink.light + ";--dark:" + ink.dark + "\"></span>";
}

std::string method_name(const std::string& method) { return swatch(scan_style(method).ink) + escape(method); }

std::string case_table(const Cells& cells) {
    const auto is = [&](const Json& cell, const char* field) {
        return text(cell, "method") != kPlanner && number(cell, field) == least(cells, field);
    };
    const double best_ms = fastest(cells) ? number(*fastest(cells), "median_ms") : 0;
    std::string rows;
    for (const Json* pointer : by_rank(cells)) {
        const Json& cell = *pointer;
        const std::string chosen = text(cell, "chosen");
        const double threads = number(cell, "threads"), ms = number(cell, "median_ms");
        const bool best = ms == best_ms && text(cell, "method") != kPlanner;
        rows += "<tr>" +
                td(method_name(text(cell, "method")) +
                   (chosen.empty() ? "" : " <small>→ " + escape(chosen) + "</small>")) +
                td(threads > 0 ? whole(threads) : "–");
        if (std::isnan(ms) || flag(cell, "wrong")) {
            rows += "<td class=\"note\" colspan=\"8\">" + why_untimed(cell) + "</td></tr>\n";
            continue;
        }
        rows += best_td(digits(ms), best) + spread_td(cell) + best_td(digits(number(cell, "times_copy")), best) +
                best_td(whole(number(cell, "multiplications")), is(cell, "multiplications")) +
                best_td(whole(number(cell, "longest_thread")), is(cell, "longest_thread")) +
                td(whole(number(cell, "barriers"))) + td(size(number(cell, "shared_bytes"))) +
                td(digits(number(cell, "max_error"))) + "</tr>\n";
    }
    return table(heads({"method", "threads", "ms", "p5–p95", "× copy", "multipli&shy;cations", "longest<br>thread",
                        "barriers", "shared<br>bytes", "error"}),
                 rows);
}

std::string matrix_table(const Cells& cells, const char* field, std::string_view field_name, const char* quantity) {
    const std::set<double> columns = numbers(cells, field);
    std::string head = "<th>" + std::string(field_name) + "</th>", rows;
    for (const double column : columns) head += "<th>" + whole(column) + "</th>";
    std::map<double, double> least_of;
    for (const auto& [x, cell] : best_over(cells, field, quantity)) least_of[x] = number(*cell, quantity);
    for (const Cells& method : grouped(by_rank(cells), {"method"})) {
        const Best best = best_over(method, field, quantity);
        rows += "<tr>" + td(method_name(text(*method.front(), "method")));
        for (const double column : columns) {
            const auto found = best.find(column);
            const double value = found == best.end() ? std::nan("") : number(*found->second, quantity);
            rows += best_td(digits(value), value == least_of[column]);
        }
        rows += "</tr>\n";
    }
    return table(head, rows);
}

std::string on_chip_table(const Cells& cells) {
    std::string rows;
    for (const Cells& level : grouped(cells, {"levels"})) {
        const double least_ns = least(level, "on_chip_ns_per_joint");
        for (const Json* pointer : by_rank(level)) {
            const Json& cell = *pointer;
            const double ns = number(cell, "on_chip_ns_per_joint"), share = number(cell, "barrier_share");
            rows += "<tr>" + td(method_name(text(cell, "method"))) + td(whole(number(cell, "levels"))) +
                    td(whole(number(cell, "joints"))) + td(whole(number(cell, "workgroup_size")));
            if (std::isnan(ns)) {
                rows += "<td class=\"note\" colspan=\"3\">" + why_untimed(cell) + "</td></tr>\n";
                continue;
            }
            rows += best_td(digits(ns), ns == least_ns) + spread_td(cell, "on_chip_p5", "on_chip_p95") +
                    td(percent(share)) + "</tr>\n";
        }
    }
    return table(heads({"method", "levels", "joints", "workgroup", "ns a joint", "p5–p95", "barriers"}), rows);
}

std::string grid_table(const Cells& cells) {
    const std::set<double> levels = numbers(cells, "levels");
    std::string head = heads({"characters × joints"}), rows;
    for (const double level : levels) head += "<th class=\"cell\">" + whole(level) + " levels</th>";
    int compared = 0, near = 0;
    for (const Cells& line : grouped(cells, {"characters", "joints"})) {
        rows += "<tr>" +
                td(whole(number(*line.front(), "characters")) + " × " + whole(number(*line.front(), "joints")));
        std::map<double, Cells> at;
        for (const Json* cell : line) at[number(*cell, "levels")].push_back(cell);
        for (const double level : levels) {
            const Json *best = fastest(at[level]), *plan = planned(at[level]);
            if (!best) {
                rows += "<td class=\"cell\">–</td>";
                continue;
            }
            rows += "<td class=\"cell\">" + method_name(text(*best, "method")) + "<br><small>" +
                    digits(number(*best, "median_ms")) + " ms";
            if (plan) {
                const double ratio = number(*plan, "median_ms") / number(*best, "median_ms");
                const bool is_near = ratio <= kNearFastest, same = text(*plan, "chosen") == text(*best, "method");
                ++compared;
                near += is_near;
                rows += std::string(" · <span") + (is_near ? "" : " class=\"bad\"") + ">auto" +
                        (same ? "" : " (" + escape(text(*plan, "chosen")) + ")") + " " + digits(ratio) + " ×</span>";
            }
            rows += "</small></td>";
        }
        rows += "</tr>\n";
    }
    const std::string sentence = compared
                                     ? "<p>The planner's choice is within 5 % of the fastest in " +
                                           std::to_string(near) + " of " + std::to_string(compared) + " cells.</p>\n"
                                     : "";
    return sentence + table(head, rows);
}

std::string baseline_table(std::span<const Json> records) {
    std::string rows;
    for (const Json& record : records) {
        if (text(record, "bench") != "baseline") continue;
        rows += "<tr>" + td(escape(text(record, "file"))) + td(escape(text(record, "method"))) +
                td(digits(number(record, "median_ms"))) + spread_td(record) +
                td(size(number(record, "bytes_per_clip"))) + td(digits(number(record, "sample_error_mm_max"))) +
                td(digits(number(record, "blend_error_mm_median"))) + td(digits(number(record, "blend_error_mm_p95"))) +
                td(digits(number(record, "blend_error_mm_max"))) + "</tr>\n";
    }
    return table(heads({"character", "method", "ms", "p5–p95", "bytes<br>a clip", "one clip:<br>largest, mm",
                        "two blended:<br>median, mm", "p95, mm", "largest, mm"}),
                 rows);
}

}  // namespace throng::bench
