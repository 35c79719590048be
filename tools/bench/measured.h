// What the benchmark commands share: options, what is done with their records, and how tables show them.
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

// --isa: an instruction set, or "all". chosen_isas() returns the fastest first, and throws UsageError if this machine
// lacks the set.
void add_isa_option(Command command, std::string& isa);
std::vector<NativeIsa> chosen_isas(const std::string& isa);
// --threads; or_all_and_one() adds its default: all processors, and one.
void add_threads_option(Command command, std::vector<uint32_t>& threads);
std::vector<uint32_t> or_all_and_one(std::vector<uint32_t> threads);

// Throws if --report needs gnuplot and it is missing, so that this is known before minutes of work.
void check_report(const std::string& file);

// The records of a run.
class Measured {
public:
    explicit Measured(bool as_json = false) : as_json_(as_json) {}

    // Keeps them, and prints them: as JSON, or as `print` does.
    void add(std::span<const Json> records, const std::function<void()>& print);

    const std::vector<Json>& all() const { return all_; }
    std::string lines() const;
    // Writes the report if a file is named. Throws if a record is marked wrong, with the message "`what` is wrong".
    void finish(const std::string& report, const std::string& what) const;

private:
    bool as_json_;
    std::vector<Json> all_;
};

// Throws if the error, a fraction of the character's size, is larger than rounding explains.
void check_error(const std::string& name, double error);

// 0 where the field is missing or no number.
double real(const Json& record, const std::string& field);

struct Column {
    const char *format, *field;  // printf's, of a number
    double scale = 1;
};
void print_columns(const Json& record, std::initializer_list<Column> columns);

// Returns whether a record has no times, and prints why. If the method does not apply, that is `not_done` and the
// reason. If the result is wrong, it is the number of characters where "found" differs from "characters"; otherwise the
// error that `field` names, if the record has it, with `off` after the number if that is finite.
bool print_untimed(const Json& record, const char* not_done, const std::string& off = " of the size off",
                   const std::string& field = "max_error");

}  // namespace throng::tools
