// printable(): what it keeps of text from a file.
#include "base/text.h"

#include <gtest/gtest.h>

#include <string>

namespace throng {
namespace {

std::string utf8_of(uint32_t code) {  // from U+0800 to U+FFFF
    return {static_cast<char>(0xE0 | code >> 12), static_cast<char>(0x80 | (code >> 6 & 0x3F)),
            static_cast<char>(0x80 | (code & 0x3F))};
}

TEST(Printable, KeepsTextInAnyLanguage) {
    for (const std::string text : {"", "a name.glb", "Zo\xC3\xAB", "\xE7\x8C\xAB", "\xF0\x9F\x90\x88", "\x7E\xC2\xA0",
                                   "\xD7\xA9\xE2\x80\x8F!", "\xED\x9F\xBF\xEE\x80\x80", "\xF4\x8F\xBF\xBF"})
        EXPECT_EQ(printable(text), text);
}

TEST(Printable, ReplacesControlCharacters) {
    EXPECT_EQ(printable(std::string("a\0b\n\x1B[2J\x7F", 9)), "a?b??[2J?");
    EXPECT_EQ(printable("\xC2\x80\xC2\x9B\xC2\x9F"), "???") << "those above ASCII";
    EXPECT_EQ(printable(utf8_of(0x2028) + utf8_of(0x2029)), "??") << "other ends of lines";
}

// 8-bit terminals treat the byte 0x9B as the start of a command.
TEST(Printable, ReplacesBytesThatAreNoUtf8) {
    EXPECT_EQ(printable("a\x9B"
                        "2Jb"),
              "a?2Jb");
    EXPECT_EQ(printable("\xE9t\xE9"), "?t?") << "Latin-1";
    EXPECT_EQ(printable("\xC3"), "?") << "it ends too early";
    EXPECT_EQ(printable("\xF0\x9F\x90"), "???");
    EXPECT_EQ(printable("\xE7\x8C."), "??.");
    EXPECT_EQ(printable("\xC0\x8A\xE0\x82\x9B"), "?????") << "longer than they need to be";
    EXPECT_EQ(printable("\xED\xA0\x80"), "???") << "half of a pair of UTF-16";
    EXPECT_EQ(printable("\xF4\x90\x80\x80\xFF"), "?????") << "beyond the last character";
}

TEST(Printable, ReplacesBidirectionalControls) {
    for (uint32_t code = 0x202A; code <= 0x202E; ++code) EXPECT_EQ(printable(utf8_of(code)), "?") << code;
    for (uint32_t code = 0x2066; code <= 0x2069; ++code) EXPECT_EQ(printable(utf8_of(code)), "?") << code;
    for (const uint32_t code : {0x2027u, 0x202Fu, 0x2065u, 0x206Au})
        EXPECT_EQ(printable(utf8_of(code)), utf8_of(code)) << code;
}

TEST(Printable, CutsBetweenCharacters) {
    EXPECT_EQ(printable("abcd", 4), "abcd");
    EXPECT_EQ(printable("abcde", 4), "abcd...");
    const std::string two = "\xC3\xA9\xC3\xA9";
    EXPECT_EQ(printable(two, 4), two);
    EXPECT_EQ(printable(two + "x", 4), two + "...");
    EXPECT_EQ(printable(two, 3), "\xC3\xA9...");
    EXPECT_EQ(printable(two, 1), "...");
    EXPECT_EQ(printable("\x80\x80\x80", 2), "??...");
}

}  // namespace
}  // namespace throng
