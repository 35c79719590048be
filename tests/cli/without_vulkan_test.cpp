// Machines without Vulkan, and devices that do not need it. Each case is a separate process, since a library stays
// loaded.
#include "tests/tool_runner.h"

namespace throng {
namespace {

using namespace test;

class WithoutVulkan : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        generate("creature.glb", "--joints 30 --levels 8");
        write("no_vulkan/libvulkan.so.1", "");
        write("no_vulkan/libvulkan.so", "");
    }
    // As on a machine without a Vulkan loader: the file in its place is not a library.
    static RunSettings no_loader() {
        return {.environment = {{"LD_LIBRARY_PATH", file("no_vulkan")}}, .program = THRONG_WITHOUT_VULKAN};
    }
};

TEST_F(WithoutVulkan, TheNativeDeviceUpdatesAndDraws) {
    const Outcome run = run_tool({file("creature.glb"), "native"}, no_loader());
    EXPECT_TRUE(run.succeeded()) << run;
    EXPECT_EQ(run.out, "native, moves, is seen, no Vulkan\n");
}

TEST_F(WithoutVulkan, TheNativeDeviceIsChosen) {
    const Outcome run = run_tool({file("creature.glb")}, no_loader());
    EXPECT_TRUE(run.succeeded()) << run;
    EXPECT_EQ(run.out, "native, moves, is seen, no Vulkan\n");
}

TEST_F(WithoutVulkan, AnotherDeviceIsRefused) {
    const Outcome run = run_tool({file("creature.glb"), "cpu"}, no_loader());
    EXPECT_EQ(run.exit_code, 1) << run;
    EXPECT_NE(run.err.find("Vulkan"), std::string::npos) << run;
}

// The native device does not load Vulkan even where it is installed.
TEST_F(WithoutVulkan, TheNativeDeviceDoesNotLoadVulkan) {
    const Outcome native = run_tool({file("creature.glb"), "native"}, {.program = THRONG_WITHOUT_VULKAN}),
                  software = run_tool({file("creature.glb"), "cpu"}, {.program = THRONG_WITHOUT_VULKAN});
    EXPECT_EQ(native.out, "native, moves, is seen, no Vulkan\n") << native;
    EXPECT_EQ(software.out, "cpu, moves, is seen, Vulkan\n") << software;
}

}  // namespace
}  // namespace throng
