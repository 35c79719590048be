// Compile-only devices on the command line, and `throng bench isa`.
#include "tests/tool_runner.h"

#include <nlohmann/json.hpp>

namespace throng {
namespace {

using namespace test;

const char* const kDriverFile = "/usr/share/vulkan/icd.d/radeon_icd.x86_64.json";  // Debian: mesa-vulkan-drivers

class Isa : public ToolTest {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kDriverFile)) GTEST_SKIP() << kDriverFile << " is not there";
    }
    static RunSettings without_hardware() {
        return {.environment = {{"VK_DRIVER_FILES", kDriverFile}, {"RADV_FORCE_FAMILY", "navi21"}}};
    }
};

TEST_F(Isa, ADeviceWithoutHardwareIsListedAndRefused) {
    const Outcome list = run_tool("devices", without_hardware());
    EXPECT_TRUE(list.succeeded()) << list;
    EXPECT_NE(list.out.find("compiles only"), std::string::npos) << list;
    const Json devices = json_of("devices --json", without_hardware());
    EXPECT_EQ(devices[0]["compiles_only"], true);
    EXPECT_EQ(devices[0]["usable"], false);
    EXPECT_EQ(devices[1]["compiles_only"], false);

    generate("creature.glb", "--joints 20 --levels 8");
    for (const std::string command : {"render creature.glb --out creature.png", "bench", "tune"})
        EXPECT_TRUE(run_tool(command + " --device navi21", without_hardware()).refused("it only compiles")) << command;
    // Commands that need a device and may choose take another one
    EXPECT_TRUE(run_tool("render creature.glb --out creature.png --size 32x32", without_hardware()).exit_code == 0);
}

// As in a container that has the driver of an absent graphics card: the Vulkan loader then returns an error.
TEST_F(Isa, DriversWithoutHardwareAreNoDevices) {
    const RunSettings only_a_driver{.environment = {{"VK_DRIVER_FILES", kDriverFile}}};
    const Json devices = json_of("devices --json", only_a_driver);
    if (devices.size() > 1) GTEST_SKIP() << "this machine has that hardware";
    EXPECT_EQ(devices[0]["type"], "native");
    generate("creature.glb", "--joints 20 --levels 8");
    EXPECT_TRUE(run_tool("pose creature.glb", only_a_driver).succeeded());
}

TEST_F(Isa, MissingDriversAndFamiliesAreErrors) {
    EXPECT_TRUE(run_tool("bench isa", {.environment = {{"VK_DRIVER_FILES", "/nowhere.json"}}}).refused("driver"));
    EXPECT_GT(run_tool("bench isa --family voodoo").exit_code, 0);
}

}  // namespace
}  // namespace throng
