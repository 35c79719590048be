#include "import/json_view.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng::gltf {
namespace {

const Json kEmptyArray = Json::array();

std::string entries(size_t count, const char* of) {
    return std::string(of) + " has " +
           (count == 0   ? "no entries"
            : count == 1 ? "1 entry"
                         : std::to_string(count) + " entries");
}

std::string kind_of(const Json& json) {
    switch (json.type()) {
        case Json::value_t::null: return "null";
        case Json::value_t::object: return "an object";
        case Json::value_t::array: return "an array";
        case Json::value_t::string: return "a string";
        case Json::value_t::boolean: return "a boolean";
        default: return "the number " + printable(json.dump(), 30);
    }
}

// What the parsed text will take, before it is parsed: nlohmann's values are 16 bytes, and each member of an object is
// a node of a std::map with its key. Measured: not below what is really taken, at most twice it.
struct JsonCost {
    uint32_t depth = 0;
    uint64_t size_bytes = 0;
};

JsonCost cost_of(std::string_view text) {
    JsonCost cost{0, text.size()};
    uint32_t depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            in_string = c != '"';
            continue;
        }
        switch (c) {
            case '"':
                in_string = true;
                cost.size_bytes += 32;
                break;
            case '{': cost.size_bytes += 80; [[fallthrough]];
            case '[':
                cost.size_bytes += 64;
                cost.depth = std::max(cost.depth, ++depth);
                break;
            case '}':
            case ']': depth -= depth > 0; break;
            case ':': cost.size_bytes += 80; break;
            case ',': cost.size_bytes += 32; break;
            default: break;
        }
    }
    return cost;
}

}  // namespace

std::string printable(std::string_view text, size_t limit) {
    const bool cut = text.size() > limit;
    if (cut) {
        text = text.substr(0, limit);
        // Not in the middle of a character of UTF-8.
        while (!text.empty() && (uint8_t(text.back()) & 0xC0) == 0x80) text.remove_suffix(1);
        if (!text.empty() && uint8_t(text.back()) >= 0xC0) text.remove_suffix(1);
    }
    std::string out;
    for (size_t i = 0; i < text.size(); ++i) {
        const auto byte = [&](size_t k) { return i + k < text.size() ? uint8_t(text[i + k]) : uint8_t(0); };
        const bool c0 = byte(0) < 0x20 || byte(0) == 0x7F;
        const bool c1 = byte(0) == 0xC2 && byte(1) >= 0x80 && byte(1) < 0xA0;  // U+0080 to U+009F
        const bool separator = byte(0) == 0xE2 && byte(1) == 0x80 &&
                               (byte(2) == 0xA8 || byte(2) == 0xA9);  // U+2028, U+2029
        out.push_back(c0 || c1 || separator ? '?' : text[i]);
        i += c1 ? 1 : separator ? 2 : 0;
    }
    return cut ? out + "..." : out;
}

Json parse_json(std::string_view text, Budget& budget) {
    if (text.size() > kJsonLimitBytes)
        throw Failure(ErrorCode::kLimit, "", "the JSON is larger than the limit of 256 MiB");
    // Some exporters pad the JSON chunk of a GLB with zeros in place of spaces.
    while (!text.empty() && text.back() == '\0') text.remove_suffix(1);
    const JsonCost cost = cost_of(text);
    if (cost.depth > kJsonDepthLimit)
        throw Failure(ErrorCode::kLimit, "",
                      "the JSON is nested deeper than the limit of " + std::to_string(kJsonDepthLimit));
    budget.charge(cost.size_bytes, "");
    try {
        return Json::parse(text);
    } catch (const Json::exception& error) {
        std::string what = error.what();
        if (const size_t bracket = what.find("] "); bracket != what.npos) what.erase(0, bracket + 2);
        // The message has bytes of the file in it, which may not be UTF-8.
        std::replace_if(
            what.begin(), what.end(), [](char c) { return uint8_t(c) >= 0x80; }, '?');
        throw Failure(ErrorCode::kInvalidFile, "", "the JSON cannot be read: " + printable(what, 200));
    }
}

std::string JsonView::place_of(const char* key) const { return place_.empty() ? key : place_ + "." + key; }

void JsonView::fail(std::string message, ErrorCode code) const { throw Failure(code, place_, std::move(message)); }

bool JsonView::has(const char* key) const { return json_->is_object() && json_->contains(key); }

