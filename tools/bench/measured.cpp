#include "tools/bench/measured.h"

#include "base/text.h"
#include "bench/report/gnuplot.h"
#include "bench/scan_report.h"
#include "bench/updates.h"
#include "tools/cli/command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <thread>

namespace throng::tools {

Option add_samples_option(Command command, uint32_t& samples, const std::string& description) {
    return command.add_option("--samples", samples, description).check(range(1u, 100'000u)).capture_default_str();
}

void add_json_flag(Command command, bool& json) {
    command.add_flag("--json", json, "one JSON record per line; its commit is taken from THRONG_COMMIT");
}

void add_json_file_option(Command command, std::string& file) {
    command.add_option("--json", file, "a file for the records, one per line; their commit is taken from THRONG_COMMIT")
        .check(writable_file());
}

void add_report_option(Command command, std::string& file) {
    command.add_option("--report", file, "a file for the report, one HTML page").check(writable_file());
}

void add_isa_option(Command command, std::string& isa) {
    command.add_option("--isa", isa, "instruction set: sse2, avx2, avx-512, neon or all").capture_default_str();
}

std::vector<NativeIsa> chosen_isas(const std::string& isa) {
    std::vector<NativeIsa> chosen;
    std::string known;
    for (const NativeIsa one : native_isas()) {
        const std::string name = ascii_lower(std::string(name_of(one)));
        known += (known.empty() ? "" : ", ") + name;
        if (isa == "all" || isa == name) chosen.insert(chosen.begin(), one);
    }
    if (chosen.empty()) throw UsageError("--isa: this machine has no '" + isa + "'; it has: " + known);
    return chosen;
}

void add_threads_option(Command command, std::vector<uint32_t>& threads) {
    command.add_option("--threads", threads, "numbers of threads, comma-separated (default: all, and one)")
        .delimiter(',')
        .check(range(1u, 1024u));
}

std::vector<uint32_t> or_all_and_one(std::vector<uint32_t> threads) {
    if (!threads.empty()) return threads;
    const uint32_t all = std::max(1u, std::thread::hardware_concurrency());
    return all > 1 ? std::vector{all, 1u} : std::vector{1u};
}

void write_text(const std::string& path, const std::string& text) { write_file(path, std::as_bytes(std::span(text))); }

void check_report(const std::string& file) {
    if (!file.empty()) bench::run_gnuplot("");
}

void Measured::add(std::span<const Json> records, const std::function<void()>& print) {
    print_progress("");
    if (as_json_)
        for (const Json& record : records) print_json(record);
    else
        print();
    std::fflush(stdout);
    all_.insert(all_.end(), records.begin(), records.end());
}

std::string Measured::lines() const {
    std::string lines;
    for (const Json& record : all_) lines += record.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    return lines;
}

void Measured::finish(const std::string& report, const std::string& what) const {
    if (!report.empty()) write_text(report, bench::scan_report(all_));
    if (std::ranges::any_of(all_, [](const Json& record) { return record.contains("wrong"); }))
        throw CommandError(what + " is wrong");
}

void check_error(const std::string& name, double error) {
    if (!(error <= bench::kSkinErrorBound))
        throw CommandError(name + ": wrong result (error " + std::to_string(error) + " of the size); not timed");
}

double real(const Json& record, const std::string& field) {
    const double value = bench::number(record, field);
    return std::isnan(value) ? 0 : value;
}

void print_columns(const Json& record, std::initializer_list<Column> columns) {
    for (const Column& column : columns) std::printf(column.format, column.scale * real(record, column.field));
}

bool print_untimed(const Json& record, const char* not_done, const std::string& off, const std::string& field) {
    if (record.contains("unsupported_reason"))
        std::printf("%s: %s\n", not_done, text(record, "unsupported_reason").c_str());
    else if (record.contains("wrong") && record.contains("found"))
        std::printf("WRONG, not timed: there are %.0f characters, not %.0f\n", real(record, "found"),
                    real(record, "characters"));
    else if (record.contains("wrong") && record.contains(field) && std::isnan(bench::number(record, field)))
        std::printf("WRONG, not timed: a number is missing or not finite\n");
    else if (record.contains("wrong") && record.contains(field))
        std::printf("WRONG, not timed: %s%s\n", record[field].dump().c_str(), off.c_str());
    else if (record.contains("wrong"))
        std::printf("WRONG, not timed\n");
    else
        return false;
    return true;
}

}  // namespace throng::tools
