// Devices without Vulkan beside the test device; whatever threads compute; and what they refuse.
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"

#include <throng/draw.h>

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <thread>

namespace throng::test {
namespace {

Device native_device(DeviceSettings settings = {}) {
    settings.select = "native";
    return *Device::create(settings);
}

// Every second job on a thread of its own, the others on the caller's, the last first.
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

// Walks ahead in each of its clips.
Character walking_creature() {
    Character character = creature();
    for (Clip& clip : character.clips) {
        clip.first_root_row = static_cast<uint32_t>(character.root_rows.size());
        clip.root_row_count = 2;
        character.root_rows.insert(character.root_rows.end(), {{0, 0, 1, 0}, {0, 1.3f * clip.duration_s, 1, 0}});
    }
    return character;
}

// Characters that play two clips, many of one of them, and two that have controllers, events and sockets; of these one
// has root motion, the other inertial transitions.
struct LivelyCrowd {
    MixedCrowd mixed{0.1};
    Character walking = walking_creature(), flying = creature(90, 25);
    Controller walker = example("walker"), dragon = example("dragon");
    CrowdSettings settings = mixed.settings;
    uint32_t first_walking, first_flying, first_of_many, instance_count;
    std::vector<uint32_t> watched;

    LivelyCrowd(uint32_t walking_count, uint32_t flying_count, uint32_t many_count)
        : first_walking(static_cast<uint32_t>(mixed.playbacks.size())),
          first_flying(first_walking + walking_count),
          first_of_many(first_flying + flying_count),
          instance_count(first_of_many + many_count) {
        settings.groups.push_back({.character = &walking,
                                   .instance_count = walking_count,
                                   .controller = &walker,
                                   .sockets = {0, 7},
                                   .socket_space = SocketSpace::kWorld});
        settings.groups.push_back({.character = &flying,
                                   .instance_count = flying_count,
                                   .controller = &dragon,
                                   .sockets = {3},
                                   .socket_space = SocketSpace::kModel});
        settings.groups.push_back({&mixed.characters[1], many_count});
        watched.resize(std::min(settings.watch_capacity, first_of_many - first_walking));
        std::iota(watched.begin(), watched.end(), first_of_many - static_cast<uint32_t>(watched.size()));
    }
    LivelyCrowd(const LivelyCrowd&) = delete;

