// The text of messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace throng {

// The parts one after the other, numbers as std::to_string() writes them.
template <class... Parts>
std::string joined(const Parts&... parts) {
    std::string out;
    const auto add = [&](const auto& part) {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(part)>>)
            out += std::to_string(part);
        else
            out += part;
    };
    (add(parts), ...);
    return out;
}

// "joint 7", for a number that the caller gave; for kNone, which looking up an unknown name returns, it says so.
std::string numbered(std::string_view thing, uint32_t index);

// `text` from a file, made fit for a message of one line: what is no UTF-8 becomes '?', as do control characters, which
// can rewrite a terminal, and those that turn around the direction of writing. What is longer than `limit` bytes is
// cut, between two characters.
std::string printable(std::string_view text, size_t limit = 60);

// By ASCII alone, whatever the application's locale is: in a Turkish one, std::tolower('I') is no 'i'.
constexpr char ascii_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
inline std::string ascii_lower(std::string text) {
    for (char& c : text) c = ascii_lower(c);
    return text;
}
constexpr bool is_ascii_alphanumeric(char c) {
    return (c >= '0' && c <= '9') || (ascii_lower(c) >= 'a' && ascii_lower(c) <= 'z');
}

}  // namespace throng
