// Listing, choosing, sharing and adopting devices.
#include "gpu/gpu.h"
#include "scan/scan_costs.h"
#include "tests/application.h"
#include "tests/files.h"
#include "tests/kernel_runner.h"
#include "tests/test_device.h"
#include "tests/test_rig.h"

#include <cctype>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

namespace throng {
namespace {

using namespace test;

std::vector<DeviceInfo> list() {
    const Result<std::vector<DeviceInfo>> infos = Device::list();
    EXPECT_TRUE(infos) << infos.error().text();
    return infos ? *infos : std::vector<DeviceInfo>{};
}

std::string swapped_case(std::string text) {
    for (char& c : text)
        c = static_cast<char>(std::isupper(static_cast<unsigned char>(c)) ? std::tolower(c) : std::toupper(c));
    return text;
}

TEST(Device, TheListNamesTheDevices) {
    const std::vector<DeviceInfo> infos = list();
    ASSERT_FALSE(infos.empty());
    for (uint32_t i = 0; i < infos.size(); ++i) {
        EXPECT_EQ(infos[i].index, i);
        EXPECT_FALSE(infos[i].name.empty());
        EXPECT_FALSE(infos[i].type.empty());
        EXPECT_FALSE(infos[i].driver.empty());
        EXPECT_EQ(infos[i].type == "native", i + 1 == infos.size());
        if (!infos[i].usable || infos[i].type == "native") continue;
        EXPECT_GE(infos[i].api_version, VK_API_VERSION_1_3);
        EXPECT_GE(infos[i].subgroup_size, 1u);
        EXPECT_GE(infos[i].shared_memory_bytes, 16384u);
        EXPECT_GE(infos[i].storage_buffer_range_bytes, uint64_t{1} << 27);
    }
}

TEST(Device, IsSelectedByIndexTypeOrName) {
    for (const DeviceInfo& info : list()) {
        if (!info.usable) continue;
        const Result<Device> by_index = Device::create({.select = std::to_string(info.index)});
        ASSERT_TRUE(by_index) << by_index.error().text();
        EXPECT_EQ(by_index->info().name, info.name);
        // The native device is found by its full name: part of its processor's name may also be part of a GPU's.
        const std::string part = info.type == "native" ? info.type : info.name.substr(1, 6);
        const Result<Device> by_name = Device::create({.select = swapped_case(part)});
        ASSERT_TRUE(by_name) << by_name.error().text();
        EXPECT_NE(by_name->info().name.find(part), std::string::npos);
        if (info.type != "cpu") continue;
        const Result<Device> cpu = Device::create({.select = "cpu"});
        ASSERT_TRUE(cpu) << cpu.error().text();
        EXPECT_EQ(cpu->info().type, "cpu");
    }
    const Result<Device> any = Device::create();
    ASSERT_TRUE(any) << any.error().text();
    EXPECT_TRUE(any->info().usable);
    EXPECT_EQ(any->validation_message_count(), 0u);
}

TEST(Device, AnUnknownDeviceIsRefusedAndTheOthersAreNamed) {
    for (const std::string& select :
         {std::string("Voodoo 2"), std::string("99"), std::string("99999999999999999999")}) {
        const Result<Device> device = Device::create({.select = select});
        ASSERT_FALSE(device);
        EXPECT_EQ(device.error().code, ErrorCode::kNoDevice);
        EXPECT_NE(device.error().text().find("'" + select + "'"), std::string::npos) << device.error().text();
        for (const DeviceInfo& info : list())
            EXPECT_NE(device.error().text().find(info.name), std::string::npos) << device.error().text();
    }
    EXPECT_TRUE(Device::create()) << "after refusals";
}

// A crowd and the pose that it must show.
struct Show {
    Show(const Device& device, const Character& character_in, double time_s)
        : character(character_in),
          playback{.first = {.clip = 0, .time_s = time_s}},
          crowd(Crowd::create(device, {.groups = {{&character, 2}}}).value()) {
        EXPECT_TRUE(crowd.set_playback(InstanceHandle{1}, playback));
    }
    void update_and_compare(float step_s) {
        ASSERT_TRUE(crowd.update(step_s));
        playback.first.time_s += step_s;
        const ReferencePose wanted = *reference_pose(character, playback);
        const Result<std::vector<Affine>> skin = crowd.read_skin_matrices({1});
        ASSERT_TRUE(skin) << skin.error().text();
        for (size_t i = 0; i < skin->size(); ++i)
            EXPECT_LE(matrix_error((*skin)[i], wanted.model_from_bind[i], character.size), 1e-5);
    }

