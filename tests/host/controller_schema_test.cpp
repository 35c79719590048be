// docs/controller.schema.json accepts and refuses the same files as throng. Skipped without python3-jsonschema.
#include "tests/controller_cases.h"
#include "tests/files.h"
#include "tests/shared.h"

#include <throng/controller.h>

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <random>
#include <sys/wait.h>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

class ControllerSchema : public testing::Test {
protected:
    // They mostly run Python; ControllerJson.ArbitraryBytesDoNotCrash covers the parser under sanitizers
    void SetUp() override { THRONG_SKIP_WHERE_SANITIZED(); }

    // The schema's verdict on each text. Empty if there is no validator.
    std::vector<std::string> verdicts(const std::vector<std::string>& texts) {
        std::string names;
        for (size_t i = 0; i < texts.size(); ++i)
            names += " " + folder_.write(std::to_string(i) + ".json", texts[i]).string();
        const std::string source = THRONG_SOURCE_DIR;
        for (const char* python : {"python3", "/usr/bin/python3"}) {  // Debian's package is for Debian's Python
            const std::string command = std::string(python) + " " + source + "/tests/controller_schema.py " + source +
                                        "/docs/controller.schema.json" + names + " 2>&1";
            std::FILE* pipe = popen(command.c_str(), "r");
            std::string out;
            std::array<char, 4096> block;
            while (const size_t size = std::fread(block.data(), 1, block.size(), pipe)) out.append(block.data(), size);
            const int status = pclose(pipe);
            if (status == 0) return lines(out);
            EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127)) << out;
        }
        return {};
    }

    static std::vector<std::string> lines(const std::string& text) {
        std::vector<std::string> all;
        for (size_t at = 0; at < text.size();) {
            const size_t end = std::min(text.find('\n', at), text.size());
            all.push_back(text.substr(at, end - at));
            at = end + 1;
        }
        return all;
    }

private:
    TemporaryFolder folder_;
};

#define SKIP_WITHOUT_VALIDATOR(verdicts) \
    if (verdicts.empty()) GTEST_SKIP() << "no jsonschema for Python here (Debian: apt-get install python3-jsonschema)"

TEST_F(ControllerSchema, TakesTheExamplesAndWhatThrongReads) {
    std::vector<std::string> texts{kCompleteController, R"({"layers": [{"name": "all"}]})",
                                   R"({"layers": [{"name": "all", "transitions": []}]})"};
    for (const auto& example : fs::directory_iterator(fs::path(THRONG_SOURCE_DIR) / "examples/controllers"))
        texts.push_back(read_file(example.path()));
    EXPECT_GE(texts.size(), 6u);
    const std::vector<std::string> said = verdicts(texts);
    SKIP_WITHOUT_VALIDATOR(said);
    ASSERT_EQ(said.size(), texts.size());
    for (size_t i = 0; i < texts.size(); ++i) EXPECT_EQ(said[i], "valid") << texts[i];
}

TEST_F(ControllerSchema, RefusesWhatASchemaCanTell) {
    std::vector<std::string> texts;
    for (const BrokenController& how : kBrokenControllers) texts.push_back(broken(how));
    const std::vector<std::string> said = verdicts(texts);
    SKIP_WITHOUT_VALIDATOR(said);
    ASSERT_EQ(said.size(), texts.size());
    for (size_t i = 0; i < texts.size(); ++i)
        if (kBrokenControllers[i].schema_tells) {
            EXPECT_NE(said[i], "valid") << kBrokenControllers[i].old << " -> " << kBrokenControllers[i].now;
        }
}

// Puts words of the file in other places: what throng still reads, the schema must accept.
TEST_F(ControllerSchema, IsNeverStricterThanThrong) {
    std::vector<std::string> words{"0", "1", "-1", "0.5", "2.5", "4", "true", "false", "{}", "[]"};
    for (const char* word : {"speed", "side", "alert", "jump", "trigger", "triggered", "legs", "move", "aim",
                             "override", "additive", "cross", "inertial", "upper", "*"})
        words.push_back("\"" + std::string(word) + "\"");
    std::mt19937 random(3);
    std::vector<std::string> texts;
    for (int i = 0; i < 4000; ++i) {
        std::string text = kCompleteController;
        const std::string& old = words[random() % words.size()];
        size_t at = text.find(old, random() % text.size());
        if (at == text.npos) continue;
        text.replace(at, old.size(), words[random() % words.size()]);
        if (parse_controller(text, "") && std::find(texts.begin(), texts.end(), text) == texts.end())
            texts.push_back(text);
    }
    EXPECT_GE(texts.size(), 60u);
    const std::vector<std::string> said = verdicts(texts);
    SKIP_WITHOUT_VALIDATOR(said);
    ASSERT_EQ(said.size(), texts.size());
    for (size_t i = 0; i < texts.size(); ++i) EXPECT_EQ(said[i], "valid") << texts[i];
}

}  // namespace
}  // namespace throng