std::optional<JsonView> JsonView::find(const char* key) const {
    const auto member = as_object().json_->find(key);
    if (member == json_->end()) return {};
    return JsonView(*member, place_of(key));
}

JsonView JsonView::required(const char* key) const {
    if (auto value = find(key)) return *value;
    throw Failure(ErrorCode::kInvalidFile, place_of(key), "is missing");
}

std::optional<JsonView> JsonView::optional_object(const char* key) const {
    auto value = find(key);
    if (value) value->as_object();
    return value;
}

JsonView JsonView::required_object(const char* key) const { return required(key).as_object(); }

JsonView JsonView::optional_array(const char* key) const {
    return has(key) ? required_array(key) : JsonView(kEmptyArray, place_of(key));
}

JsonView JsonView::required_array(const char* key) const {
    JsonView value = required(key);
    if (!value.json_->is_array()) value.fail("must be an array, but is " + kind_of(*value.json_));
    return value;
}

uint64_t JsonView::required_uint(const char* key) const { return required(key).as_uint(); }

uint64_t JsonView::optional_uint(const char* key, uint64_t otherwise) const {
    return has(key) ? required_uint(key) : otherwise;
}

uint32_t JsonView::required_index(const char* key, size_t count, const char* of) const {
    return required(key).as_index(count, of);
}

uint32_t JsonView::optional_index(const char* key, size_t count, const char* of) const {
    return has(key) ? required_index(key, count, of) : kNone;
}

double JsonView::optional_number(const char* key, double otherwise) const {
    return has(key) ? required(key).as_number() : otherwise;
}

bool JsonView::optional_numbers(const char* key, std::span<double> out) const {
    if (!has(key)) return false;
    const JsonView array = required_array(key);
    if (array.size() != out.size())
        array.fail("must have " + std::to_string(out.size()) + " numbers, but has " + std::to_string(array.size()));
    for (size_t i = 0; i < out.size(); ++i) out[i] = array[i].as_number();
    return true;
}

bool JsonView::optional_bool(const char* key, bool otherwise) const {
    const auto value = find(key);
    if (!value) return otherwise;
    if (!value->json_->is_boolean()) value->fail("must be true or false, but is " + kind_of(*value->json_));
    return value->json_->get<bool>();
}

const std::string& JsonView::required_string(const char* key) const { return required(key).as_string(); }

const std::string* JsonView::optional_string(const char* key) const {
    return has(key) ? &required_string(key) : nullptr;
}

std::optional<JsonView> JsonView::extension(const char* name) const {
    const auto extensions = optional_object("extensions");
    return extensions ? extensions->optional_object(name) : std::nullopt;
}

size_t JsonView::size() const { return json_->size(); }

JsonView JsonView::operator[](size_t index) const {
    return JsonView((*json_)[index], place_ + "[" + std::to_string(index) + "]");
}

bool JsonView::is_string() const { return json_->is_string(); }
bool JsonView::is_array() const { return json_->is_array(); }
bool JsonView::is_object() const { return json_->is_object(); }

const std::string& JsonView::as_string() const {
    if (!json_->is_string()) fail("must be a string, but is " + kind_of(*json_));
    return json_->get_ref<const std::string&>();
}

const JsonView& JsonView::as_object() const {
    if (!json_->is_object()) fail("must be an object, but is " + kind_of(*json_));
    return *this;
}

uint64_t JsonView::as_uint() const {
    constexpr double kExact = 9007199254740992.0;  // 2^53
    const double value = json_->is_number() ? json_->get<double>() : -1;
    // 5126.0 is an integer too, in JSON.
    if (!(value >= 0 && value < kExact && value == std::floor(value)))
        fail("must be a non-negative integer, but is " + kind_of(*json_));
    return uint64_t(value);
}

uint32_t JsonView::as_index(size_t count, const char* of) const {
    const uint64_t index = as_uint();
    if (index >= count || index >= kNone) fail("index " + std::to_string(index) + ", but " + entries(count, of));
    return uint32_t(index);
}

double JsonView::as_number() const {
    if (!json_->is_number()) fail("must be a number, but is " + kind_of(*json_));
    const double value = json_->get<double>();
    if (!(std::abs(value) <= double(std::numeric_limits<float>::max())))
        fail(kind_of(*json_) + " does not fit a 32-bit float");
    return value;
}

std::vector<std::string> JsonView::keys() const {
    std::vector<std::string> out;
    for (auto member = as_object().json_->begin(); member != json_->end(); ++member) out.push_back(member.key());
    return out;
}

}  // namespace throng::gltf
