// The text of messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace throng {

// Concatenates the parts; numbers are written by std::to_string().
template <class... Parts>
std::string joined(const Parts&... parts) {
    std::string out;
    const auto add = [&](const auto& part) {
        if constexpr (requires { std::to_string(part); })
            out += std::to_string(part);
        else
            out += part;
    };
    (add(parts), ...);
    return out;
}

// "joint 7", for an index that the caller gave. For kNone, which name lookups return for unknown names, the text hints
// at that.
std::string numbered(std::string_view thing, uint32_t index);

// Text from a file, made safe for a one-line message. Invalid UTF-8, control characters (which can rewrite a terminal)
// and characters that override the text direction become '?'. Text longer than `limit` bytes is cut between two
// characters.
std::string printable(std::string_view text, size_t limit = 60);

// ASCII only, independent of the application's locale: in a Turkish locale std::tolower('I') is not 'i'.
constexpr char ascii_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
inline std::string ascii_lower(std::string text) {
    for (char& c : text) c = ascii_lower(c);
    return text;
}
constexpr bool is_ascii_alphanumeric(char c) {
    return (c >= '0' && c <= '9') || (ascii_lower(c) >= 'a' && ascii_lower(c) <= 'z');
}

}  // namespace throng
