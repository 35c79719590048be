// Pipelines that kernels share, and the pipeline cache that is kept between program starts.
#include "base/cache_folder.h"
#include "control/control.h"
#include "gpu/pipeline_cache.h"
#include "gpu/shared_kernels.h"
#include "tests/files.h"
#include "tests/kernel_runner.h"
#include "tests/test_rig.h"
#include "scan/scan.h"
#include "scan/scan_shaders.h"

#include <throng/crowd.h>

#include <array>
#include <cstring>
#include <fstream>
#include <numeric>

namespace throng {
namespace {

using namespace test;

// ---- Shared

SharedKernels::Shared made_up() {
    const auto something = std::make_shared<int>(0);
    return {something, reinterpret_cast<const CompiledKernel*>(something.get())};
}

SharedKernels::Key key(uint32_t setting) { return {.code = {}, .settings = {setting}}; }

TEST(SharedKernels, AreKeptWhileUsedAndTheLastOnesLonger) {
    SharedKernels kernels(2);
    EXPECT_EQ(kernels.find(key(1)), nullptr);
    SharedKernels::Shared first = made_up();
    const SharedKernels::Shared used = made_up();
    EXPECT_EQ(kernels.add(key(1), first), first);
    EXPECT_EQ(kernels.add(key(2), used), used);
    EXPECT_EQ(kernels.add(key(1), made_up()), first) << "another thread was faster";
    const CompiledKernel* const address = first.get();
    first.reset();
    EXPECT_EQ(kernels.find(key(1)).get(), address) << "is one of the last two";
    kernels.add(key(3), made_up());
    EXPECT_EQ(kernels.find(key(1)).get(), address) << "was asked for after the second";
    kernels.add(key(4), made_up());
    kernels.add(key(5), made_up());
    EXPECT_EQ(kernels.find(key(1)), nullptr);
    EXPECT_EQ(kernels.find(key(3)), nullptr);
    EXPECT_EQ(kernels.find(key(2)), used) << "somebody uses it";
    EXPECT_EQ(kernels.in_use(), std::vector{used}) << "the fifth is only kept";
    kernels.clear();
    EXPECT_EQ(kernels.find(key(5)), nullptr);
    EXPECT_EQ(kernels.find(key(2)), used);

    SharedKernels none(0);
    none.add(key(1), made_up());
    EXPECT_EQ(none.find(key(1)), nullptr);
}

TEST(SharedKernels, CodeIsComparedByItsWords) {
    const std::vector<uint32_t> code{1, 2, 3}, same = code, other{1, 2, 4}, shorter{1, 2};
    SharedKernels kernels(2);
    const SharedKernels::Shared used = made_up();
    kernels.add({code, {7}}, used);
    EXPECT_EQ(kernels.find({same, {7}}), used);
    EXPECT_EQ(kernels.find({same, {8}}), nullptr);
    EXPECT_EQ(kernels.find({other, {7}}), nullptr);
    EXPECT_EQ(kernels.find({shorter, {7}}), nullptr);
    EXPECT_EQ(kernels.find({std::span(code).first(2), {7}}), nullptr);
}

TEST(Pipelines, EqualKernelsShareAPipeline) {
    const Device device = another_device();
    const std::shared_ptr<Gpu>& gpu = device.gpu();
    gpu->processor.reset();  // like hardware, which creates pipelines with the kernels
    const std::atomic<uint64_t>& made = gpu->counts.pipelines;
    const Kernel one = control_kernel(gpu), same = control_kernel(gpu);
    EXPECT_EQ(made, 1u);
    const ScanMethod& method = *find_scan_method("serial");
    const ScanRig chain(std::array<uint32_t, 5>{kNone, 0, 1, 2, 3});
    std::optional<ScanStage> stage(std::in_place, gpu, ScanChoice{&method, 0}, chain, scan_limits(*gpu));
    EXPECT_EQ(made, 2u);
    const ScanStage again(gpu, {&method, 0}, chain, scan_limits(*gpu));
    EXPECT_EQ(made, 2u);
    const KernelSettings plain{.name = method.name, .spirv = scan_shaders(method.name).plain, .workgroup_size = 48};
    KernelSettings other = plain;
    other.constants = {5};
    const Kernel kernel(gpu, plain), constant(gpu, other);
    EXPECT_EQ(made, 4u) << "another constant";
    other.workgroup_size = 32;
    const Kernel smaller(gpu, other);
    EXPECT_EQ(made, 5u) << "another size";
    EXPECT_EQ(smaller.workgroup_size(), 32u);
    EXPECT_EQ(constant.workgroup_size(), 48u);
    const uint64_t before = made;
    stage.reset();
    stage.emplace(gpu, ScanChoice{&method, 0}, chain, scan_limits(*gpu));
    EXPECT_EQ(made, before) << "the last ones stay";
}

TEST(Pipelines, AnEqualCrowdCompilesNothing) {
    const Device device = another_device();
    const Character character = make_character({});
    const auto updated = [&] {
        Crowd crowd =
            Crowd::create(device, {.groups = {{&character, 2}, {&character, 3}}, .path = UpdatePath::kDevice}).value();
        EXPECT_TRUE(crowd.update(0.1f));
        return crowd.read_skin_matrices({4}).value();
    };
    const std::vector<Affine> first = updated();
    const uint64_t made = device.gpu()->counts.pipelines;
    const std::vector<Affine> second = updated();
    EXPECT_EQ(device.gpu()->counts.pipelines, made);
    ASSERT_EQ(first.size(), second.size());
    EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(Affine)), 0);
}

