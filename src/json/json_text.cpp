#include "json/json_text.h"

#include "json/known_names.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <map>

namespace throng {
namespace {

std::string at_line(const std::string& file, uint32_t line) { return joined(file, ":", line); }

// nlohmann's parser counts lines, but exposes them only in its own error messages. So it reads the text through this
// iterator, which counts lines too, and reports progress.
class LineCounter {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    // Only the begin iterator needs `line` and `progress`.
    LineCounter(std::string_view text, size_t at, uint32_t* line = nullptr, const Progress* progress = nullptr)
        : text_(text), at_(text.data() + at), line_(line), progress_(progress) {}
    const char& operator*() const { return *at_; }
    LineCounter& operator++() {
        // The parser reads one character past a number. If that is the newline, the number is still on the old line, so
        // the line is counted one step later
        *line_ += std::exchange(ends_line_, *at_ == '\n');
        ++at_;
        if (const auto read = static_cast<size_t>(at_ - text_.data()); read % kCharactersBetweenReports == 0)
            progress_->report(read, text_.size());
        return *this;
    }
    bool operator==(const LineCounter& other) const { return at_ == other.at_; }

private:
    static constexpr size_t kCharactersBetweenReports = 1 << 16;

    std::string_view text_;
    const char* at_;
    uint32_t* line_;  // line of the last character read
    const Progress* progress_;
    bool ends_line_ = false;
};

// Empties containers from the innermost outwards, so that no destructor has to allocate.
void clear_recursively(Json& json) {
    if (!json.is_structured()) return;
    for (Json& child : json) clear_recursively(child);
    json.clear();
}

// Like nlohmann's own builder, but also records lines, enforces limits, and does not search the object for each new
// key. Members are collected separately until their object ends, since nlohmann's object copies its members whenever it
// grows.
class TreeBuilder final : public nlohmann::json_sax<Json> {
public:
    TreeBuilder(JsonAuthor author, const std::string& file, const uint32_t& line, Json& root,
                std::vector<uint32_t>& lines)
        : by_person_(author == JsonAuthor::kPerson), file_(file), line_(line), root_(root), lines_(lines) {}

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t&) override { return false; }  // not in text
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool key(string_t& value) override {
        if (by_person_)
            if (const auto [known, is_new] = open_.back().key_lines.emplace(value, line_); !is_new)
                fail(ErrorCode::kInvalidFile, "duplicate key '", printable(value), "' in one object, first in line ",
                     known->second, "; rename or remove one");
        key_ = std::move(value);
        key_line_ = line_;
        return true;
    }
    bool end_object() override {
        auto& members = open_.back().members;
        if (!by_person_) sort_by_key(members);
        auto& object = open_.back().value.get_ref<Json::object_t&>();
        object.reserve(members.size());
        for (auto& [key, value] : members) object.emplace_back(std::move(key), std::move(value));
        return end_array();
    }
    bool end_array() override {
        Open closed = std::move(open_.back());
        open_.pop_back();
        put(std::move(closed.key), std::move(closed.value));
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
        // "[json.exception.parse_error.101] parse error at line 3, column 5: …"; the error's place already has the line
        std::string what = error.what();
        what.erase(0, what.find("] ") + 2);
        if (const size_t column = what.find("column "); by_person_ && column != what.npos) what.erase(0, column);
        // The message quotes bytes of the file, which may not be UTF-8.
        std::replace_if(
            what.begin(), what.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
        fail(ErrorCode::kInvalidFile, by_person_ ? "not JSON: " : "the JSON cannot be read: ", printable(what, 200));
    }

private:
    using Member = std::pair<std::string, Json>;
    struct Open {
        Open(Json value_in, std::string key_in) : value(std::move(value_in)), key(std::move(key_in)) {}
        Open(Open&&) noexcept = default;
        ~Open() {
            clear_recursively(value);
            for (auto& [_, member] : members) clear_recursively(member);
        }

        Json value;
        std::string key;  // in the enclosing object
        std::vector<Member> members{};
        std::map<std::string, uint32_t> key_lines{};  // only for text that a person wrote
    };

    template <class... Parts>
    [[noreturn]] void fail(ErrorCode code, const Parts&... message) const {
        throw Failure(code, by_person_ ? at_line(file_, line_) : "", message...);
    }

    // For JsonView::member(). Of several members with the same key, keeps the last.
    static void sort_by_key(std::vector<Member>& members) {
        std::ranges::stable_sort(members, {}, &Member::first);
        const auto end = std::unique(members.rbegin(), members.rend(),
                                     [](const Member& a, const Member& b) { return a.first == b.first; });
        members.erase(members.begin(), end.base());
    }

    void count() {
        if (by_person_ && lines_.size() == kJsonValueLimit)
            fail(ErrorCode::kLimit, "the JSON has more than the limit of ", kJsonValueLimit, " values");
        lines_.push_back(!open_.empty() && open_.back().value.is_object() ? key_line_ : line_);
    }
    bool add(Json value) {
        count();
        put(std::move(key_), std::move(value));
        return true;
    }
    bool open(Json value) {
        count();
        if (const size_t limit = by_person_ ? kJsonNestingLimit : kProgramNestingLimit; open_.size() == limit)
            fail(ErrorCode::kLimit, "the JSON is nested deeper than the limit of ", limit);
        open_.emplace_back(std::move(value), std::move(key_));
        return true;
    }
    void put(std::string key, Json&& value) {
        if (open_.empty())
            root_ = std::move(value);
        else if (open_.back().value.is_object())
            open_.back().members.emplace_back(std::move(key), std::move(value));
        else
            open_.back().value.get_ref<Json::array_t&>().emplace_back(std::move(value));
    }

    const bool by_person_;
    const std::string& file_;
    const uint32_t& line_;
    Json& root_;
    std::vector<uint32_t>& lines_;
    std::vector<Open> open_;
    std::string key_;
    uint32_t key_line_ = 0;
};

size_t value_count(const JsonView& json) {
    size_t count = 1;
    for (const JsonView child : json) count += value_count(child);
    return count;
}

}  // namespace

void DeleteJson::operator()(Json* json) const {
    clear_recursively(*json);
    delete json;
}

JsonText::JsonText(std::string_view text, JsonAuthor author, const std::string& file, const Progress& progress)
    : author_(author), root_(new Json) {
    uint32_t line = 1;
    TreeBuilder builder(author, file, line, *root_, lines_);
    Json::sax_parse(LineCounter(text, 0, &line, &progress), LineCounter(text, text.size()), &builder);
}

std::string JsonText::located(const std::string& file, const std::string& place) const {
    const auto encloses = [&](const std::string& there) {
        return place.starts_with(there) &&
               (place.size() == there.size() || place[there.size()] == '.' || place[there.size()] == '[');
    };
    size_t index = 0;  // in lines_, of the innermost value found so far
    for (std::optional<JsonView> inner = view(); inner;) {
        const JsonView around = *std::exchange(inner, std::nullopt);
        size_t next = index + 1;
        for (const JsonView child : around) {
            if (encloses(child.place())) {
                inner = child;
                index = next;
                break;
            }
            next += value_count(child);
        }
    }
    return at_line(file, lines_[index]) + (place.empty() ? "" : ": " + place);
}

}  // namespace throng
