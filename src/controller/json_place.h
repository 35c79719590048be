// Reading JSON: each value with its place, so that each message says where.
#pragma once

#include "controller/json_lines.h"

#include <initializer_list>
#include <optional>

namespace throng {

// A value and its place. What is not as asked for throws kInvalidFile at file, line and place. The node and the file's
// name must outlive it.
class JsonPlace {
public:
    JsonPlace(const JsonNode& node, const std::string& file, std::string place = {})
        : node_(&node), file_(&file), place_(std::move(place)) {}

    [[noreturn]] void fail(const std::string& message) const;

    JsonNode::Kind kind() const { return node_->kind; }
    bool is_string() const { return node_->kind == JsonNode::Kind::kString; }
    const std::string& key() const { return node_->key; }

    const std::string& as_string() const;
    double as_number() const;  // that a float can be
    float as_float() const;
    bool as_bool() const;
    std::vector<JsonPlace> items() const;    // of an array
    std::vector<JsonPlace> members() const;  // of an object

    // Of an object. Any member but these is refused.
    void allow(std::initializer_list<std::string_view> keys) const;
    std::optional<JsonPlace> find(std::string_view key) const;
    JsonPlace required(std::string_view key) const;
    std::string string_or(std::string_view key, const char* otherwise) const;
    float float_or(std::string_view key, float otherwise) const;
    bool bool_or(std::string_view key, bool otherwise) const;
    std::vector<JsonPlace> items(std::string_view key) const;  // none where absent
    std::vector<JsonPlace> members(std::string_view key) const;

private:
    void expect(JsonNode::Kind kind) const;

    const JsonNode* node_;
    const std::string* file_;
    std::string place_;
};

}  // namespace throng
