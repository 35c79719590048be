// What the benchmarks' commands share: options, what becomes of their records, and how these stand in tables.
#pragma once

#include "bench/report/records.h"
#include "native/native.h"
#include "tools/cli/options.h"

#include <nlohmann/json.hpp>

#include <span>

namespace throng::tools {

using bench::flag;
using bench::Json;
using bench::text;

// --samples, --json and --report.
Option add_samples_option(Command command, uint32_t& samples, const std::string& description = "updates timed");
void add_json_flag(Command command, bool& json);
void add_json_file_option(Command command, std::string& file);
void add_report_option(Command command, std::string& file);

void write_text(const std::string& path, const std::string& text);

// --isa: an instruction set, or "all". Throws CommandError where this machine does not have it; else the fastest first.
void add_isa_option(Command command, std::string& isa);
std::vector<NativeIsa> chosen_isas(const std::string& isa);
// --threads, and what it is where none are given.
void add_threads_option(Command command, std::vector<uint32_t>& threads);
std::vector<uint32_t> or_all_and_one(std::vector<uint32_t> threads);

// Where --report needs gnuplot and it is missing, that is said before the minutes of work.
void check_report(const std::string& file);

// The records of a run.
class Measured {
public:
    explicit Measured(bool as_json = false) : as_json_(as_json) {}

    // Keeps them, and prints them: as JSON, or as `print` does.
    void add(std::span<const Json> records, const std::function<void()>& print);

    const std::vector<Json>& all() const { return all_; }
    std::string lines() const;
    // Writes the report, where a file is named. Throws, saying that `what` is wrong, where a record is.
    void finish(const std::string& report, const std::string& what) const;

private:
    bool as_json_;
    std::vector<Json> all_;
};

// Throws where the result is further off than rounding explains, as a fraction of the character's size.
void check_error(const std::string& name, double error);

// 0 where the field is missing or no number.
double real(const Json& record, const std::string& field);

struct Column {
    const char *format, *field;  // printf's, of a number
    double scale = 1;
};
void print_columns(const Json& record, std::initializer_list<Column> columns);

// Prints why a record has no times; returns whether it has none. `not_done` is what is said of a method that does not
// apply. `field` has how far off a wrong result is, where the record has it, and `off` is said behind its number.
bool print_untimed(const Json& record, const char* not_done, const std::string& off = " of the size off",
                   const std::string& field = "max_error");

}  // namespace throng::tools