TEST(Pipelines, SoftwareDevicesCompileOnlyForRecordedUpdates) {
    const Device device = another_device();
    if (!device.gpu()->processor) GTEST_SKIP() << "the test device is not a software device";
    const std::atomic<uint64_t>& made = device.gpu()->counts.pipelines;
    const Character character = make_character({});
    CrowdSettings settings{.groups = {{&character, 2}}, .culling = Culling{}, .skins_once = true};
    Crowd native = Crowd::create(device, settings).value();
    ASSERT_TRUE(native.update(0.1f));
    EXPECT_EQ(made, 0u);
    settings.path = UpdatePath::kDevice;
    Crowd recorded = Crowd::create(device, settings).value();
    EXPECT_EQ(made, 0u);
    // In the second update placements stand still, so cells are made
    ASSERT_TRUE(recorded.update(0.1f) && recorded.update(0.1f));
    const uint64_t once = made;
    EXPECT_GT(once, 2u);
    ASSERT_TRUE(recorded.update(0.1f));
    EXPECT_EQ(made, once);
}

// Spawning needs kernels that the first update, of an empty crowd, does not.
TEST(Pipelines, WarmUpCompilesAheadOnSoftwareDevices) {
    const Character character = make_character({});
    const CrowdSettings settings{
        .groups = {{.character = &character, .capacity = 4}}, .path = UpdatePath::kDevice, .culling = Culling{}};
    const std::array<Affine, 1> place{};
    for (const bool is_warm : {true, false}) {
        const Device device = another_device();
        if (!device.gpu()->processor) GTEST_SKIP() << "the test device is not a software device";
        const std::atomic<uint64_t>& made = device.gpu()->counts.pipelines;
        Crowd crowd = Crowd::create(device, settings).value();
        if (is_warm) {
            ASSERT_TRUE(device.warm_up());
            EXPECT_GT(made, 2u);
        }
        const uint64_t before = made;
        ASSERT_TRUE(crowd.update(0.1f) && crowd.spawn(0, place) && crowd.update(0.1f) && crowd.update(0.1f));
        EXPECT_EQ(made == before, is_warm);
    }
}

// ---- Kept

// The cache data of a driver: its identity, followed by what it remembers.
std::vector<std::byte> driver_data(const VkPhysicalDeviceProperties& device, size_t remembered_bytes) {
    VkPipelineCacheHeaderVersionOne head{sizeof(VkPipelineCacheHeaderVersionOne),
                                         VK_PIPELINE_CACHE_HEADER_VERSION_ONE,
                                         device.vendorID,
                                         device.deviceID,
                                         {}};
    std::ranges::copy(device.pipelineCacheUUID, head.pipelineCacheUUID);
    std::vector<std::byte> data(sizeof head + remembered_bytes);
    std::memcpy(data.data(), &head, sizeof head);
    for (size_t i = sizeof head; i < data.size(); ++i) data[i] = static_cast<std::byte>(i * 7);
    return data;
}

