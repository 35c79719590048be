// Devices without Vulkan against the test device: equal results for any number of threads, and what they refuse.
#include "crowd/batch_plan.h"
#include "crowd/crowd_state.h"
#include "native/native_rig.h"
#include "tests/kernel_runner.h"
#include "tests/lively_crowd.h"

#include <throng/draw.h>

#include <algorithm>
#include <cstdio>
#include <thread>

namespace throng::test {
namespace {

// Runs every other job on another thread and the rest on the caller's, in reverse order.
class BackwardJobs : public JobSystem {
public:
    uint32_t concurrency() const override { return 3; }
    void run(uint32_t count, void (*job)(void* context, uint32_t index), void* context) override {
        const auto every_second = [&](uint32_t odd) {
            for (uint32_t i = count; i-- > 0;)
                if (i % 2 == odd) job(context, i);
        };
        std::thread other(every_second, 1);
        every_second(0);
        other.join();
        job_count_ += count;
    }
    uint64_t job_count() const { return job_count_; }

private:
    uint64_t job_count_ = 0;
};

double difference(std::span<const Affine> a, std::span<const Affine> b, double size) {
    EXPECT_EQ(a.size(), b.size());
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, matrix_error(a[i], b[i].as<double>(), size));
    return worst;
}

// The largest distance between vertices and between joints of two crowds.
double distance(Crowd& a, Crowd& b, uint32_t instance) {
    const std::vector<Vec3<float>> of_a = *a.read_positions({instance}), of_b = *b.read_positions({instance});
    EXPECT_EQ(of_a.size(), of_b.size());
    double worst = 0;
    for (size_t i = 0; i < of_a.size(); ++i)
        worst = worse_of(worst, length(of_a[i].as<double>() - of_b[i].as<double>()));
    const std::vector<Affine> joints_of_a = *a.read_model_matrices({instance}),
                              joints_of_b = *b.read_model_matrices({instance});
    for (size_t i = 0; i < joints_of_a.size(); ++i)
        worst = worse_of(worst, length(transform_point(joints_of_a[i].as<double>(), Vec3<double>{}) -
                                       transform_point(joints_of_b[i].as<double>(), Vec3<double>{})));
    return worst;
}

void expect_alike(UpdatePath path) {
    constexpr uint32_t kUpdates = 50;
    const LivelyCrowd lively(24, 20, 20);
    Crowd native = lively.create_on(native_device(), path), other = lively.create_on(test_device(), path);
    uint64_t event_count = 0;
    std::ptrdiff_t fading = 0;
    double worst = 0, furthest = 0;
    for (uint32_t update = 0; update < kUpdates; ++update) {
        SCOPED_TRACE("update " + std::to_string(update));
        for (Crowd* crowd : {&native, &other}) lively.update(*crowd, update);
        const Feedback got = feedback_of(native), wanted = feedback_of(other);
        EXPECT_TRUE(same_events(got, wanted, rounds_like_the_cpu() ? 0 : 1e-5f));
        event_count += got.events.size();
        ASSERT_EQ(got.watched.size(), lively.watched.size());
        ASSERT_EQ(wanted.watched.size(), lively.watched.size());
        for (size_t i = 0; i < got.watched.size(); ++i) {
            const WatchedInstance &a = got.watched[i], &b = wanted.watched[i];
            ASSERT_EQ(a.instance, b.instance);
            EXPECT_TRUE(same_bits(a.parameters, b.parameters)) << "instance " << a.instance.instance;
            EXPECT_EQ(copy_of(a.layers), copy_of(b.layers)) << "instance " << a.instance.instance;
            fading += std::ranges::count_if(a.layers, [](const auto& layer) { return layer.size() > 1; });
            const double size = lively.size_of(a.instance.instance),
                         place = std::abs(double{b.world_from_model.row[2][3]});
            EXPECT_LE(difference({&a.world_from_model, 1}, {&b.world_from_model, 1}, size + place), kPoseBound);
            EXPECT_LE(difference(a.sockets, b.sockets, size + place), kPoseBound) << "instance " << a.instance.instance;
            furthest = std::max(furthest, place);
        }
        if (update % 7 != 0) continue;
        for (uint32_t i = 0; i < lively.instance_count; ++i) {
            worst = std::max(worst, distance(native, other, i) / lively.size_of(i));
        }
    }
    EXPECT_LE(worst, kPoseBound);
    EXPECT_GT(event_count, 20u);
    EXPECT_GT(fading, 100);
    EXPECT_GT(furthest, 1.0) << "nobody walks";
    std::printf("  %s: largest difference %.1e of the size; %zu events\n",
                path == UpdatePath::kFused ? "fused" : "staged", worst, static_cast<size_t>(event_count));
}

TEST(Native, ACrowdMatchesTheTestDeviceFused) { expect_alike(UpdatePath::kFused); }
TEST(Native, ACrowdMatchesTheTestDeviceStaged) { expect_alike(UpdatePath::kStaged); }

TEST(Native, ThreadsChangeNothing) {
    LivelyCrowd lively(150, 70, 200);
    lively.settings.culling.emplace();
    lively.settings.skins_once = true;
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        const std::vector<std::byte> alone = bits_of(lively, native_device({.threads = 1}), path);
        EXPECT_GT(alone.size(), 1'000'000u);
        for (const uint32_t threads : {2u, 7u})
            EXPECT_TRUE(same_bits(bits_of(lively, native_device({.threads = threads}), path), alone)) << threads;
        const auto jobs = std::make_shared<BackwardJobs>();
        EXPECT_TRUE(same_bits(bits_of(lively, native_device({.jobs = jobs}), path), alone));
        EXPECT_GT(jobs->job_count(), 100u) << "they were not asked";
    }
}

