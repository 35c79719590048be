#include "controller/json_place.h"

#include "base/failure.h"
#include "controller/known_names.h"

#include <throng/asset.h>

#include <cmath>
#include <limits>

namespace throng {
namespace {

const char* name_of(JsonNode::Kind kind) {
    switch (kind) {
        case JsonNode::Kind::kNull: return "null";
        case JsonNode::Kind::kBool: return "true or false";
        case JsonNode::Kind::kNumber: return "a number";
        case JsonNode::Kind::kString: return "a string";
        case JsonNode::Kind::kArray: return "an array";
        case JsonNode::Kind::kObject: return "an object";
    }
    return "";
}

}  // namespace

void JsonPlace::fail(const std::string& message) const {
    throw Failure(ErrorCode::kInvalidFile, located(*file_, node_->line, place_), message);
}

void JsonPlace::expect(JsonNode::Kind kind) const {
    if (node_->kind != kind) fail(std::string("must be ") + name_of(kind) + ", but is " + name_of(node_->kind));
}

const std::string& JsonPlace::as_string() const {
    expect(JsonNode::Kind::kString);
    return node_->text;
}

double JsonPlace::as_number() const {
    expect(JsonNode::Kind::kNumber);
    if (std::abs(node_->number) > static_cast<double>(std::numeric_limits<float>::max()))
        fail("is too large for a 32-bit float");
    return node_->number;
}

float JsonPlace::as_float() const { return static_cast<float>(as_number()); }

bool JsonPlace::as_bool() const {
    expect(JsonNode::Kind::kBool);
    return node_->truth;
}

std::vector<JsonPlace> JsonPlace::items() const {
    expect(JsonNode::Kind::kArray);
    std::vector<JsonPlace> places;
    for (size_t i = 0; i < node_->children.size(); ++i)
        places.emplace_back(node_->children[i], *file_, place_of(place_, i));
    return places;
}

std::vector<JsonPlace> JsonPlace::members() const {
    expect(JsonNode::Kind::kObject);
    std::vector<JsonPlace> places;
    for (const JsonNode& child : node_->children) places.emplace_back(child, *file_, place_of(place_, child.key));
    return places;
}

void JsonPlace::allow(std::initializer_list<std::string_view> keys) const {
    expect(JsonNode::Kind::kObject);
    KnownNames fields("field");
    for (const std::string_view key : keys) fields.add(key);
    for (const JsonPlace& member : members())
        if (fields.find(member.key()) == kNone) member.fail(fields.unknown(member.key()));
}

std::optional<JsonPlace> JsonPlace::find(std::string_view key) const {
    expect(JsonNode::Kind::kObject);
    for (const JsonNode& child : node_->children)
        if (child.key == key) return JsonPlace(child, *file_, place_of(place_, key));
    return {};
}

JsonPlace JsonPlace::required(std::string_view key) const {
    if (const auto member = find(key)) return *member;
    fail("'" + std::string(key) + "' is missing");
}

std::string JsonPlace::string_or(std::string_view key, const char* otherwise) const {
    const auto member = find(key);
    return member ? member->as_string() : otherwise;
}

float JsonPlace::float_or(std::string_view key, float otherwise) const {
    const auto member = find(key);
    return member ? member->as_float() : otherwise;
}

bool JsonPlace::bool_or(std::string_view key, bool otherwise) const {
    const auto member = find(key);
    return member ? member->as_bool() : otherwise;
}

std::vector<JsonPlace> JsonPlace::items(std::string_view key) const {
    const auto member = find(key);
    return member ? member->items() : std::vector<JsonPlace>();
}

std::vector<JsonPlace> JsonPlace::members(std::string_view key) const {
    const auto member = find(key);
    return member ? member->members() : std::vector<JsonPlace>();
}

}  // namespace throng