TEST(PipelineCache, ADamagedFileIsNotUsed) {
    const VkPhysicalDeviceProperties& device = test_gpu()->properties;
    const std::vector<std::byte> data = driver_data(device, 50), file = pipeline_cache_bytes(data);
    EXPECT_EQ(pipeline_cache_data(file, device), data);
    for (size_t size = 0; size < file.size(); ++size)
        EXPECT_TRUE(pipeline_cache_data(std::span(file).first(size), device).empty()) << size << " bytes of it";
    for (size_t i = 0; i < file.size(); ++i) {
        std::vector<std::byte> damaged = file;
        damaged[i] ^= std::byte{0x10};
        EXPECT_TRUE(pipeline_cache_data(damaged, device).empty()) << "byte " << i;
    }
    std::vector<std::byte> longer = file;
    longer.push_back({});
    EXPECT_TRUE(pipeline_cache_data(longer, device).empty());
}

TEST(PipelineCache, AnotherDriversFileIsNotUsed) {
    const VkPhysicalDeviceProperties& device = test_gpu()->properties;
    const auto changed = [&](size_t at) {
        std::vector<std::byte> data = driver_data(device, 50);
        data[at] ^= std::byte{0x40};
        return pipeline_cache_data(pipeline_cache_bytes(data), device);
    };
    for (const size_t at : {size_t{0}, size_t{4}, size_t{8}, size_t{12}, size_t{16}, size_t{31}})
        EXPECT_TRUE(changed(at).empty()) << "byte " << at << " of the driver's head";
    EXPECT_FALSE(changed(32).empty()) << "the driver's own";
    std::vector<std::byte> longer_head = driver_data(device, 50);
    longer_head[0] = std::byte{200};
    EXPECT_TRUE(pipeline_cache_data(pipeline_cache_bytes(longer_head), device).empty());
}

// A fake driver that remembers `remembered_bytes`, and the size of the data that the cache was created with.
size_t remembered_bytes = 0, told_bytes = 0;
VkPhysicalDeviceProperties remembering_device{};
PFN_vkCreatePipelineCache driver_create = nullptr;

VKAPI_ATTR VkResult VKAPI_CALL tell(VkDevice device, const VkPipelineCacheCreateInfo* info,
                                    const VkAllocationCallbacks* callbacks, VkPipelineCache* cache) {
    told_bytes = info->initialDataSize;
    VkPipelineCacheCreateInfo empty = *info;
    empty.initialDataSize = 0;
    return driver_create(device, &empty, callbacks, cache);
}

VKAPI_ATTR VkResult VKAPI_CALL remember(VkDevice, VkPipelineCache, size_t* size, void* out) {
    const std::vector<std::byte> data = driver_data(remembering_device, remembered_bytes);
    if (out) std::memcpy(out, data.data(), *size);
    *size = data.size();
    return VK_SUCCESS;
}

// Uses a device of its own.
class PipelineCacheFile : public testing::Test {
protected:
    PipelineCacheFile() {
        Gpu& gpu = *device_.gpu();
        remembering_device = gpu.properties;
        driver_create = std::exchange(gpu.vk.vkCreatePipelineCache, &tell);
        gpu.vk.vkGetPipelineCacheData = &remember;
        remembered_bytes = 100;
        told_bytes = 0;
    }
    void open_and_close() const { PipelineCache(*device_.gpu(), file_); }

    Device device_ = another_device();
    TemporaryFolder folder_;
    std::filesystem::path file_ = folder_.path() / "throng" / "pipelines.bin";
};

TEST_F(PipelineCacheFile, IsReadAtTheSecondStart) {
    open_and_close();
    EXPECT_EQ(told_bytes, 0u);
    EXPECT_TRUE(std::filesystem::exists(file_)) << "and its folder was made";
    remembered_bytes = 300;
    open_and_close();
    EXPECT_EQ(told_bytes, sizeof(VkPipelineCacheHeaderVersionOne) + 100);
    open_and_close();
    EXPECT_EQ(told_bytes, sizeof(VkPipelineCacheHeaderVersionOne) + 300);
    const std::filesystem::path folder = file_.parent_path();
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "nothing unfinished is left";
}

