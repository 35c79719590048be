// Which fused form a character gets on a device, and what rules one out.
#include "fused/fused.h"
#include "gpu/spirv_info.h"
#include "scan/scan_planner.h"
#include "scan/scan_shaders.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"

namespace throng {
namespace {

using namespace test;

// Limits like those of a GPU: 48 KiB of shared memory, subgroups of 32.
constexpr ScanLimits kHardware{
    .shared_memory_bytes = 49152, .workgroup_size = 1024, .subgroup_size = 32, .shuffle = true, .is_cpu = false};

Character character_of(uint32_t joint_count, double scale_spread) {
    return make_character({.joint_count = joint_count,
                           .scale_spread = scale_spread,
                           .clip_count = 1,
                           .axis_count = 1,
                           .key_count = 2,
                           .vertex_count = 3});
}

TEST(Fused, AGpuTakesTheFirstMethodThatFits) {
    struct Case {
        uint32_t joint_count;
        double scale_spread;
        uint32_t shared_memory_bytes;
        const char* wanted;  // empty: none
    };
    // Parents are kept for children in later chunks, at 32 or 48 bytes each, for two characters per workgroup.
    for (const Case& c :
         {Case{64, 0, 49152, "stream:32"}, Case{64, 0.1, 49152, "stream:32"}, Case{1100, 0, 49152, "stream:32"},
          Case{1100, 0.1, 49152, "stream:32"}, Case{1100, 0.1, 64, ""}}) {
        ScanLimits limits = kHardware;
        limits.shared_memory_bytes = c.shared_memory_bytes;
        const FusedPlan plan = choose_fused(FusedRig(character_of(c.joint_count, c.scale_spread)), limits);
        const std::string where = std::to_string(c.joint_count) + " joints, scale spread " +
                                  std::to_string(c.scale_spread);
        EXPECT_EQ(plan.unsupported_reason.empty() ? name_of(plan.choice) : "", c.wanted)
            << where << ": " << plan.unsupported_reason;
        if (plan.unsupported_reason.empty()) {
            EXPECT_EQ(plan.tile_transforms, 0u) << where;
        } else {
            EXPECT_NE(plan.unsupported_reason.find("device's 64"), std::string::npos) << plan.unsupported_reason;
        }
    }
}

// If a device can hold more subgroups than there are characters, several share a character: as many as have chunks of
// their own. Small characters, several of which may share a chunk, are an exception.
TEST(Fused, SubgroupsShareTheCharactersOfSmallCrowds) {
    ScanLimits limits = kHardware;
    limits.largest_subgroup_size = 32;
    const auto chosen = [&](uint32_t joint_count, double subgroups) {
        return name_of(choose_fused(FusedRig(character_of(joint_count, 0)), limits, subgroups).choice);
    };
    EXPECT_EQ(chosen(300, 0), "stream:32");
    EXPECT_EQ(chosen(300, 1.9), "stream:32");
    EXPECT_EQ(chosen(300, 2), "stream:64");
    EXPECT_EQ(chosen(300, 3.9), "stream:64");
    EXPECT_EQ(chosen(300, 1000), "stream:128");
    EXPECT_EQ(chosen(97, 1000), "stream:128");
    EXPECT_EQ(chosen(96, 1000), "stream:64");
    EXPECT_EQ(chosen(65, 1000), "stream:64");
    EXPECT_EQ(chosen(64, 1000), "stream:32");
    limits.workgroup_size = 64;
    EXPECT_EQ(chosen(300, 1000), "stream:64");
    limits.workgroup_size = 1024;
    limits.largest_subgroup_size = 0;  // it may also be 64, where two chunks share one
    EXPECT_EQ(chosen(300, 1000), "stream:32");
    limits.subgroup_size = limits.largest_subgroup_size = 64;
    EXPECT_EQ(chosen(300, 1000), "stream:32");
}

// A method that is asked for by name has a tile of 2 characters and 64 lanes: 2 * joints * 32 bytes of similarities, or
// 48 of affines, and 64 slots of the same size beside it.
TEST(Fused, TheTileMustFitInSharedMemory) {
    const auto plan_of = [](const char* method, uint32_t joint_count) {
        return plan_fused({find_scan_method(method), 32}, FusedRig(character_of(joint_count, 0)), kHardware);
    };
    for (const auto& [method, joint_count] : {std::pair{"subgroup_quaternion", 700u}, std::pair{"subgroup", 64u}}) {
        const FusedPlan plan = plan_of(method, joint_count);
        EXPECT_EQ(plan.unsupported_reason, "");
        EXPECT_EQ(plan.tile_transforms, plan.scan.instances_per_workgroup * joint_count);
    }
    for (const auto& [method, joint_count] : {std::pair{"subgroup_quaternion", 1100u}, std::pair{"subgroup", 700u}})
        EXPECT_NE(plan_of(method, joint_count).unsupported_reason.find("49152"), std::string::npos) << method;
}

// To the byte: the tile, and at least an element of each array that the method declares.
TEST(Fused, SharedMemoryIsTheTileAndTheMethodsArrays) {
    const FusedRig rig(character_of(1, 0.1));
    for (const char* name : {"doubling", "levels", "blocks64", "compressed"}) {
        ScanLimits limits = kHardware;
        limits.shared_memory_bytes = 48 + 96;
        EXPECT_EQ(plan_fused({find_scan_method(name), 0}, rig, limits).unsupported_reason, "") << name;
        --limits.shared_memory_bytes;
        EXPECT_NE(plan_fused({find_scan_method(name), 0}, rig, limits).unsupported_reason.find("143"),
                  std::string::npos)
            << name;
    }
}

TEST(Fused, TooFewStorageBuffersAreAnObstacle) {
    const Character character = small_character();
    ScanLimits limits = kHardware;
    const auto needed = static_cast<uint32_t>(read_spirv(scan_shaders("subgroup").fused).bindings.size());
    EXPECT_GE(needed, 10u);
    limits.storage_buffers = needed;
    EXPECT_EQ(choose_fused(FusedRig(character), limits).unsupported_reason, "");
    --limits.storage_buffers;
    EXPECT_EQ(
        choose_fused(FusedRig(character), limits).unsupported_reason,
        std::to_string(needed) + " storage buffers in one kernel exceed the device's " + std::to_string(needed - 1));

    const Device device = another_device();
    device.gpu()->properties.limits.maxPerStageDescriptorStorageBuffers = needed - 1;
    const Result<Crowd> crowd = Crowd::create(device, {.groups = {{&character, 2}}});
    ASSERT_TRUE(crowd) << crowd.error().text();
    EXPECT_FALSE(crowd->path(0)->is_fused);
    EXPECT_NE(crowd->path(0)->reason.find("storage buffers"), std::string::npos) << crowd->path(0)->reason;
    const Result<Crowd> refused = Crowd::create(device, {.groups = {{&character, 2}}, .path = UpdatePath::kFused});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);

