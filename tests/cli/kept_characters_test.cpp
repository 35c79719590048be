// Which compiled characters are kept in the cache folder, here the tests' own, and for which files.
#include "tools/cli/kept_characters.h"
#include "tests/glb_builder.h"
#include "tests/tool_runner.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace throng::tools {
namespace {

using test::GlbBuilder, test::tiny_character;

class KeptCharacters : public test::ToolTest {
protected:
    void SetUp() override {
        if (const char* cache = std::getenv("XDG_CACHE_HOME")) before_ = cache;
        setenv("XDG_CACHE_HOME", file("cache").c_str(), 1);
    }
    void TearDown() override {
        before_ ? setenv("XDG_CACHE_HOME", before_->c_str(), 1) : unsetenv("XDG_CACHE_HOME");
        std::filesystem::remove_all(file("cache"));
    }
    static auto kept_count() {
        std::error_code none_yet;
        return std::distance(std::filesystem::directory_iterator(file("cache/throng/characters"), none_yet), {});
    }
    static std::string with_clip(const std::string& name) {
        GlbBuilder character = tiny_character();
        character.json["animations"][0]["name"] = name;
        return character.glb();
    }

    std::optional<std::string> before_;
};

TEST_F(KeptCharacters, AFileChangedBeforeReadingIsNotCachedAsTheOldOne) {
    const std::string fox = write("fox.glb", with_clip("turn"));
    bool is_changed = false;
    const auto change = [&](double) {
        if (!std::exchange(is_changed, true)) write("fox.glb", with_clip("spin"));
    };
    const Result<Character> changed = load_kept_character(fox, {}, {.progress = change});
    ASSERT_TRUE(changed) << changed.error().text();
    ASSERT_EQ(changed->clips.at(0).name, "spin") << "it must change before it is read";
    write("fox.glb", with_clip("turn"));
    for (int times = 0; times < 2; ++times) EXPECT_EQ(load_kept_character(fox, {})->clips.at(0).name, "turn");
    EXPECT_EQ(kept_count(), 1) << "of the file that did not change";
}

// The first position of tiny_character() is 0; this one is wider.
std::string wider(std::string side) {
    const float x = -1;
    std::memcpy(side.data(), &x, sizeof x);
    return side;
}

TEST_F(KeptCharacters, ChangedSideFilesAreNoticedEvenWithEscapedKeys) {
    GlbBuilder character = tiny_character();
    character.json["buffers"] = {{{"side_uri", "side.bin"}, {"byteLength", character.bin.size()}}};
    const std::string glb = character.glb();
    const std::string side(reinterpret_cast<const char*>(character.bin.data()), character.bin.size());
    int count = 0;
    // Each escaped key is as long as the key it replaces, so that the lengths in the file stay right
    for (const char* key : {"\\u0075ri", "u\\u0072i", "ur\\u0069"}) {
        std::string escaped = glb;
        const std::string fox = write("fox.glb", escaped.replace(escaped.find("side_uri"), 8, key));
        write("side.bin", side);
        const Result<Character> narrow = load_kept_character(fox, {});
        ASSERT_TRUE(narrow) << narrow.error().text();
        write("side.bin", wider(side));
        const Result<Character> wide = load_kept_character(fox, {});
        ASSERT_TRUE(wide) << wide.error().text();
        EXPECT_LT(narrow->size, wide->size) << key;
        EXPECT_EQ(kept_count(), count += 2) << key;
        EXPECT_EQ(load_kept_character(fox, {})->size, wide->size) << key;
        EXPECT_EQ(kept_count(), count) << key;
    }
}

// A .gltf file, the names of whose side files are spelt as the importer would find them.
TEST_F(KeptCharacters, SideFilesAreFoundUnderTheirNames) {
    GlbBuilder character = tiny_character();
    const std::string side(reinterpret_cast<const char*>(character.bin.data()), character.bin.size());
    std::filesystem::create_directories(file("parts"));
    int count = 0;
    for (const char* uri : {"parts/a side.bin", "parts/a%20side.bin", "parts\\a side.bin", "./x/../parts/a side.bin"}) {
        character.json["buffers"] = {{{"uri", uri}, {"byteLength", character.bin.size()}}};
        const std::string fox = write("fox.gltf", character.json.dump());
        write("parts/a side.bin", side);
        const Result<Character> narrow = load_kept_character(fox, {});
        ASSERT_TRUE(narrow) << narrow.error().text();
        write("parts/a side.bin", wider(side));
        EXPECT_LT(narrow->size, load_kept_character(fox, {})->size) << uri;
        EXPECT_EQ(kept_count(), count += 2) << uri;
    }
}

TEST_F(KeptCharacters, DotsBehindALinkAreResolvedAsWhenLoading) {
    GlbBuilder character = tiny_character();
    const std::string side(reinterpret_cast<const char*>(character.bin.data()), character.bin.size());
    std::filesystem::create_directories(file("sub/deep"));
    std::filesystem::create_directory_symlink("sub/deep", file("link"));
    character.json["buffers"] = {{{"uri", "link/../side.bin"}, {"byteLength", character.bin.size()}}};
    const std::string fox = write("fox.gltf", character.json.dump());
    write("side.bin", side);
    const Result<Character> narrow = load_kept_character(fox, {});
    ASSERT_TRUE(narrow) << narrow.error().text();
    write("side.bin", wider(side));
    EXPECT_LT(narrow->size, load_kept_character(fox, {})->size);
}

// Without its image a character is compiled with a warning.
TEST_F(KeptCharacters, AnImageThatAppearsIsNoticed) {
    GlbBuilder character = tiny_character();
    character.json["images"] = {{{"uri", "skin.png"}}, {{"uri", "../skin.png"}}};
    const std::string fox = write("fox.glb", character.glb());
    for (int times = 0; times < 2; ++times) ASSERT_TRUE(load_kept_character(fox, {}));
    EXPECT_EQ(kept_count(), 1);
    write("skin.png", "not a picture");
    ASSERT_TRUE(load_kept_character(fox, {}));
    EXPECT_EQ(kept_count(), 2);
}

// Some exporters escape all non-ASCII letters.
TEST_F(KeptCharacters, EscapesInNamesDoNotPreventCaching) {
    std::string named = with_clip("rotate");
    const std::string fox = write("fox.glb", named.replace(named.find("rotate"), 6, "\\u00e9"));
    EXPECT_EQ(load_kept_character(fox, {})->clips.at(0).name, "\u00e9");
    EXPECT_EQ(kept_count(), 1);
}

}  // namespace
}  // namespace throng::tools
