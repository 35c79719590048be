// JSON with its place: every reader of the importer looks at the file through this, so that each message says where.
#pragma once

#include "import/limits.h"

#include <throng/asset.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace throng::gltf {

using Json = nlohmann::json;

// `text` from a file, made fit for a message of one line: control characters become '?', and what is longer than
// `limit` bytes is cut.
std::string printable(std::string_view text, size_t limit = 60);

// Parses the JSON of a file. Fails with kInvalidFile, and with kLimit where it is larger or deeper than the limits.
Json parse_json(std::string_view text, Budget& budget);

// A value of the file and its place, such as `animations[2].channels[5]`. The Json must outlive the view.
// The getters fail with kInvalidFile at the value's place; an `optional_` getter only where the value is there but
// wrong.
class JsonView {
public:
    JsonView(const Json& json, std::string place) : json_(&json), place_(std::move(place)) {}

    const std::string& place() const { return place_; }
    std::string place_of(const char* key) const;
    [[noreturn]] void fail(std::string message, ErrorCode code = ErrorCode::kInvalidFile) const;

    // Of an object.
    bool has(const char* key) const;
    std::optional<JsonView> find(const char* key) const;
    std::optional<JsonView> optional_object(const char* key) const;
    JsonView required_object(const char* key) const;
    JsonView optional_array(const char* key) const;  // empty where absent
    JsonView required_array(const char* key) const;
    uint64_t required_uint(const char* key) const;  // below 2^53
    uint64_t optional_uint(const char* key, uint64_t otherwise) const;
    // An index into the file's array `of`, which has `count` entries.
    uint32_t required_index(const char* key, size_t count, const char* of) const;
    uint32_t optional_index(const char* key, size_t count, const char* of) const;  // kNone where absent
    double optional_number(const char* key, double otherwise) const;               // fits a float
    bool optional_numbers(const char* key, std::span<double> out) const;  // false where absent; each fits a float
    bool optional_bool(const char* key, bool otherwise) const;
    const std::string& required_string(const char* key) const;
    const std::string* optional_string(const char* key) const;
    // `extensions.<name>` of this object.
    std::optional<JsonView> extension(const char* name) const;

    // Of an array.
    size_t size() const;
    JsonView operator[](size_t index) const;

    // Of the value itself.
    bool is_string() const;
    bool is_array() const;
    bool is_object() const;
    const std::string& as_string() const;
    const JsonView& as_object() const;
    uint64_t as_uint() const;
    uint32_t as_index(size_t count, const char* of) const;
    double as_number() const;

    // The keys of an object.
    std::vector<std::string> keys() const;

private:
    JsonView required(const char* key) const;

    const Json* json_;
    std::string place_;
};

}  // namespace throng::gltf
