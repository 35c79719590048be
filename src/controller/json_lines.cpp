#include "controller/json_lines.h"

#include "base/failure.h"
#include "controller/known_names.h"
#include "import/json_view.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <iterator>

namespace throng {
namespace {

// nlohmann's parser knows lines, but tells them only with its own errors. So it reads through this, which counts them.
class LineCounter {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    LineCounter(const char* at, uint32_t* line) : at_(at), line_(line) {}
    const char& operator*() const { return *at_; }
    LineCounter& operator++() {
        // A number is read up to the character behind it, which may end the line
        *line_ += std::exchange(ends_line_, *at_ == '\n');
        ++at_;
        return *this;
    }
    LineCounter operator++(int) {
        LineCounter before = *this;
        ++*this;
        return before;
    }
    bool operator==(const LineCounter& other) const { return at_ == other.at_; }
    bool operator!=(const LineCounter& other) const { return at_ != other.at_; }

private:
    const char* at_;
    uint32_t* line_;  // of the last character that was read
    bool ends_line_ = false;
};

class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
public:
    TreeBuilder(const std::string& file, const uint32_t& line) : file_(file), line_(line) {}
    JsonNode take() { return std::move(root_); }

    bool null() override { return add({}), true; }
    bool boolean(bool value) override { return add({.kind = JsonNode::Kind::kBool, .truth = value}), true; }
    bool number_integer(number_integer_t value) override { return add_number(static_cast<double>(value)); }
    bool number_unsigned(number_unsigned_t value) override { return add_number(static_cast<double>(value)); }
    bool number_float(number_float_t value, const string_t&) override { return add_number(value); }
    bool string(string_t& value) override {
        return add({.kind = JsonNode::Kind::kString, .text = std::move(value)}), true;
    }
    bool binary(binary_t&) override { return false; }  // not in text
    bool start_object(std::size_t) override { return open(JsonNode::Kind::kObject); }
    bool start_array(std::size_t) override { return open(JsonNode::Kind::kArray); }
    bool key(string_t& value) override {
        key_ = std::move(value);
        key_line_ = line_;
        return true;
    }
    bool end_object() override {
        refuse_duplicates(*open_.back());
        open_.pop_back();
        return true;
    }
    bool end_array() override {
        open_.pop_back();
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
        // "[json.exception.parse_error.101] parse error at line 3, column 5: …": the line is said already
        std::string what = error.what();
        for (const std::string_view before : {"] ", "column "})
            if (const size_t at = what.find(before); at != what.npos) what.erase(0, at + before.size());
        if (error.id == 101) what = "column " + what;
        // May not be UTF-8
        std::replace_if(
            what.begin(), what.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
        throw Failure(ErrorCode::kInvalidFile, located(file_, line_, ""), "not JSON: " + gltf::printable(what, 200));
    }

private:
    [[noreturn]] void refuse_size(const std::string& limit) const {
        throw Failure(ErrorCode::kLimit, located(file_, line_, ""), "the JSON " + limit);
    }

    JsonNode* add(JsonNode node) {
        if (++value_count_ > kJsonValueLimit)
            refuse_size("has more than the limit of " + std::to_string(kJsonValueLimit) + " values");
        node.line = line_;
        if (open_.empty()) return &(root_ = std::move(node));
        JsonNode& parent = *open_.back();
        if (parent.kind == JsonNode::Kind::kObject) {
            node.key = std::move(key_);
            node.line = key_line_;
        }
        return &parent.children.emplace_back(std::move(node));
    }
    bool add_number(double value) { return add({.kind = JsonNode::Kind::kNumber, .number = value}), true; }
    bool open(JsonNode::Kind kind) {
        if (open_.size() == kJsonNestingLimit)
            refuse_size("is nested deeper than the limit of " + std::to_string(kJsonNestingLimit));
        open_.push_back(add({.kind = kind}));  // stays where it is: its parent gets no other child before it is closed
        return true;
    }
    void refuse_duplicates(const JsonNode& object) const {
        std::vector<const JsonNode*> sorted;
        for (const JsonNode& member : object.children) sorted.push_back(&member);
        std::stable_sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return a->key < b->key; });
        const auto twice = std::adjacent_find(sorted.begin(), sorted.end(),
                                              [](auto* a, auto* b) { return a->key == b->key; });
        if (twice == sorted.end()) return;
        throw Failure(ErrorCode::kInvalidFile, located(file_, twice[1]->line, ""),
                      "'" + gltf::printable(twice[1]->key) + "' stands twice in one object, first in line " +
                          std::to_string(twice[0]->line) + "; rename or remove one");
    }

    const std::string& file_;
    const uint32_t& line_;
    JsonNode root_;
    std::vector<JsonNode*> open_;
    std::string key_;
    uint32_t key_line_ = 0;
    size_t value_count_ = 0;
};

bool is_word(std::string_view key) {
    return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
        return std::isalnum(c) || c == '_' || c == '$' || c == '-';
    });
}

}  // namespace

JsonNode parse_json_lines(std::string_view text, const std::string& file) {
    if (text.size() > kJsonTextLimit_bytes) throw Failure(ErrorCode::kLimit, file, kJsonTextLimitMessage);
    uint32_t line = 1, unused = 0;
    TreeBuilder builder(file, line);
    nlohmann::json::sax_parse(LineCounter(text.data(), &line), LineCounter(text.data() + text.size(), &unused),
                              &builder);
    return builder.take();
}

std::string place_of(const std::string& place, std::string_view key) {
    if (is_word(key)) return place.empty() ? std::string(key) : place + "." + std::string(key);
    return place + "[\"" + gltf::printable(key, kNameLimit) + "\"]";
}

std::string place_of(const std::string& place, size_t index) { return place + "[" + std::to_string(index) + "]"; }

uint32_t line_of(const JsonNode& root, std::string_view place) {
    const JsonNode* node = &root;
    std::string here;
    for (bool deeper = true; deeper;) {
        deeper = false;
        for (size_t i = 0; i < node->children.size() && !deeper; ++i) {
            const JsonNode& child = node->children[i];
            std::string there = node->kind == JsonNode::Kind::kArray ? place_of(here, i) : place_of(here, child.key);
            if (!place.starts_with(there) ||
                (place.size() > there.size() && place[there.size()] != '.' && place[there.size()] != '['))
                continue;
            node = &child;
            here = std::move(there);
            deeper = true;
        }
    }
    return node->line;
}

std::string located(const std::string& file, uint32_t line, const std::string& place) {
    return file + ":" + std::to_string(line) + (place.empty() ? "" : ": " + place);
}

}  // namespace throng
