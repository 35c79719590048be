#include "base/text.h"

#include <throng/asset.h>

#include <array>
#include <bit>

namespace throng {
namespace {

constexpr uint32_t kNoCharacter = 0xFFFFFFFF;

struct Utf8Character {
    uint32_t code = kNoCharacter;
    size_t byte_count = 1;
};

// The first character of the text; kNoCharacter, with a length of one byte, if the text does not begin with valid
// UTF-8.
Utf8Character first_of(std::string_view text) {
    constexpr std::array<uint32_t, 5> kMinimum{0, 0, 0x80, 0x800, 0x10000};  // least code of each byte count
    const auto first = static_cast<uint8_t>(text[0]);
    if (first < 0x80) return {first, 1};
    const auto byte_count = static_cast<size_t>(std::countl_one(first));
    if (byte_count < 2 || byte_count > 4 || byte_count > text.size()) return {};
    uint32_t code = first & (0x7Fu >> byte_count);
    for (size_t i = 1; i < byte_count; ++i) {
        const auto next = static_cast<uint8_t>(text[i]);
        if ((next & 0xC0) != 0x80) return {};
        code = code << 6 | (next & 0x3Fu);
    }
    const bool is_surrogate = code >= 0xD800 && code < 0xE000;
    return code < kMinimum[byte_count] || code > 0x10FFFF || is_surrogate ? Utf8Character{}
                                                                          : Utf8Character{code, byte_count};
}

bool is_printable(uint32_t code) {
    const auto is_within = [code](uint32_t low, uint32_t high) { return code >= low && code <= high; };
    const bool is_control = code < 0x20 || is_within(0x7F, 0x9F);
    const bool ends_line = is_within(0x2028, 0x2029);
    const bool turns_around = is_within(0x202A, 0x202E) || is_within(0x2066, 0x2069);  // overrides the text direction
    return code != kNoCharacter && !is_control && !ends_line && !turns_around;
}

}  // namespace

std::string numbered(std::string_view thing, uint32_t index) {
    return index == kNone ? joined(thing, " kNone (was its name not found?)") : joined(thing, " ", index);
}

std::string printable(std::string_view text, size_t limit) {
    std::string out;
    for (size_t at = 0; at < text.size();) {
        const auto [code, byte_count] = first_of(text.substr(at));
        if (at + byte_count > limit) return out + "...";
        if (is_printable(code))
            out += text.substr(at, byte_count);
        else
            out += '?';
        at += byte_count;
    }
    return out;
}

}  // namespace throng
