#include "json/json_view.h"

#include "base/text.h"
#include "json/known_names.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
namespace {

const Json kEmptyArray = Json::array(), kEmptyObject = Json::object();

bool is_word(std::string_view key) {
    return !key.empty() && std::ranges::all_of(key, [](char c) {
        return is_ascii_alphanumeric(c) || c == '_' || c == '$' || c == '-';
    });
}

std::string entries(size_t count, const char* of) {
    return joined(of, " has ", count == 0 ? "no" : std::to_string(count), count == 1 ? " entry" : " entries");
}

}  // namespace

std::string place_of(const std::string& place, std::string_view key) {
    if (key.size() <= kNameLimit && is_word(key)) return joined(place, place.empty() ? "" : ".", key);
    return joined(place, "[\"", printable(key, kNameLimit), "\"]");
}

std::string place_of(const std::string& place, size_t index) { return joined(place, "[", index, "]"); }

std::string JsonView::kind() const {
    const bool by_person = author_ == JsonAuthor::kPerson;
    switch (json_->type()) {
        case Json::value_t::null: return "null";
        case Json::value_t::object: return "an object";
        case Json::value_t::array: return "an array";
        case Json::value_t::string: return "a string";
        case Json::value_t::boolean: return !by_person ? "a boolean" : json_->get<bool>() ? "true" : "false";
        default: return by_person ? "a number" : "the number " + printable(json_->dump(), 30);
    }
}

const JsonView& JsonView::expect(bool is, const char* what) const {
    if (!is) fail("must be ", what, ", but is ", kind());
    return *this;
}

const Json* JsonView::member(std::string_view key) const {
    const auto& members = json_->get_ref<const Json::object_t&>();
    // Objects that programs write can have any number of members; JsonText has sorted them.
    const auto found = author_ == JsonAuthor::kProgram
                           ? std::ranges::lower_bound(members, key, {},
                                                      [](const auto& m) { return std::string_view(m.first); })
                           : std::ranges::find_if(members, [&](const auto& m) { return m.first == key; });
    return found == members.end() || found->first != key ? nullptr : &found->second;
}

std::optional<JsonView> JsonView::find(std::string_view key) const {
    const Json* value = as_object().member(key);
    if (!value) return {};
    return JsonView(*value, author_, place_of(key));
}

JsonView JsonView::required(std::string_view key) const {
    if (auto value = find(key)) return *value;
    if (author_ == JsonAuthor::kPerson) fail("'", key, "' is missing");
    fail_at(key, "is missing");
}

std::optional<JsonView> JsonView::optional_object(std::string_view key) const {
    auto value = find(key);
    if (value) value->as_object();
    return value;
}

JsonView JsonView::optional_array(std::string_view key) const {
    return has(key) ? required_array(key) : JsonView(kEmptyArray, author_, place_of(key));
}

JsonView JsonView::optional_members(std::string_view key) const {
    return has(key) ? required_object(key) : JsonView(kEmptyObject, author_, place_of(key));
}

uint64_t JsonView::optional_uint(std::string_view key, uint64_t otherwise) const {
    return has(key) ? required_uint(key) : otherwise;
}

uint32_t JsonView::required_index(std::string_view key, size_t count, const char* of) const {
    return required(key).as_index(count, of);
}

uint32_t JsonView::optional_index(std::string_view key, size_t count, const char* of) const {
    return has(key) ? required_index(key, count, of) : kNone;
}

double JsonView::optional_number(std::string_view key, double otherwise) const {
    return has(key) ? required(key).as_number() : otherwise;
}

float JsonView::optional_float(std::string_view key, float otherwise) const {
    return static_cast<float>(optional_number(key, otherwise));
}

bool JsonView::optional_numbers(std::string_view key, std::span<double> out) const {
    if (!has(key)) return false;
    const JsonView array = required_array(key);
    if (array.size() != out.size()) array.fail("must have ", out.size(), " numbers, but has ", array.size());
    for (size_t i = 0; i < out.size(); ++i) out[i] = array[i].as_number();
    return true;
}

bool JsonView::optional_bool(std::string_view key, bool otherwise) const {
    const auto value = find(key);
    return value ? value->as_bool() : otherwise;
}

const std::string* JsonView::optional_string(std::string_view key) const {
    return has(key) ? &required_string(key) : nullptr;
}

std::optional<JsonView> JsonView::extension(std::string_view name) const {
    const auto extensions = optional_object("extensions");
    return extensions ? extensions->optional_object(name) : std::nullopt;
}

void JsonView::allow(std::initializer_list<std::string_view> keys) const {
    as_object();
    KnownNames fields("field");
    for (const std::string_view key : keys) fields.add(key);
    for (const JsonView member : *this)
        if (fields.find(member.key()) == kNone) member.fail(fields.unknown(member.key()));
}

size_t JsonView::size() const { return json_->is_structured() ? json_->size() : 0; }

JsonView JsonView::operator[](size_t index) const {
    if (json_->is_array()) return JsonView((*json_)[index], author_, throng::place_of(place_, index));
    const auto& [key, value] = json_->get_ref<const Json::object_t&>().begin()[static_cast<std::ptrdiff_t>(index)];
    JsonView member(value, author_, place_of(key));
    member.key_ = &key;
    return member;
}

bool JsonView::is_null() const { return json_->is_null(); }
bool JsonView::is_bool() const { return json_->is_boolean(); }
bool JsonView::is_number() const { return json_->is_number(); }
bool JsonView::is_string() const { return json_->is_string(); }
bool JsonView::is_array() const { return json_->is_array(); }
bool JsonView::is_object() const { return json_->is_object(); }

bool JsonView::as_bool() const { return expect(is_bool(), "true or false").json_->get<bool>(); }
const std::string& JsonView::as_string() const {
    return expect(is_string(), "a string").json_->get_ref<const std::string&>();
}
const JsonView& JsonView::as_array() const { return expect(is_array(), "an array"); }
const JsonView& JsonView::as_object() const { return expect(is_object(), "an object"); }

uint64_t JsonView::as_uint() const {
    constexpr double kExact = 9007199254740992.0;  // 2^53
    const double value = is_number() ? json_->get<double>() : -1;
    // 5126.0 is an integer too, in JSON.
    expect(value >= 0 && value < kExact && value == std::floor(value), "a non-negative integer");
    return static_cast<uint64_t>(value);
}

uint32_t JsonView::as_index(size_t count, const char* of) const {
    const uint64_t index = as_uint();
    if (index >= count || index >= kNone) fail("index ", index, ", but ", entries(count, of));
    return static_cast<uint32_t>(index);
}

double JsonView::as_number() const {
    const double value = expect(is_number(), "a number").json_->get<double>();
    if (std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max())) return value;
    if (author_ == JsonAuthor::kPerson) fail("is too large for a 32-bit float");
    fail(kind(), " does not fit a 32-bit float");
}

}  // namespace throng