TEST_F(PipelineCacheFile, IsWrittenOnlyIfSomethingWasAdded) {
    open_and_close();
    const auto long_ago = std::filesystem::last_write_time(file_) - std::chrono::hours(1);
    std::filesystem::last_write_time(file_, long_ago);
    open_and_close();
    EXPECT_EQ(std::filesystem::last_write_time(file_), long_ago);
    remembered_bytes = 101;
    open_and_close();
    EXPECT_NE(std::filesystem::last_write_time(file_), long_ago);
}

TEST_F(PipelineCacheFile, IsNotWrittenIfTheDriverReturnsNoData) {
    remembered_bytes = 0;
    open_and_close();
    EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(PipelineCacheFile, IsReplacedIfDamaged) {
    std::filesystem::create_directories(file_.parent_path());
    std::ofstream(file_) << "nonsense";
    open_and_close();
    EXPECT_EQ(told_bytes, 0u);
    open_and_close();
    EXPECT_EQ(told_bytes, sizeof(VkPipelineCacheHeaderVersionOne) + 100);
}

// No folder can be created below /dev/null, not even by root.
TEST_F(PipelineCacheFile, AnUnwritableFolderIsNoError) {
    testing::internal::CaptureStderr();
    PipelineCache(*device_.gpu(), "/dev/null/throng/pipelines.bin");
    PipelineCache(*device_.gpu(), folder_.path());  // exists, but is not a file
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Sets or removes an environment variable, and restores it in the destructor.
class Variable {
public:
    Variable(const char* name, const char* value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        value ? setenv(name, value, 1) : unsetenv(name);
    }
    ~Variable() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }

private:
    const char* name_;
    std::optional<std::string> before_;
};

TEST(PipelineCache, LiesInTheUsersCacheFolder) {
    const VkPhysicalDeviceProperties& device = test_gpu()->properties;
    VkPhysicalDeviceProperties newer = device;
    ++newer.driverVersion;
    EXPECT_NE(pipeline_cache_file(device), pipeline_cache_file(newer));
    EXPECT_EQ(pipeline_cache_file(device).parent_path(), cache_folder());
    {
        const Variable cache("XDG_CACHE_HOME", "/cache"), home("HOME", "/home/fox");
        EXPECT_EQ(cache_folder(), "/cache/throng");
    }
    const Variable cache("XDG_CACHE_HOME", nullptr);
    {
        const Variable home("HOME", "/home/fox");
        EXPECT_EQ(cache_folder(), "/home/fox/.cache/throng");
    }
    const Variable home("HOME", nullptr);
    EXPECT_TRUE(pipeline_cache_file(device).empty());
    EXPECT_TRUE(Device::create({.select = test_device().info().name}));
}

TEST(PipelineCache, ExistsOnlyIfDeviceSettingsEnableIt) {
    const TemporaryFolder folder;
    const Variable cache("XDG_CACHE_HOME", folder.path().c_str());
    const std::filesystem::path file = pipeline_cache_file(test_gpu()->properties);
    const Character character = make_character({});
    for (const bool wants : {false, true}) {
        DeviceSettings settings{.select = test_device().info().name, .pipeline_cache = wants};
        std::optional<Device> device = Device::create(settings).value();
        EXPECT_EQ(device->gpu()->pipeline_cache() != VK_NULL_HANDLE, wants);
        remembering_device = device->gpu()->properties;
        remembered_bytes = 100;
        device->gpu()->vk.vkGetPipelineCacheData = &remember;
        EXPECT_TRUE(Crowd::create(*device, {.groups = {{&character, 2}}}).value().update(0.1f));
        EXPECT_FALSE(std::filesystem::exists(file)) << "it is written when the device goes";
        device.reset();
        EXPECT_EQ(std::filesystem::exists(file), wants);
    }
}

}  // namespace
}  // namespace throng