    double size_of(uint32_t instance) const {
        if (instance < first_walking) return mixed.character_of[instance]->size;
        if (instance < first_flying) return walking.size;
        return instance < first_of_many ? flying.size : mixed.characters[1].size;
    }
    Crowd create_on(const Device& device, UpdatePath path) const {
        CrowdSettings on = settings;
        on.path = path;
        Crowd crowd = std::move(*Crowd::create(device, on));
        EXPECT_TRUE(crowd.watch(watched));
        return crowd;
    }
    // The same for every crowd that has got as many.
    void update(Crowd& crowd, uint32_t update, const CrowdView* view = nullptr) const {
        Random random(update);
        if (update % 16 == 0) {
            std::vector<Playback> playbacks;
            for (const Character* character : mixed.character_of)
                playbacks.push_back(random_playback(random, *character));
            EXPECT_TRUE(crowd.set_playback(0, playbacks));
            EXPECT_TRUE(crowd.set_playback(
                first_of_many, random_playbacks(random, mixed.characters[1], instance_count - first_of_many)));
        }
        for (uint32_t i = first_walking; i < first_of_many; ++i) {
            const auto [parameter, value] = random_change(random, i < first_flying ? walker : dragon);
            EXPECT_TRUE(crowd.set_parameters(i, parameter, value));
        }
        EXPECT_TRUE(crowd.update(static_cast<float>(random.between(0, 0.1)), view));
    }
};

Feedback feedback_of(Crowd& crowd) {
    std::vector<Feedback> feedback = *crowd.feedback();
    EXPECT_EQ(feedback.size(), 1u);
    return std::move(feedback.at(0));
}

bool same_events(const Feedback& a, const Feedback& b) {
    return a.lost_event_count == b.lost_event_count &&
           std::ranges::equal(a.events, b.events, [](const CharacterEvent& x, const CharacterEvent& y) {
               return x.instance == y.instance && x.event == y.event && x.layer == y.layer && x.time_s == y.time_s;
           });
}

double difference(std::span<const Affine> a, std::span<const Affine> b, double size) {
    EXPECT_EQ(a.size(), b.size());
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, matrix_error(a[i], b[i].as<double>(), size));
    return worst;
}

// How far apart vertices and joints are at most.
double distance(Crowd& a, Crowd& b, uint32_t instance) {
    const std::vector<Vec3<float>> of_a = *a.read_positions(instance), of_b = *b.read_positions(instance);
    EXPECT_EQ(of_a.size(), of_b.size());
    double worst = 0;
    for (size_t i = 0; i < of_a.size(); ++i)
        worst = std::max(worst, length(of_a[i].as<double>() - of_b[i].as<double>()));
    const std::vector<Affine> joints_of_a = *a.read_model_matrices(instance),
                              joints_of_b = *b.read_model_matrices(instance);
    for (size_t i = 0; i < joints_of_a.size(); ++i)
        worst = std::max(worst, length(transform_point(joints_of_a[i].as<double>(), Vec3<double>{}) -
                                       transform_point(joints_of_b[i].as<double>(), Vec3<double>{})));
    return worst;
}

void expect_alike(UpdatePath path) {
    constexpr uint32_t kUpdates = 50;
    const LivelyCrowd lively(24, 20, 20);
    Crowd native = lively.create_on(native_device(), path), other = lively.create_on(test_device(), path);
    uint64_t event_count = 0, fading = 0;
    double worst = 0, furthest = 0;
    for (uint32_t update = 0; update < kUpdates; ++update) {
        SCOPED_TRACE("update " + std::to_string(update));
        for (Crowd* crowd : {&native, &other}) lively.update(*crowd, update);
        const Feedback got = feedback_of(native), wanted = feedback_of(other);
        EXPECT_TRUE(same_events(got, wanted));
        event_count += got.events.size();
        ASSERT_EQ(got.watched.size(), lively.watched.size());
        ASSERT_EQ(wanted.watched.size(), lively.watched.size());
        for (size_t i = 0; i < got.watched.size(); ++i) {
            const WatchedInstance &a = got.watched[i], &b = wanted.watched[i];
            ASSERT_EQ(a.instance, b.instance);
            EXPECT_TRUE(same_bits(a.parameters, b.parameters)) << "instance " << a.instance;
            EXPECT_EQ(a.layers, b.layers) << "instance " << a.instance;
            fading += std::ranges::count_if(a.layers, [](const auto& layer) { return layer.size() > 1; });
            const double size = lively.size_of(a.instance), place = std::abs(double{b.world_from_model.row[2][3]});
            EXPECT_LE(difference({&a.world_from_model, 1}, {&b.world_from_model, 1}, size + place), kPoseBound);
            EXPECT_LE(difference(a.sockets, b.sockets, size + place), kPoseBound) << "instance " << a.instance;
            furthest = std::max(furthest, place);
        }
        if (update % 7 != 0) continue;
        for (uint32_t i = 0; i < lively.instance_count; ++i) {
            worst = std::max(worst, distance(native, other, i) / lively.size_of(i));
        }
    }
    EXPECT_LE(worst, kPoseBound);
    EXPECT_GT(event_count, 20u);
    EXPECT_GT(fading, 100u);
    EXPECT_GT(furthest, 1.0) << "nobody walks";
    std::printf("  %s: largest difference %.1e of the size; %zu events\n",
                path == UpdatePath::kFused ? "fused" : "staged", worst, static_cast<size_t>(event_count));
}

TEST(Native, ACrowdIsAsTheTestDeviceHasItFused) { expect_alike(UpdatePath::kFused); }
TEST(Native, ACrowdIsAsTheTestDeviceHasItStaged) { expect_alike(UpdatePath::kStaged); }

// All that the updates gave.
std::vector<std::byte> bits_of(const LivelyCrowd& lively, const Device& device, UpdatePath path) {
    std::vector<std::byte> bits;
    const auto add = [&](const auto& values) {
        const auto bytes = std::as_bytes(std::span(values));
        bits.insert(bits.end(), bytes.begin(), bytes.end());
    };
    Crowd crowd = lively.create_on(device, path);
    for (uint32_t update = 0; update < 12; ++update) {
        const Vec3<float> eye{0, 3, static_cast<float>(update) - 5};
        const CrowdView view = *view_of({.eye = eye, .target = {0, 0, 0}}, 160, 120, {});
        lively.update(crowd, update, update % 2 == 0 ? nullptr : &view);
        const Feedback feedback = feedback_of(crowd);
        add(feedback.events);
        for (const WatchedInstance& one : feedback.watched) {
            add(one.parameters);
            add(one.sockets);
            for (const auto& layer : one.layers) add(layer);
        }
        for (const DrawnInstance& one : drawn_of(crowd)) add(std::array{one.instance, one.lod});
        for (const OutputBlock& block : crowd.outputs()) {
            add(block.host.skin);
            add(block.host.model);
            add(block.host.placement);
            add(block.host.root);
            add(block.host.list);
            add(block.host.skinned);
        }
    }
    return bits;
}

TEST(Native, ThreadsChangeNothing) {
    LivelyCrowd lively(150, 70, 200);
    lively.settings.culls = lively.settings.skins_once = true;
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

template <class Value>
void expect_refused(const Result<Value>& result, ErrorCode code, const std::string& says) {
    ASSERT_FALSE(result) << says;
    EXPECT_EQ(result.error().code, code) << result.error().text();
    EXPECT_NE(result.error().text().find(says), std::string::npos) << result.error().text();
}

TEST(Native, WhatNeedsVulkanIsRefused) {
    const Character character = small_character();
    const Device device = native_device();
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kFused, UpdatePath::kStaged})
        expect_refused(Crowd::create(device, {.groups = {{&character, 2}}, .path = path, .scan = "doubling"}),
                       ErrorCode::kUnsupported, "scan method 'doubling': a native device does not have it");
    expect_refused(Renderer::create(device), ErrorCode::kNoDevice, "the native device draws nothing");

