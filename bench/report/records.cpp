#include "bench/report/records.h"

#include "base/failure.h"

#include <cmath>
#include <fstream>

namespace throng::bench {
namespace {

// Null where it is missing.
Json value_at(const Json& record, const std::string& field) {
    const Json::json_pointer place("/" + field);
    return record.contains(place) ? record.at(place) : Json();
}

}  // namespace

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

std::vector<Json> read_records(std::span<const std::string> paths) {
    std::vector<Json> records;
    for (const std::string& path : paths)
        for (Json& record : read_records(path)) records.push_back(std::move(record));
    return records;
}

double number(const Json& record, const std::string& field) {
    const Json found = value_at(record, field);
    const double value = found.is_number() ? found.get<double>() : std::nan("");
    return std::isfinite(value) ? value : std::nan("");
}

std::string text(const Json& record, const std::string& field) {
    const Json found = value_at(record, field);
    return found.is_string() ? found.get<std::string>() : std::string();
}

bool flag(const Json& record, const std::string& field) { return value_at(record, field) == true; }

bool is_measured(const Json& record) { return text(record, "family").empty(); }

}  // namespace throng::bench
