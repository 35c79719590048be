// JSON that people write: each value knows its line, members keep their order, and no key stands twice.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

inline constexpr size_t kJsonTextLimit_bytes = size_t{4} << 20;
inline constexpr const char* kJsonTextLimitMessage = "is larger than the limit of 4 MiB";
inline constexpr size_t kJsonNestingLimit = 32;
inline constexpr size_t kJsonValueLimit = 500'000;

struct JsonNode {
    enum class Kind { kNull, kBool, kNumber, kString, kArray, kObject };
    Kind kind = Kind::kNull;
    bool truth = false;
    uint32_t line = 0;  // from 1: where the value begins; of a member, its key
    double number = 0;
    std::string key;   // of a member of an object
    std::string text;  // of a string
    std::vector<JsonNode> children;
};

// Throws kInvalidFile or kLimit, at `file` and line.
JsonNode parse_json_lines(std::string_view text, const std::string& file);

// The place of a member or an element of `place`: `layers`, `layers[0].states.move`, `masks["left arm"]`.
std::string place_of(const std::string& place, std::string_view key);
std::string place_of(const std::string& place, size_t index);

// The line of what is at the place, or of the innermost value around it that is there.
uint32_t line_of(const JsonNode& root, std::string_view place);

// "guard.json:12: layers[0].name"
std::string located(const std::string& file, uint32_t line, const std::string& place);

}  // namespace throng