    Crowd crowd = std::move(*Crowd::create(device, {.groups = {{&character, 2}}, .culls = true}));
    CrowdView view = *view_of({.eye = {0, 0, 5}, .target = {0, 0, 0}}, 160, 120, {});
    ASSERT_TRUE(crowd.update(0.1f, &view));
    const std::vector<Affine> before = skins_of(crowd);
    view.occlusion = true;
    expect_refused(crowd.update(0.1f, &view), ErrorCode::kUnsupported, "a native device has no depths to test");
    expect_refused(crowd.record_disoccluded(VK_NULL_HANDLE, {}), ErrorCode::kUnsupported,
                   "a native device has no depths to test");
    const auto some_commands = reinterpret_cast<VkCommandBuffer>(uintptr_t{64});
    expect_refused(crowd.record(some_commands, 0.1f), ErrorCode::kInvalidArgument, "a native device has none");
    expect_refused(crowd.discard_last_record(), ErrorCode::kInvalidArgument, "an update() has run since");
    EXPECT_TRUE(same_bits(skins_of(crowd), before)) << "time has gone on";
    EXPECT_TRUE(crowd.record(VK_NULL_HANDLE, 0.1f)) << "as update()";
}

TEST(Native, UpdatesNeedACommandBufferElsewhere) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "the test device is native";
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}});
    expect_refused(crowd.record(VK_NULL_HANDLE, 0), ErrorCode::kInvalidArgument, "command buffer: there is none");
}

}  // namespace
}  // namespace throng::test