    device.gpu()->properties.limits.maxPerStageDescriptorStorageBuffers = 1;
    const Result<Crowd> none = Crowd::create(device, {.groups = {{&character, 2}}});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::kLimit);
    EXPECT_NE(none.error().text().find("storage buffers exceed the device's 1 (maxPerStageDescriptorStorageBuffers)"),
              std::string::npos)
        << none.error().text();
}

TEST(Fused, TablesAreNamedWhereTheDeviceCannotReadThem) {
    const Character character = make_character({.name = "Fox", .joint_count = 20, .key_count = 60});
    const uint64_t keys = character.keys.size();
    Result<Device> device = Device::create({.select = test_device().info().name});
    ASSERT_TRUE(device) << device.error().text();
    if (!device->gpu()->uses_software_kernels()) GTEST_SKIP() << "tables are storage buffers here";
    VkPhysicalDeviceLimits& limits = device->gpu()->properties.limits;
    limits.maxStorageBufferRange = static_cast<uint32_t>(keys * 16 - 16);  // which does not limit tables
    Result<Crowd> crowd = Crowd::create(*device, {.groups = {{&character, 1}}});
    ASSERT_TRUE(crowd) << crowd.error().text();
    const Playback playback{.first = {.clip = 1, .time_s = 0.7}, .weight = 1};
    ASSERT_TRUE(crowd->set_playback(InstanceHandle{0}, playback));
    ASSERT_TRUE(crowd->update(0));
    EXPECT_LE(instance_error(*crowd, 0, character, playback), kPoseBound);
    limits.maxTexelBufferElements = static_cast<uint32_t>(keys - 1);
    const Result<Crowd> refused = Crowd::create(*device, {.groups = {{&character, 1}}});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kLimit);
    EXPECT_EQ(refused.error().text(), "Fox: keys: a table of " + std::to_string(keys) +
                                          " elements exceeds the device's " + std::to_string(keys - 1) +
                                          " (maxTexelBufferElements)");
}

TEST(Fused, LargeRigsAreStagedUnlessFusedIsRequested) {
    const Character large = make_character({.name = "large",
                                            .joint_count = 65535,
                                            .shape = RigShape::kBushy,
                                            .scale_spread = 0,
                                            .clip_count = 1,
                                            .axis_count = 1,
                                            .key_count = 2});
    const ScanLimits limits = scan_limits(*test_gpu());
    const FusedPlan plan = choose_fused(FusedRig(large), limits);
    if (plan.unsupported_reason.empty()) GTEST_SKIP() << "on this device it fits";
    const Crowd crowd = create({.groups = {{&large, 2}}});
    EXPECT_FALSE(crowd.path(0)->is_fused);
    EXPECT_NE(crowd.path(0)->reason.find(plan.unsupported_reason), std::string::npos) << crowd.path(0)->reason;
    const Result<Crowd> refused = Crowd::create(test_device(), {.groups = {{&large, 2}}, .path = UpdatePath::kFused});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
    const Character character = small_character();
    EXPECT_FALSE(create({.groups = {{&character, 2}}, .scan = "gateau2012_walk"}).path(0)->is_fused)
        << "it has no fused form";
    EXPECT_TRUE(create({.groups = {{&character, 2}}}).path(0)->is_fused);
}

}  // namespace
}  // namespace throng
