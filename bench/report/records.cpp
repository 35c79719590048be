#include "bench/report/records.h"

#include "base/failure.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <limits>

namespace throng::bench {

std::vector<Json> read_records(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<Json> records;
    std::string line;
    for (size_t number = 1; std::getline(file, line); ++number) {
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        records.push_back(Json::parse(line, nullptr, false));
        if (!records.back().is_object())
            throw Failure(ErrorCode::kInvalidFile, path.string() + ":" + std::to_string(number), "not a JSON object");
    }
    if (!file.eof()) throw Failure(ErrorCode::kFile, path.string(), "cannot be read");
    return records;
}

double number(const Json& record, const char* field) {
    const auto found = record.find(field);
    const double value = found != record.end() && found->is_number() ? found->get<double>()
                                                                     : std::numeric_limits<double>::quiet_NaN();
    return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
}

std::string text(const Json& record, const char* field) {
    const auto found = record.find(field);
    return found != record.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool flag(const Json& record, const char* field) {
    const auto found = record.find(field);
    return found != record.end() && found->is_boolean() && found->get<bool>();
}

}  // namespace throng::bench
