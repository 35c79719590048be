// Benchmark records: JSON objects, one a line, whose fields may be missing. bench/README.md lists them.
#pragma once

#include "bench/record.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace throng::bench {

// Throws kFile, or kInvalidFile naming file and line where a line is not a JSON object. Empty lines are left out.
std::vector<Json> read_records(const std::filesystem::path& path);
// The records of all files, in the order of the files.
std::vector<Json> read_records(std::span<const std::string> paths);

// NaN where the field is missing or not a finite number. "ms/median" is a field of a field.
double number(const Json& record, const std::string& field);
// Empty where the field is missing or not a text.
std::string text(const Json& record, const std::string& field);
bool flag(const Json& record, const std::string& field);

// Whether the record was measured on the device that it names. Records of machine code, and predictions from it, have a
// family.
bool is_measured(const Json& record);

}  // namespace throng::bench
