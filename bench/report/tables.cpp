#include "bench/report/tables.h"

#include "bench/report/html.h"

#include <algorithm>
#include <cmath>

namespace throng::bench {
namespace {

constexpr double kNearFastest = 1.05;

std::string bold(const std::string& content, bool is_best) { return is_best ? "<b>" + content + "</b>" : content; }
std::string td(const std::string& content, bool is_note = false) {
    return (is_note ? "<td class=\"note\">" : "<td>") + content + "</td>";
}
std::string th(std::string_view name, bool is_note = false) {
    return (is_note ? "<th class=\"note\">" : "<th>") + std::string(name) + "</th>";
}
std::string table(const std::string& head, const std::string& rows) {
    return rows.empty() ? ""
                        : "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>\n" + rows +
                              "</tbody></table></div>\n";
}

double least(const Cells& cells, const char* field) {
    const std::set<double> all = numbers(cells, field);
    return all.empty() ? std::nan("") : *all.begin();
}

bool is_planners(const Json& cell) { return text(cell, "method") == kPlanner; }

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

Column numbers_of(std::string_view head, const char* field, Shown shown, std::function<bool(const Json&)> best) {
    return {head, [=](const Json& cell) { return bold(shown(number(cell, field)), best && best(cell)); }};
}

Column spread_of_times(const char* low, const char* high) {
    return {"p5–p95", [=](const Json& cell) {
                return "<small>" + digits(number(cell, low)) + "–" + digits(number(cell, high)) + "</small>";
            }};
}

std::string record_table(const Cells& cells, const std::vector<Column>& columns, size_t named_by, const char* time,
                         std::string_view not_done) {
    std::string head, rows;
    for (const Column& column : columns) head += th(column.head, column.is_note);
    for (const Json* cell : cells) {
        const bool is_wrong = flag(*cell, "wrong"), is_timed = !std::isnan(number(*cell, time)) && !is_wrong;
        rows += "<tr>";
        for (size_t i = 0; i < (is_timed ? columns.size() : named_by); ++i)
            rows += td(columns[i].cell(*cell), columns[i].is_note);
        if (!is_timed && named_by < columns.size()) {
            const std::string reason = text(*cell, "unsupported_reason");
            rows += "<td class=\"note\" colspan=\"" + std::to_string(columns.size() - named_by) + "\">" +
                    (is_wrong         ? "<span class=\"bad\">wrong result, not timed</span>"
                     : reason.empty() ? "not timed"
                                      : std::string(not_done) + ": " + escape(reason)) +
                    "</td>";
        }
        rows += "</tr>\n";
    }
    return table(head, rows);
}

std::string case_table(const Cells& cells) {
    const Json* winner = fastest(cells);
    const auto is_fastest = [=](const Json& cell) {
        return winner && !is_planners(cell) && number(cell, "median_ms") == number(*winner, "median_ms");
    };
    const auto counts = [&](std::string_view head, const char* field) {
        return numbers_of(head, field, whole, [field, best = least(cells, field)](const Json& cell) {
            return !is_planners(cell) && number(cell, field) == best;
        });
    };
    return record_table(by_rank(cells),
                        {{"method",
                          [](const Json& cell) {
                              const std::string chosen = text(cell, "chosen");
                              return method_name(text(cell, "method")) +
                                     (chosen.empty() ? "" : " <small>→ " + escape(chosen) + "</small>");
                          }},
                         {"threads",
                          [](const Json& cell) {
                              const double threads = number(cell, "threads");
                              return threads > 0 ? whole(threads) : "–";
                          }},
                         numbers_of("ms", "median_ms", digits, is_fastest),
                         spread_of_times("p5_ms", "p95_ms"),
                         numbers_of("× copy", "times_copy", digits, is_fastest),
                         counts("multipli&shy;cations", "multiplications"),
                         counts("longest<br>thread", "longest_thread"),
                         numbers_of("barriers", "barriers", whole),
                         numbers_of("shared<br>bytes", "shared_bytes", size),
                         numbers_of("error", "max_error", digits)},
                        2, "median_ms", "does not apply");
}

std::string matrix_table(const Cells& cells, const char* field, std::string_view field_name, const char* quantity) {
    const std::set<double> columns = numbers(cells, field);
    std::string head = th(field_name), rows;
    for (const double column : columns) head += th(whole(column));
    std::map<double, double> least_of;
    for (const auto& [x, cell] : best_over(cells, field, quantity)) least_of[x] = number(*cell, quantity);
    for (const Cells& method : grouped(by_rank(cells), {"method"})) {
        const Best best = best_over(method, field, quantity);
        rows += "<tr>" + td(method_name(text(*method.front(), "method")));
        for (const double column : columns) {
            const auto found = best.find(column);
            const double value = found == best.end() ? std::nan("") : number(*found->second, quantity);
            rows += td(bold(digits(value), value == least_of[column]));
        }
        rows += "</tr>\n";
    }
    return table(head, rows);
}

std::string on_chip_table(const Cells& cells) {
    Cells ordered;
    std::map<double, double> min_ns;  // of a number of levels
    for (const Cells& level : grouped(cells, {"levels"})) {
        min_ns[number(*level.front(), "levels")] = least(level, "on_chip_ns_per_joint");
        for (const Json* cell : by_rank(level)) ordered.push_back(cell);
    }
    const auto is_fastest = [&](const Json& cell) {
        return number(cell, "on_chip_ns_per_joint") == min_ns[number(cell, "levels")];
    };
    return record_table(ordered,
                        {{"method", [](const Json& cell) { return method_name(text(cell, "method")); }},
                         numbers_of("levels", "levels", whole),
                         numbers_of("joints", "joints", whole),
                         numbers_of("workgroup", "workgroup_size", whole),
                         numbers_of("ns a joint", "on_chip_ns_per_joint", digits, is_fastest),
                         spread_of_times("on_chip_p5", "on_chip_p95"),
                         numbers_of("barriers", "barrier_share", percent)},
                        4, "on_chip_ns_per_joint", "does not apply");
}

std::string grid_table(const Cells& cells) {
    const std::set<double> levels = numbers(cells, "levels");
    std::string head = th("characters × joints"), rows;
    for (const double level : levels) head += "<th class=\"cell\">" + whole(level) + " levels</th>";
    int compared = 0, near = 0;
    for (const Cells& line : grouped(cells, {"characters", "joints"})) {
        rows += "<tr>" +
                td(whole(number(*line.front(), "characters")) + " × " + whole(number(*line.front(), "joints")));
        std::map<double, Cells> at = by_number(line, "levels");
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
    Cells cells;
    for (const Json& record : records)
        if (text(record, "bench") == "baseline") cells.push_back(&record);
    return record_table(cells,
                        {{"character", [](const Json& record) { return escape(text(record, "file")); }},
                         {"method", [](const Json& record) { return escape(text(record, "method")); }},
                         numbers_of("ms", "median_ms", digits),
                         spread_of_times("p5_ms", "p95_ms"),
                         numbers_of("bytes<br>a clip", "bytes_per_clip", size),
                         numbers_of("one clip:<br>largest, mm", "sample_error_mm_max", digits),
                         numbers_of("two blended:<br>median, mm", "blend_error_mm_median", digits),
                         numbers_of("p95, mm", "blend_error_mm_p95", digits),
                         numbers_of("largest, mm", "blend_error_mm_max", digits)},
                        9, "median_ms", "");
}

}  // namespace throng::bench
