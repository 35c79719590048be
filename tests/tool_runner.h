// Runs the command line as a user does, in a process of its own.
#pragma once

#include "tests/files.h"

#include <gtest/gtest.h>
#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <vector>

namespace throng::test {

using Json = nlohmann::json;

// Words of a command line: as they are, or as a text in which spaces divide them.
struct Words : std::vector<std::string> {
    using vector::vector;
    Words(std::vector<std::string> words) : vector(std::move(words)) {}
    Words(const std::string& text);
    Words(const char* text) : Words(std::string(text)) {}

    friend Words operator+(Words words, const Words& more);
};

struct RunSettings {
    std::map<std::string, std::string> environment;
    uint64_t memory_limit_bytes = 0;  // of the address space; 0: none
    unsigned time_limit_s = 300;
    const char* program = nullptr;   // another one than the tool, of the PATH
    const char* out_path = nullptr;  // where standard output goes; it is not captured then
    // Called every few milliseconds while it runs, with its process and what it has written on stderr.
    std::function<void(int process, const std::string& err)> watch = nullptr;
};

struct Outcome {
    int exit_code = -1;  // -1: a signal
    int signal = 0;
    std::string out, err;
    double time_s = 0;

    // Exit code 0 and not a word on stderr.
    bool succeeded() const { return exit_code == 0 && err.empty(); }
    // An exit code of its own and one line on stderr, which names the thing.
    bool refused(const std::string& named) const;
    friend std::ostream& operator<<(std::ostream& stream, const Outcome& outcome);
};

Outcome run_tool(const Words& arguments, const RunSettings& settings = {});

// What the tool does in a folder of the tests' own, in which it runs.
class ToolTest : public testing::Test {
protected:
    struct Refused {
        Words arguments;
        std::string named;
    };

    static void SetUpTestSuite();
    static void TearDownTestSuite();

    static std::string file(const std::string& name);
    static std::string write(const std::string& name, const std::string& content);
    static std::set<std::filesystem::path> files();
    // A creature in that file.
    static void generate(const std::string& name, const Words& arguments);
    // What a command says that succeeds, as it must: throws else, which ends the test.
    static Outcome succeed(const Words& arguments, const RunSettings& settings = {});
    // What it prints with --json.
    static Json json_of(const Words& arguments, const RunSettings& settings = {});
    // Each in one line that names the thing, with nothing on stdout, soon, and with no file more or less.
    static void expect_refused(const std::vector<Refused>& cases);

    static inline std::unique_ptr<TemporaryFolder> folder_;
};

}  // namespace throng::test
