// A creature to run commands on, and parsers for the JSON that they print.
#pragma once

#include "tests/tool_runner.h"

#include <nlohmann/json.hpp>

#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace throng::test {

inline constexpr int kCreatureJoints = 40, kCreatureLevels = 12;  // of creature.glb

class ToolTestWithCreature : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        generate("creature.glb", "--joints " + std::to_string(kCreatureJoints) + " --levels " +
                                     std::to_string(kCreatureLevels) + " --faces 600");
    }
};

inline std::set<std::string> keys(const Json& object) {
    std::set<std::string> out;
    for (const auto& [key, value] : object.items()) out.insert(key);
    return out;
}

inline std::set<std::string> set_of(const Words& words) { return {words.begin(), words.end()}; }

// One record per line.
inline std::vector<Json> records_of(const std::string& text) {
    std::vector<Json> records;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) records.push_back(Json::parse(line));
    return records;
}

// Benchmarks write the commit to their records.
inline const RunSettings kOfCommit{.environment = {{"THRONG_COMMIT", "abc1234"}}};

}  // namespace throng::test