    const Character& character;
    Playback playback;
    Crowd crowd;
};

TEST(Device, SeveralDevicesWorkSideBySide) {
    const Character character = make_character({});
    std::optional<Device> second = Device::create({.select = test_device().info().name}).value();
    Show first_show(test_device(), character, 0.1), second_show(*second, character, 0.4);
    for (int i = 0; i < 3; ++i) {
        first_show.update_and_compare(0.11f);
        second_show.update_and_compare(0.07f);
        const Device third = Device::create({.select = test_device().info().name}).value();
        Show(third, character, 0.2).update_and_compare(0);
    }
    second.reset();  // the crowd keeps its device
    second_show.update_and_compare(0.07f);
    list();
    first_show.update_and_compare(0.11f);
}

// Instance-level Vulkan functions are shared by the process. A validated device must still work after an unvalidated
// one is created, and be destroyed correctly after that one.
TEST(Device, AValidatedDeviceOutlivesOthers) {
    Result<Device> validated = Device::create(
        {.select = test_device().info().name, .validation = Validation::kStandard});
    if (!validated && validated.error().code == ErrorCode::kNoDevice) GTEST_SKIP() << validated.error().text();
    ASSERT_TRUE(validated) << validated.error().text();
    const std::optional<Device> plain = Device::create({.select = test_device().info().name}).value();
    list();
    const Character character = make_character({});
    Show(*validated, character, 0.1).update_and_compare(0.2f);
    EXPECT_EQ(validated->validation_message_count(), 0u);
}

TEST(Device, AdoptRefusesNullHandles) {
    const Gpu& gpu = *test_device().gpu();
    const auto instance = reinterpret_cast<VkInstance>(gpu.device);  // never looked at
    for (const AdoptedDevice& adopted :
         {AdoptedDevice{},
          AdoptedDevice{.physical_device = gpu.physical_device, .device = gpu.device, .queue = gpu.queue},
          AdoptedDevice{.instance = instance, .device = gpu.device, .queue = gpu.queue},
          AdoptedDevice{.instance = instance, .physical_device = gpu.physical_device, .queue = gpu.queue},
          AdoptedDevice{.instance = instance, .physical_device = gpu.physical_device, .device = gpu.device}}) {
        const Result<Device> device = Device::adopt(adopted);
        ASSERT_FALSE(device);
        EXPECT_EQ(device.error().code, ErrorCode::kInvalidArgument);
    }
}

// Throng cannot query which features the application has enabled. AdoptedDevice must say so.
TEST(Device, AnAdoptedDeviceUsesTheDeclaredFeatures) {
    const Gpu& of_throng = *test_device().gpu();
    const Application application;
    AdoptedDevice adopted = application.adopted();
    for (const bool told : {false, true}) {
        adopted.subgroup_size_control = told && of_throng.can_choose_subgroup;
        adopted.compute_full_subgroups = told && of_throng.has_full_subgroups;
        const Device device = Device::adopt(adopted).value();
        EXPECT_EQ(device.gpu()->can_choose_subgroup, adopted.subgroup_size_control);
        EXPECT_EQ(device.gpu()->has_full_subgroups, adopted.compute_full_subgroups);
        const Character character = make_character({});
        Show(device, character, 0.1).update_and_compare(0.2f);
    }
}

TEST(Device, AnAdoptedDeviceIsLeftIntact) {
    const Application application;
    {
        const Result<Device> device = Device::adopt(application.adopted());
        ASSERT_TRUE(device) << device.error().text();
        EXPECT_EQ(device->info().name, test_device().info().name);
        const Character character = make_character({});
        Show(*device, character, 0.1).update_and_compare(0.2f);
    }
    // The Device may outlive the application's device, so it must keep no objects of it.
    const Character character = make_character({});
    Device device = Device::adopt(application.adopted()).value();
    uint64_t of_one = 0;
    for (uint64_t made = 1; made <= 2; ++made) {
        EXPECT_TRUE(Crowd::create(device, {.groups = {{&character, 2}}, .path = UpdatePath::kDevice})->update(0));
        if (made == 1) of_one = device.gpu()->counts.pipelines;
        EXPECT_GT(of_one, 1u);
        EXPECT_EQ(device.gpu()->counts.pipelines, made * of_one) << "no pipeline is kept for the next crowd";
        EXPECT_EQ(device.gpu()->memory.block_count(), 0u);
    }
    EXPECT_EQ(application.table.vkDeviceWaitIdle(application.device), VK_SUCCESS) << "the device lives on";
    AdoptedDevice wrong = application.adopted();
    wrong.queue_family = static_cast<uint32_t>(application.families.size());
    const Result<Device> refused = Device::adopt(wrong);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
    wrong = application.adopted();
    wrong.threads = 5000;
    const Result<Device> crowded = Device::adopt(wrong);
    ASSERT_FALSE(crowded);
    EXPECT_EQ(crowded.error().text(), "adopted device: 5000 threads exceed the limit of 1024");
    EXPECT_TRUE(Device::adopt(application.adopted())) << "after a refusal";
}

// Such instances need not provide the functions of Vulkan 1.3, and Mesa's do not. NVIDIA's do, and its device works.
TEST(Device, AnOlderInstanceWithoutVulkan13CallsIsNotAdopted) {
    for (const uint32_t version : {0u, VK_API_VERSION_1_1, VK_API_VERSION_1_2}) {
        const Application application(version);
        const Result<Device> device = Device::adopt(application.adopted());
        if (device && !test_gpu()->is_cpu()) {
            Show(*device, make_character({}), 0.1).update_and_compare(0.2f);
            continue;
        }
        ASSERT_FALSE(device);
        EXPECT_EQ(device.error().text(),
                  "adopted device: its instance was created for a Vulkan version below 1.3: set "
                  "VkApplicationInfo::apiVersion to VK_API_VERSION_1_3");
    }
}

TEST(Device, BuffersOfAnApplicationsDeviceAreSharedByItsQueueFamilies) {
    const Application application;
    AdoptedDevice adopted = application.adopted();
    const auto family_count = static_cast<uint32_t>(application.families.size());
    adopted.more_queue_families = {family_count};
    const Result<Device> refused = Device::adopt(adopted);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().text().find("queue family " + std::to_string(family_count)), std::string::npos);
    adopted.more_queue_families.clear();
    for (uint32_t family = 0; family < family_count; ++family) adopted.more_queue_families.push_back(family);
    const Device device = Device::adopt(adopted).value();
    EXPECT_EQ(device.gpu()->sharing_families.size(), family_count > 1 ? family_count : 0)
        << "its own queue's family is no other";
    Show(device, make_character({}), 0.1).update_and_compare(0.2f);
}

TEST(Device, AnApplicationsPipelineCacheIsUsed) {
    const Application application;
    VkPipelineCacheCreateInfo create{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    AdoptedDevice adopted = application.adopted();
    EXPECT_EQ(Device::adopt(adopted)->gpu()->pipeline_cache(), VkPipelineCache{VK_NULL_HANDLE});
    ASSERT_EQ(application.table.vkCreatePipelineCache(application.device, &create, nullptr, &adopted.pipeline_cache),
              VK_SUCCESS);
    {
        const Device device = Device::adopt(adopted).value();
        EXPECT_EQ(device.gpu()->pipeline_cache(), adopted.pipeline_cache);
        const Character character = make_character({});
        Show(device, character, 0.1).update_and_compare(0.2f);
    }
    application.table.vkDestroyPipelineCache(application.device, adopted.pipeline_cache, nullptr);
}

TEST(Device, ScanCostsAreReadFromTheCacheIfPresent) {
    const Gpu& gpu = *test_device().gpu();
    ScanCosts kept = built_in_scan_costs(gpu);
    kept.units = 80;
    kept.origin = "test";
    const char* before = std::getenv("XDG_CACHE_HOME");
    const std::string saved = before ? before : "";
    const TemporaryFolder folder;
    setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
    EXPECT_EQ(scan_costs(gpu).origin, built_in_scan_costs(gpu).origin);
    const std::filesystem::path file = scan_costs_file(gpu);
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << to_json(kept);
    EXPECT_EQ(scan_costs(gpu).origin, "test");
    EXPECT_EQ(scan_costs(gpu).units, 80);
    std::ofstream(file) << "{";
    const ScanCosts costs = scan_costs(gpu);
    EXPECT_EQ(costs.row_ns, built_in_scan_costs(gpu).row_ns) << "a damaged file is not used";
    EXPECT_NE(costs.origin.find(file.string()), std::string::npos) << "and the reason names it: " << costs.origin;
    if (before)
        setenv("XDG_CACHE_HOME", saved.c_str(), 1);
    else
        unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace throng
