// Benchmark records: JSON objects, one a line, whose fields may be missing. bench/README.md lists them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace throng::bench {

using Json = nlohmann::json;

// Throws kFile, or kInvalidFile naming file and line where a line is not a JSON object. Empty lines are left out.
std::vector<Json> read_records(const std::filesystem::path& path);

// NaN where the field is missing or not a finite number.
double number(const Json& record, const char* field);
// Empty where the field is missing or not a text.
std::string text(const Json& record, const char* field);
bool flag(const Json& record, const char* field);

}  // namespace throng::bench
