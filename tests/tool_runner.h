// Runs the command line as a user would, in a separate process.
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

// The words of a command line, as a list or as a string that is split at spaces.
struct Words : std::vector<std::string> {
    using vector::vector;
    Words(std::vector<std::string> words) : vector(std::move(words)) {}
    Words(const std::string& text);
    Words(const char* text) : Words(std::string(text)) {}

    friend Words operator+(Words words, const Words& more);
};

struct RunSettings {
    std::map<std::string, std::string> environment;
    uint64_t memory_limit_bytes = 0;  // of address space; 0: unlimited
    unsigned time_limit_s = 300;
    const char* program = nullptr;   // another program instead of the tool, found by PATH
    const char* out_path = nullptr;  // file for standard output, which is then not captured
    // Called every few milliseconds while the process runs, with its id and what it has written to stderr.
    std::function<void(int process, const std::string& err)> watch = nullptr;
};

struct Outcome {
    int exit_code = -1;  // -1: ended by a signal
    int signal = 0;
    std::string out, err;
    double time_s = 0;

    // Exit code 0 and nothing on stderr.
    bool succeeded() const { return exit_code == 0 && err.empty(); }
    // A regular exit with an error, and one line on stderr that contains `named`.
    bool refused(const std::string& named) const;
    friend std::ostream& operator<<(std::ostream& stream, const Outcome& outcome);
};

Outcome run_tool(const Words& arguments, const RunSettings& settings = {});

// Tests that run the tool in a temporary folder.
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
    // Writes a creature to that file.
    static void generate(const std::string& name, const Words& arguments);
    // The result of a command that must succeed. If it fails, throws, which ends the test.
    static Outcome succeed(const Words& arguments, const RunSettings& settings = {});
    // The output with --json.
    static Json json_of(const Words& arguments, const RunSettings& settings = {});
    // Each command must fail quickly with one line that contains `named`, print nothing on stdout, and not create or
    // remove files.
    static void expect_refused(const std::vector<Refused>& cases);

    static inline std::unique_ptr<TemporaryFolder> folder_;
};

}  // namespace throng::test
