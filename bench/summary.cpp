#include "bench/summary.h"

#include "bench/report/html.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <ranges>
#include <sstream>
#include <string_view>

namespace throng::bench {
namespace {

bool has_digit(const std::string& word) {
    return std::ranges::any_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

std::vector<std::string> words_of(const std::string& text) {
    std::istringstream stream(text);
    return {std::istream_iterator<std::string>(stream), {}};
}

// Words that turn a model number into another device, as in "RTX 3080 Ti".
constexpr std::array<std::string_view, 7> kModelSuffixes{"XT", "XTX", "GRE", "Ti", "PCIe", "NVL", "Laptop"};

// Compares the words with digits. A machine without any, the Steam Deck, matches no device's name.
bool is_for(const Json& prediction, const Json& record) {
    const std::vector<std::string> machine = words_of(text(prediction, "machine")),
                                   device = words_of(text(record, "device"));
    bool named = false;
    for (const std::string& word : machine) {
        if (!has_digit(word)) continue;
        const auto found = std::ranges::find(device, word);
        if (found == device.end()) return false;
        const auto next = found + 1;
        if (next != device.end() && std::ranges::count(kModelSuffixes, *next) > 0 &&
            std::ranges::count(machine, *next) == 0)
            return false;
        named = true;
    }
    return named;
}

// For a record of `throng bench million`, which makes its predictions itself.
double predicted_million_ms(const Json& record, std::span<const Json> predictions) {
    for (const Json& prediction : std::views::reverse(predictions))
        if (text(prediction, "bench") == "million" && text(prediction, "view") == text(record, "view") &&
            text(prediction, "configuration") == text(record, "configuration") && is_for(prediction, record))
            return number(prediction, "predicted_ms");
    return std::nan("");
}

// For a scan of `throng bench scan` with its transforms in memory, of the same skeleton. Prediction and measurement
// each use their own fastest number of threads.
double predicted_scan_ms(const Json& record, std::span<const Json> predictions) {
    for (const Json& prediction : std::views::reverse(predictions)) {
        const auto is_alike = [&](const char* field) { return number(prediction, field) == number(record, field); };
        if (text(prediction, "configuration").starts_with("scan alone") &&
            text(prediction, "scan") == text(record, "method") && text(prediction, "shape") == text(record, "shape") &&
            is_alike("characters") && is_alike("joints") && is_alike("levels") && is_alike("seed") &&
            is_for(prediction, record))
            return number(prediction, "predicted_ms");
    }
    return std::nan("");
}

// Fused updates of `throng bench frame` are predicted too, for each subgroup size; the last prediction counts.
double predicted_ms(const Json& record, std::span<const Json> predictions) {
    if (text(record, "bench") == "million") return predicted_million_ms(record, predictions);
    if (text(record, "bench") == "scan") return predicted_scan_ms(record, predictions);
    std::string kernel = text(record, "variant");
    if (text(record, "bench") != "frame" || text(record, "path") != "fused") return std::nan("");
    if (kernel == "fused") kernel = "fused, two clips";
    for (const Json& prediction : std::views::reverse(predictions))
        if (text(prediction, "kernel") == kernel &&
            text(prediction, "configuration") == text(record, "configuration") &&
            text(prediction, "scan") == text(record, "scan") &&
            number(prediction, "subgroup_size") == number(record, "subgroup_size") && is_for(prediction, record))
            return number(prediction, "predicted_ms");
    return std::nan("");
}

std::string counted(double count, const char* what) { return std::isnan(count) ? "" : whole(count) + " " + what; }

// The parts that are not empty, with commas between them.
std::string listed(std::initializer_list<std::string> parts) {
    std::string all;
    for (const std::string& part : parts)
        if (!part.empty()) all += (all.empty() ? "" : ", ") + part;
    return all;
}

// The names of the characters' files, where there is no name of the configuration.
std::string files_of(const Json& record) {
    std::string names = text(record, "file");
    for (const Json& file : record.value("files", Json::array())) names = listed({names, text(file, "name")});
    return names;
}

std::string what_of(const Json& record) {
    const std::string configuration = text(record, "configuration");
    if (!configuration.empty()) return configuration;
    const double levels = number(record, "levels"), seed = number(record, "seed");
    return listed({counted(number(record, "characters"), "characters"), counted(number(record, "joints"), "joints"),
                   counted(std::isnan(levels) ? number(record, "files/0/levels") : levels, "levels"),
                   text(record, "shape"), std::isnan(seed) ? "" : "seed " + whole(seed), files_of(record)});
}

// The first of these fields that the record has.
std::string first_of(const Json& record, std::initializer_list<const char*> fields) {
    for (const char* field : fields)
        if (const std::string found = text(record, field); !found.empty()) return found;
    return "";
}

// What tells the record from others of the same configuration, and which part of the work the time is for.
std::string variant_of(const Json& record, const char* part) {
    const std::string bench = text(record, "bench"), chosen = text(record, "chosen");
    const std::string name = first_of(record, {"variant", "method", "scan", "view", "instances", "frames_with"});
    const bool is_recording = bench == "million" && text(record, "view").empty();
    const double threads = number(record, "threads"), characters = number(record, "characters");
    return listed({name + (chosen.empty() ? "" : ": " + chosen),
                   bench == "population" || is_recording ? counted(characters, "characters") : "", text(record, "isa"),
                   threads > 0 ? counted(threads, threads > 1 ? "threads" : "thread") : "",
                   bench == "frame" ? "" : text(record, "path"),  // a frame's variants are named by it
                   part});
}

std::string note_of(const Json& record) {
    if (flag(record, "wrong")) return "wrong, not timed";
    return text(record, "unsupported_reason");
}

// Where a record has its times: "ms/median", "control_ms/median", or "total/median_ms".
struct Place {
    const char *ms, *p5, *p95, *part;
};
constexpr Place kPlaces[]{{"ms/median", "ms/p5", "ms/p95", ""},
                          {"median_ms", "p5_ms", "p95_ms", ""},
                          {"total/median_ms", "total/p5_ms", "total/p95_ms", ""},
                          {"control_ms/median", "control_ms/p5", "control_ms/p95", "the control stage"},
                          {"record_ms/median", "record_ms/p5", "record_ms/p95", "recording, the CPU's part"},
                          {"update_ms/median", "update_ms/p5", "update_ms/p95", "the whole update"}};

bool has_own_section(const std::string& bench) { return bench == "scan" || bench == "frame" || bench == "baseline"; }

std::string range_of(const MeasuredTime& time) {
    return std::isnan(time.p5_ms) ? "" : digits(time.p5_ms) + " – " + digits(time.p95_ms);
}

// A table for each benchmark.
std::string tables_of(std::span<const MeasuredTime> times, bool predicted) {
    std::string text, bench;
    for (const MeasuredTime& time : times) {
        if (time.bench != bench) {
            bench = time.bench;
            text += "\n### " + bench + "\n\n| what | variant | ms | 5 % – 95 % |" +
                    (predicted ? " predicted, ms | measured / predicted |" : "") + "\n|---|---|---|---|" +
                    (predicted ? "---|---|" : "") + "\n";
        }
        text += "| " + time.what + " | " + time.variant + " | " + (time.note.empty() ? digits(time.ms) : time.note) +
                " | " + range_of(time) + " |";
        if (predicted) text += " " + digits(time.predicted_ms) + " | " + digits(time.ms / time.predicted_ms) + " |";
        text += "\n";
    }
    return text;
}

}  // namespace

std::vector<MeasuredTime> measured_times(std::span<const Json> records, std::span<const Json> predictions) {
    std::vector<MeasuredTime> times;
    for (const Json& record : records) {
        const std::string bench = text(record, "bench");
        if (bench.empty() || !is_measured(record) || (bench == "scan" && text(record, "experiment") != "levels"))
            continue;
        MeasuredTime time{.device = text(record, "device"),
                          .bench = bench,
                          .what = what_of(record),
                          .variant = variant_of(record, "")};
        bool has_time = false;
        for (const Place& place : kPlaces) {
            time.ms = number(record, place.ms);
            if (std::isnan(time.ms)) continue;
            time.p5_ms = number(record, place.p5);
            time.p95_ms = number(record, place.p95);
            time.variant = variant_of(record, place.part);
            time.predicted_ms = predicted_ms(record, predictions);
            times.push_back(time);
            has_time = true;
        }
        time.note = note_of(record);
        if (!has_time && !time.note.empty()) times.push_back(time);
    }
    return times;
}

std::string summary_text(std::span<const Json> records, std::span<const Json> predictions) {
    std::vector<MeasuredTime> times = measured_times(records, predictions);
    const bool predicted = std::ranges::any_of(times,
                                               [](const MeasuredTime& time) { return !std::isnan(time.predicted_ms); });
    std::string text;
    if (predictions.empty())
        text += "Nothing was predicted: no records of `throng bench isa` were given.\n";
    else if (!predicted)
        text += "None of the predictions is for this device.\n";
    while (!times.empty()) {
        const std::string device = times.front().device;
        const auto others = std::ranges::stable_partition(times,
                                                          [&](const auto& time) { return time.device == device; });
        text += "\n## " + (device.empty() ? "Unnamed device" : device) + "\n" +
                tables_of({times.begin(), others.begin()}, predicted);
        times.erase(times.begin(), others.begin());
    }
    return text;
}

std::string summary_section(std::span<const Json> records) {
    std::string rows;
    for (const MeasuredTime& time : measured_times(records, {})) {
        if (has_own_section(time.bench)) continue;
        rows += "<tr><td>" + escape(time.device) + "</td><td class=\"wide\">" + escape(time.bench) +
                "</td><td class=\"wide\">" + escape(time.what) + "</td><td class=\"wide\">" + escape(time.variant) +
                "</td><td>" + digits(time.ms) + "</td><td>" + range_of(time) + "</td><td class=\"note\">" +
                escape(time.note) + "</td></tr>\n";
    }
    return rows.empty() ? ""
                        : "<h2>Other benchmarks</h2>\n<div class=\"scroll\"><table><thead><tr><th>device</th>"
                          "<th class=\"wide\">benchmark</th>"
                          "<th class=\"wide\">what</th><th class=\"wide\">variant</th><th>ms</th><th>5 % – 95 %</th>"
                          "<th></th></tr></thead><tbody>\n" +
                              rows + "</tbody></table></div>\n";
}

}  // namespace throng::bench
