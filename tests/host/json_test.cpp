// JSON values that know their place in the document; text by programs is read leniently, text by people strictly.
#include "base/text.h"
#include "json/json_text.h"
#include "json/known_names.h"

#include <gtest/gtest.h>

namespace throng {
namespace {

std::string error_of_reading(const auto& what) {
    const auto result = as_result([&] { what(); });
    return result ? "" : result.error().text();
}

TEST(Json, PlacesNameTheirPath) {
    EXPECT_EQ(place_of("", "nodes"), "nodes");
    EXPECT_EQ(place_of("nodes", size_t{3}, "name"), "nodes[3].name");
    EXPECT_EQ(place_of("masks", "left arm"), "masks[\"left arm\"]");
    EXPECT_EQ(place_of("masks", ""), "masks[\"\"]");
    EXPECT_EQ(place_of("masks", "a\nb", size_t{0}), "masks[\"a?b\"][0]") << "a place is one line";
}

TEST(Json, MembersKeepTheirOrder) {
    const JsonText text(R"({"z": 1, "a": [true, "b"], "m": {}})", JsonAuthor::kPerson);
    std::string all;
    for (const JsonView member : text.view()) all += member.key() + "=" + member.place() + " ";
    EXPECT_EQ(all, "z=z a=a m=m ");
    EXPECT_EQ(text.view().required_array("a")[1].as_string(), "b");
    EXPECT_EQ(text.view().required("z").size(), 0u) << "of a number";
    EXPECT_EQ(text.view().optional_array("none").size() + text.view().optional_members("none").size(), 0u);
}

TEST(Json, DuplicateKeysAreRefusedOnlyFromPeople) {
    const char* twice = "{\"a\": 1, \"b\": 2,\n\"a\": 3}";
    const JsonText text(twice, JsonAuthor::kProgram);
    EXPECT_EQ(text.view().required_uint("a"), 3u);
    EXPECT_EQ(error_of_reading([&] { JsonText(twice, JsonAuthor::kPerson, "x.json"); }),
              "x.json:2: duplicate key 'a' in one object, first in line 1; rename or remove one");
}

TEST(Json, ErrorsDifferForProgramsAndPeople) {
    const char* json = R"({"n": 7, "big": 1e39, "list": [1, 2]})";
    const JsonText by_program(json, JsonAuthor::kProgram), by_person(json, JsonAuthor::kPerson);
    const JsonView p = by_program.view(), q = by_person.view();
    EXPECT_EQ(error_of_reading([&] { p.required_string("n"); }), "n: must be a string, but is the number 7");
    EXPECT_EQ(error_of_reading([&] { q.required_string("n"); }), "n: must be a string, but is a number");
    EXPECT_EQ(error_of_reading([&] { p.required("x"); }), "x: is missing");
    EXPECT_EQ(error_of_reading([&] { q.required("x"); }), "'x' is missing");
    EXPECT_EQ(error_of_reading([&] { p.optional_float("big", 0); }),
              "big: the number 1e+39 does not fit a 32-bit float");
    EXPECT_EQ(error_of_reading([&] { q.optional_float("big", 0); }), "big: is too large for a 32-bit float");
    EXPECT_EQ(error_of_reading([&] { p.required_index("n", 1, "nodes"); }), "n: index 7, but nodes has 1 entry");
    EXPECT_EQ(error_of_reading([&] { p.required_index("n", 0, "nodes"); }), "n: index 7, but nodes has no entries");
    std::array<double, 3> three{};
    EXPECT_EQ(error_of_reading([&] { p.optional_numbers("list", three); }), "list: must have 3 numbers, but has 2");
    EXPECT_EQ(error_of_reading([&] {
                  q.allow({"n", "bug", "list"});
              }),
              "big: there is no field 'big'; did you mean 'bug'? There are: n, bug, list");
}

TEST(Json, SuggestionsStartWithNamesThatContainTheInput) {
    KnownNames clips("clip");
    const std::vector<std::string> names{"Idle",      "Jump_A", "Sit",   "Running", "Walking_Backwards",
                                         "Walking_A", "Lie",    "Hit",   "Death",   "Wave",
                                         "Block",     "Cheer",  "Throw", "Roll"};
    for (const std::string& name : names) clips.add(name);
    EXPECT_EQ(
        clips.unknown("walk"),
        "there is no clip 'walk'; did you mean 'Walking_A'? There are: Walking_Backwards, Walking_A, Idle, Jump_A, "
        "Sit, Running, Lie, Hit, Death, Wave, Block, Cheer, … (14 in all)");
    EXPECT_EQ(clips.unknown("jmp_a").substr(0, 60), "there is no clip 'jmp_a'; did you mean 'Jump_A'? There are: ");
    EXPECT_EQ(clips.unknown("it").substr(0, 46), "there is no clip 'it'; did you mean 'Sit'? The")
        << "a letter is missing";
    EXPECT_EQ(clips.unknown("swim").substr(0, 48), "there is no clip 'swim'. There are: Idle, Jump_A");
}

TEST(Json, APlaceHasItsLine) {
    const JsonText text("{\n\"a\": [\n1,\n{\"b\": 2}\n],\n\"ab\":\n3}", JsonAuthor::kPerson);
    EXPECT_EQ(text.located("f", ""), "f:1");
    EXPECT_EQ(text.located("f", "a"), "f:2: a");
    EXPECT_EQ(text.located("f", "a[0]"), "f:3: a[0]");
    EXPECT_EQ(text.located("f", "a[1].b"), "f:4: a[1].b");
    EXPECT_EQ(text.located("f", "a[1].c.d"), "f:4: a[1].c.d") << "that of what is around it";
    EXPECT_EQ(text.located("f", "ab"), "f:6: ab") << "that of the key";
}

TEST(Json, TooDeepNestingIsRefused) {
    const std::string deep(kProgramNestingLimit + 1, '[');
    EXPECT_EQ(error_of_reading([&] { JsonText(deep, JsonAuthor::kProgram); }),
              "the JSON is nested deeper than the limit of 64");
    EXPECT_EQ(error_of_reading([&] { JsonText(deep, JsonAuthor::kPerson, "x"); }),
              "x:1: the JSON is nested deeper than the limit of 32");
    EXPECT_EQ(error_of_reading([&] { JsonText(deep.substr(1), JsonAuthor::kProgram); }).substr(0, 24),
              "the JSON cannot be read:");
}

// In any order. Of several members with one key, the last one counts.
TEST(Json, MembersOfProgramsAreFoundByTheirKeys) {
    constexpr uint64_t kCount = 1000;
    std::string text = "{";
    for (uint64_t i = 0; i < kCount; ++i) {
        const uint64_t key = i * 389 % kCount;  // a permutation of the keys
        text += "\"k" + std::to_string(key) + "\": " + std::to_string(key) + ", ";
    }
    const JsonText json(text + "\"k7\": 70, \"k7\": 77}", JsonAuthor::kProgram);
    EXPECT_EQ(json.view().size(), kCount);
    for (uint64_t key = 0; key < kCount; ++key)
        EXPECT_EQ(json.view().required_uint("k" + std::to_string(key)), key == 7 ? 77 : key);
    EXPECT_FALSE(json.view().has("k"));
    EXPECT_FALSE(json.view().has("k1000"));
}

TEST(Json, LongKeysAreCutInPlaces) {
    const std::string key(100'000, 'a');
    EXPECT_LT(place_of("masks", key).size(), 1000u);
}

// std::tolower() depends on the locale: in Turkish, 'I' is not the upper case of 'i'.
TEST(Text, CaseConversionIsAsciiOnly) {
    EXPECT_EQ(ascii_lower("AZaz09[@`{_\xC4\xB0\xDD"), "azaz09[@`{_\xC4\xB0\xDD");
    std::string alphanumeric;
    for (int c = 0; c < 256; ++c)
        if (is_ascii_alphanumeric(static_cast<char>(c))) alphanumeric += static_cast<char>(c);
    EXPECT_EQ(alphanumeric, "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz");
}

}  // namespace
}  // namespace throng