// A few large meshes are split among several threads.
TEST(Native, InstancesCanBeSkinnedOnSeparateThreads) {
    class WideJobs : public JobSystem {
    public:
        uint32_t concurrency() const override { return 4; }
        void run(uint32_t count, void (*job)(void* context, uint32_t index), void* context) override {
            most = std::max(most, count);
            for (uint32_t i = 0; i < count; ++i) job(context, i);
        }
        uint32_t most = 0;
    };
    const Character character = small_character();
    const auto jobs = std::make_shared<WideJobs>();
    Crowd crowd =
        Crowd::create(native_device({.jobs = jobs}), {.groups = {{&character, 16}}, .skins_once = true}).value();
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(jobs->most, 16u);
}

template <class Value>
void expect_refused(const Result<Value>& result, ErrorCode code, const std::string& says) {
    ASSERT_FALSE(result) << says;
    EXPECT_EQ(result.error().code, code) << result.error().text();
    EXPECT_NE(result.error().text().find(says), std::string::npos) << result.error().text();
}

TEST(Native, FeaturesThatNeedVulkanAreRefused) {
    const Character character = small_character();
    const Device device = native_device();
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kFused, UpdatePath::kStaged})
        expect_refused(Crowd::create(device, {.groups = {{&character, 2}}, .path = path, .scan = "doubling"}),
                       ErrorCode::kUnsupported, "scan method 'doubling': a native device does not have it");
    expect_refused(Renderer::create(device, {.path = DrawPath::kDevice}), ErrorCode::kNoDevice,
                   "choose a Vulkan device");

    Crowd crowd = std::move(*Crowd::create(device, {.groups = {{&character, 2}}, .culling = Culling{}}));
    CrowdView view = *view_of({.eye = {0, 0, 5}, .target = {0, 0, 0}}, 160, 120, {});
    ASSERT_TRUE(crowd.update(0.1f, &view));
    const std::vector<Affine> before = skins_of(crowd);
    view.occlusion = true;
    expect_refused(crowd.update(0.1f, &view), ErrorCode::kUnsupported, "a native device has no depths to test");
    expect_refused(crowd.record_disoccluded(VK_NULL_HANDLE, {}), ErrorCode::kUnsupported,
                   "a native device has no depths to test");
    const auto some_commands = reinterpret_cast<VkCommandBuffer>(uintptr_t{64});
    expect_refused(crowd.record(some_commands, 0.1f), ErrorCode::kInvalidArgument,
                   "it must be VK_NULL_HANDLE on a native device; or call update()");
    Renderer renderer = *Renderer::create(device, {.width = 16, .height = 16});
    expect_refused(renderer.record(some_commands, crowd, 0.1f, {}), ErrorCode::kUnsupported,
                   "a native device has no command buffers");
    expect_refused(renderer.record_drawing(some_commands, crowd, {}), ErrorCode::kUnsupported,
                   "a native device has no command buffers");
    expect_refused(crowd.discard_last_record(), ErrorCode::kInvalidArgument,
                   "an update() has run or groups have changed since");
    EXPECT_TRUE(same_bits(skins_of(crowd), before)) << "time has gone on";
    EXPECT_TRUE(crowd.record(VK_NULL_HANDLE, 0.1f)) << "as update()";
}

// With this much memory the crowd is refused. Returns the MiB that the error asks for.
uint64_t needed_mib(const CrowdSettings& settings, uint64_t memory_bytes) {
    const Device device = native_device();
    device.gpu()->memory_properties.memoryHeaps[0].size = memory_bytes;
    const Result<Crowd> crowd = Crowd::create(device, settings);
    EXPECT_FALSE(crowd);
    if (crowd) return 0;
    EXPECT_EQ(crowd.error().code, ErrorCode::kLimit) << crowd.error().text();
    EXPECT_NE(crowd.error().text().find("MiB of matrices and state exceed"), std::string::npos) << crowd.error().text();
    return std::stoull(crowd.error().message);
}

TEST(Native, StateAndPoseMemoryIsCountedBeforeAllocation) {
    constexpr uint32_t kCount = 4000;
    const Character character = creature();
    const Controller dragon = example("dragon");
    const uint64_t skin_bytes = kCount * character.palette.size() * sizeof(Affine),
                   state_bytes = kCount * NativeRig(character).inertia_floats() * sizeof(float),
                   pose_bytes_natively = kCount * NativeRig(character, {.all_move = true}).pose_floats() *
                                         sizeof(float);
    const CrowdSettings driven{.groups = {{.character = &character, .instance_count = kCount, .controller = &dragon}}},
        posed{.groups = {{.character = &character, .instance_count = kCount, .pose_capacity = kCount}}};
    EXPECT_GE(needed_mib(driven, 1), (skin_bytes + state_bytes) >> 20);
    EXPECT_GE(needed_mib(posed, pose_bytes(posed)), (skin_bytes + pose_bytes(posed) + pose_bytes_natively) >> 20);
}

TEST(Native, RecordNeedsACommandBufferOnOtherDevices) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "the test device is native";
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}});
    expect_refused(crowd.record(VK_NULL_HANDLE, 0), ErrorCode::kInvalidArgument,
                   "command buffer: it is VK_NULL_HANDLE");
}

}  // namespace
}  // namespace throng::test
