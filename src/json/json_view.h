// JSON values that know their place in the file. All readers use this, so that each error message names the place.
#pragma once

#include "base/failure.h"

#include <throng/asset.h>

#include <nlohmann/json_fwd.hpp>

#include <initializer_list>
#include <optional>

namespace throng {

using Json = nlohmann::ordered_json;  // members in the order of the text

// Decides how error messages point into a JSON file: by the line number if a person wrote it. A file that a program
// wrote, such as glTF, is often a single line, so they quote the wrong value instead.
enum class JsonAuthor : uint8_t { kProgram, kPerson };

// The place of a member or an element of `place`: `layers`, `layers[0].states.move`, `masks["left arm"]`.
std::string place_of(const std::string& place, std::string_view key);
std::string place_of(const std::string& place, size_t index);

// The place of a nested value: several keys or indices, outermost first.
template <class Key, class... Keys>
requires(sizeof...(Keys) > 0) std::string place_of(const std::string& place, const Key& key, const Keys&... below) {
    return place_of(place_of(place, key), below...);
}

// A value of the file and its place, such as `animations[2].channels[5]`. The Json must outlive the view.
// The getters fail with kInvalidFile at the value's place; an `optional_` getter fails only if the value is present but
// invalid.
class JsonView {
public:
    JsonView(const Json& json, JsonAuthor author, std::string place = {})
        : json_(&json), author_(author), place_(std::move(place)) {}

    const std::string& place() const { return place_; }
    std::string place_of(std::string_view key) const { return throng::place_of(place_, key); }
    template <class... Parts>
    [[noreturn]] void fail(const Parts&... message) const {
        throw Failure(ErrorCode::kInvalidFile, place_, message...);
    }
    // Like fail(), at the place of a member.
    template <class... Parts>
    [[noreturn]] void fail_at(std::string_view key, const Parts&... message) const {
        throw Failure(ErrorCode::kInvalidFile, place_of(key), message...);
    }

    // For objects.
    bool has(std::string_view key) const { return is_object() && member(key); }
    std::optional<JsonView> find(std::string_view key) const;
    JsonView required(std::string_view key) const;
    std::optional<JsonView> optional_object(std::string_view key) const;
    JsonView required_object(std::string_view key) const { return required(key).as_object(); }
    JsonView optional_array(std::string_view key) const;    // empty if absent
    JsonView optional_members(std::string_view key) const;  // an object; empty if absent
    JsonView required_array(std::string_view key) const { return required(key).as_array(); }
    uint64_t required_uint(std::string_view key) const { return required(key).as_uint(); }
    uint64_t optional_uint(std::string_view key, uint64_t otherwise) const;
    // An index into the file's array named `of`, which has `count` entries.
    uint32_t required_index(std::string_view key, size_t count, const char* of) const;
    uint32_t optional_index(std::string_view key, size_t count, const char* of) const;  // kNone if absent
    double optional_number(std::string_view key, double otherwise) const;
    float optional_float(std::string_view key, float otherwise) const;
    bool optional_numbers(std::string_view key, std::span<double> out) const;  // false if absent
    bool optional_bool(std::string_view key, bool otherwise) const;
    const std::string& required_string(std::string_view key) const { return required(key).as_string(); }
    const std::string* optional_string(std::string_view key) const;
    // `extensions.<name>` of this object.
    std::optional<JsonView> extension(std::string_view name) const;
    // Fails if the object has a member that `keys` does not list.
    void allow(std::initializer_list<std::string_view> keys) const;

    // For arrays and objects: `for (const JsonView child : view)`. Other values have no children.
    size_t size() const;
    JsonView operator[](size_t index) const;
    struct Iterator {
        const JsonView* of;
        size_t index;

        JsonView operator*() const { return (*of)[index]; }
        Iterator& operator++() { return ++index, *this; }
        bool operator==(const Iterator& other) const { return index == other.index; }
    };
    Iterator begin() const { return {this, 0}; }
    Iterator end() const { return {this, size()}; }

    // The value itself. Fails for numbers that do not fit a float, and integers of 2^53 and above.
    const std::string& key() const { return *key_; }  // only for members that come from iterating over an object
    bool is_null() const;
    bool is_bool() const;
    bool is_number() const;
    bool is_string() const;
    bool is_array() const;
    bool is_object() const;
    bool as_bool() const;
    const std::string& as_string() const;
    const JsonView& as_array() const;
    const JsonView& as_object() const;
    uint64_t as_uint() const;
    uint32_t as_index(size_t count, const char* of) const;
    double as_number() const;
    float as_float() const { return static_cast<float>(as_number()); }

private:
    const Json* member(std::string_view key) const;
    const JsonView& expect(bool is, const char* what) const;
    std::string kind() const;

    const Json* json_;
    JsonAuthor author_;
    std::string place_;
    const std::string* key_ = nullptr;
};

}  // namespace throng
