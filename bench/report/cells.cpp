#include "bench/report/cells.h"

#include "scan/scan_table.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng::bench {
namespace {

std::string key(const Json& record, const std::vector<const char*>& fields) {
    std::string all;
    for (const char* field : fields) all += (record.contains(field) ? record[field].dump() : "") + '\n';
    return all;
}

const Json* smallest(const Cells& cells, const char* quantity) {
    const Json* best = nullptr;
    for (const Json* cell : cells)
        if (const double value = number(*cell, quantity);
            !std::isnan(value) && (!best || value < number(*best, quantity)))
            best = cell;
    return best;
}

}  // namespace

LineStyle scan_style(const std::string& method) {
    if (method == kPlanner) return {{"#1f2328", "#f0f6fc"}, 0.9, "(1,3)", 6, 1.05};
    const ScanMethod* row = find_scan_method(method);
    return row ? row->style : LineStyle{};
}

uint32_t scan_rank(const std::string& method) {
    if (method == kPlanner) return UINT32_MAX;
    const ScanMethod* row = find_scan_method(method);
    return row ? row->rank : ScanMethod{}.rank;
}

Cells latest_cells(std::span<const Json> records, const char* bench, const char* name,
                   std::vector<const char*> fields) {
    fields.push_back(name);
    std::map<std::string, size_t> places;
    Cells cells;
    for (const Json& record : records) {
        if (text(record, "bench") != bench || text(record, name).empty()) continue;
        const auto [place, is_new] = places.try_emplace(key(record, fields), cells.size());
        if (is_new)
            cells.push_back(&record);
        else
            cells[place->second] = &record;
    }
    return cells;
}

Cells scan_cells(std::span<const Json> records) {
    return latest_cells(
        records, "scan", "method",
        {"device", "driver", "experiment", "threads", "shape", "seed", "characters", "joints", "levels"});
}

Cells having(const Cells& cells, const char* field, const std::string& value) {
    Cells some;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(some),
                 [&](const Json* cell) { return text(*cell, field) == value; });
    return some;
}

std::vector<Cells> grouped(const Cells& cells, const std::vector<const char*>& fields) {
    std::map<std::string, size_t> places;
    std::vector<Cells> groups;
    for (const Json* cell : cells) {
        const auto [place, is_new] = places.try_emplace(key(*cell, fields), groups.size());
        if (is_new) groups.emplace_back();
        groups[place->second].push_back(cell);
    }
    return groups;
}

std::map<double, Cells> by_number(const Cells& cells, const char* field) {
    std::map<double, Cells> at;
    for (const Json* cell : cells) at[number(*cell, field)].push_back(cell);
    return at;
}

Cells by_rank(Cells cells) {
    std::ranges::stable_sort(cells, {}, [](const Json* cell) { return scan_rank(text(*cell, "method")); });
    return cells;
}

std::vector<std::string> texts(const Cells& cells, const char* field) {
    std::vector<std::string> all;
    for (const Json* cell : cells)
        if (const std::string value = text(*cell, field);
            !value.empty() && std::find(all.begin(), all.end(), value) == all.end())
            all.push_back(value);
    return all;
}

std::set<double> numbers(const Cells& cells, const char* field) {
    std::set<double> all;
    for (const Json* cell : cells)
        if (const double value = number(*cell, field); !std::isnan(value)) all.insert(value);
    return all;
}

Best best_over(const Cells& cells, const char* field, const char* quantity) {
    Best best;
    for (const Cells& same : grouped(cells, {field}))
        if (const Json* cell = smallest(same, quantity);
            cell && !std::isnan(number(*cell, field)) && !flag(*cell, "wrong"))
            best[number(*cell, field)] = cell;
    return best;
}

const Json* fastest(const Cells& cells) {
    Cells chosen;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(chosen),
                 [](const Json* cell) { return text(*cell, "method") != kPlanner && !flag(*cell, "wrong"); });
    return smallest(chosen, "median_ms");
}

const Json* planned(const Cells& cells) { return smallest(having(cells, "method", kPlanner), "median_ms"); }

double geometric_mean_ratio(const Best& first, const Best& second, const char* quantity) {
    double sum = 0;
    int count = 0;
    for (const auto& [x, cell] : first)
        if (const auto other = second.find(x); other != second.end()) {
            sum += std::log(number(*cell, quantity) / number(*other->second, quantity));
            ++count;
        }
    return count ? std::exp(sum / count) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace throng::bench
