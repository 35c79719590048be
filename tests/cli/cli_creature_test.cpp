// Creatures that the command line writes, read by other programs: three.js and the Khronos validator.
#include "tests/tool_runner.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace throng::test {
namespace {

class CliCreature : public ToolTest {};

struct Kind {
    const char *name, *clip;
    size_t joint_count;
};

TEST_F(CliCreature, ThreeJsComputesTheSamePoses) {
    if (run_tool("-e require('fs').accessSync('/usr/share/javascript/three/three.js')", {.program = "node"})
            .exit_code != 0)
        GTEST_SKIP() << "no node, or no libjs-three";
    for (const Kind& kind : {Kind{"dragon", "fly", 300}, Kind{"willow", "gust", 240}, Kind{"walker", "run", 160},
                             Kind{"centipede", "walk", 1000}}) {
        SCOPED_TRACE(kind.name);
        generate("creature.glb", {kind.name});
        const Outcome run = succeed({THRONG_SOURCE_DIR "/tests/three_reader.js", "creature.glb", kind.clip, "0.37"},
                                    {.program = "node"});
        const Json read = Json::parse(run.out);
        const Json wanted = json_of(
            {"pose", "creature.glb", "--clip", kind.clip, "--time", "0.37", "--reference"})["skins"][0]["jointWorld"];
        EXPECT_GE(read["clips"].size(), 2u);
        EXPECT_GE(read["faces"], 1000);
        EXPECT_LE(read["faces"], 3000);
        ASSERT_EQ(read["joints"].size(), kind.joint_count);
        ASSERT_EQ(wanted.size(), kind.joint_count);
        double worst = 0, largest = 0;
        for (size_t joint = 0; joint < kind.joint_count; ++joint)
            for (size_t i = 0; i < 16; ++i) {
                worst = std::max(worst,
                                 std::abs(read["joints"][joint][i].get<double>() - wanted[joint][i].get<double>()));
                largest = std::max(largest, std::abs(wanted[joint][i].get<double>()));
            }
        EXPECT_LE(worst, 1e-5 * largest);
    }
}

TEST_F(CliCreature, TheKhronosValidatorFindsNoIssues) {
    if (run_tool("-e require('gltf-validator')", {.program = "node"}).exit_code != 0)
        GTEST_SKIP() << "no gltf-validator: 'npm install gltf-validator', and NODE_PATH set to its node_modules";
    for (const char* arguments : {"dragon", "willow", "walker", "centipede", "dragon --levels 120",
                                  "walker --joints 90 --levels 15 --seed 5"}) {
        generate("creature.glb", arguments);
        const Outcome run = succeed({THRONG_SOURCE_DIR "/tests/khronos_validator.js", "creature.glb"},
                                    {.program = "node"});
        const Json found = Json::parse(run.out);
        for (const char* severity : {"errors", "warnings", "infos", "hints"})
            EXPECT_EQ(found[severity], 0) << arguments << ": " << found;
    }
}

}  // namespace
}  // namespace throng::test
