#include "base/text.h"

#include <throng/asset.h>

namespace throng {

std::string numbered(std::string_view thing, uint32_t index) {
    return index == kNone ? joined(thing, " kNone (of a name that was not found?)") : joined(thing, " ", index);
}

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

}  // namespace throng
