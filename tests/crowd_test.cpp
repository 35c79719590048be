// The whole pipeline on the GPU against reference_pose(), and the promises of throng/crowd.h.
#include "control/control_reference.h"
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"

#include <cmath>
#include <cstdio>

namespace throng {
namespace {

const test::InSubset kCrowdInSubsets({test::Subset::kGpuAssisted},
                                     {"Crowd.AMixedCrowdFollowsTheReferenceWithEveryScan", "Crowd.ManyLargeCharacters*",
                                      "Crowd.TheLargestCharacterWorksWithEveryScan",
                                      "Crowd.OnlyChangedInstancesAreSetAnew", "Crowd.PlacementsReachTheDevice",
                                      "Crowd.RecordsIntoTheCallersCommandBuffer"});
const test::InSubset kCrowdOnOtherDrivers({test::Subset::kOtherDriver},
                                          {"-Crowd.ManyLargeCharacters*", "-Crowd.TheLargestCharacter*",
                                           "-Crowd.OnlyChangedInstancesAreSetAnew", "-Crowd.PlacementsReachTheDevice",
                                           "-Crowd.RecordsIntoTheCallersCommandBuffer"});
const test::InSubset kCrowdWithOtherSubgroups({test::Subset::kSubgroups},
                                              {"Crowd.AMixedCrowdFollowsTheReferenceWithEveryScan",
                                               "Crowd.AScanThatDoesNotApplyIsRefused", "Crowd.Many*",
                                               "Crowd.TheLargestCharacterWorksWithEveryScan",
                                               "Crowd.TheSameInputsGiveTheSameBits"});
const test::InSubset kCrowdNatively({test::Subset::kNative}, {"Crowd.*", "-Crowd.RecordsIntoTheCallersCommandBuffer",
                                                              "-Crowd.ManySmallCharactersAreSplitIntoBatches"});

using namespace test;

void expect_reference(const MixedCrowd& mixed, const ScanMethod& method) {
    CrowdSettings settings = mixed.settings;
    settings.path = UpdatePath::kStaged;
    settings.scan = method.name;
    Crowd crowd = create(settings);
    ASSERT_EQ(crowd.instance_count(), mixed.playbacks.size());
    for (uint32_t group = 0; group < mixed.characters.size(); ++group)
        EXPECT_EQ(crowd.path(group)->scan.method.substr(0, crowd.path(group)->scan.method.find(':')), method.name);
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), mixed.playbacks));
    double worst = 0;
    std::vector<Playback> now = mixed.playbacks;
    for (const float step_s : {0.0f, 0.3f, 0.171f, -0.9f}) {
        ASSERT_TRUE(crowd.update(step_s));
        for (uint32_t i = 0; i < now.size(); ++i) {
            now[i] = advanced(now[i], *mixed.character_of[i], step_s);
            const double error = instance_error(crowd, i, *mixed.character_of[i], now[i], true);
            EXPECT_LE(error, kPoseBound) << method.name << ", instance " << i << ", " << mixed.character_of[i]->name
                                         << ", step " << step_s << " s";
            worst = std::max(worst, error);
        }
    }
    std::printf("  %-22s %zu instances of 1, 20, 70 and 300 joints, 4 updates: largest error %.1e of the size\n",
                std::string(method.name).c_str(), now.size(), worst);
}

TEST(Crowd, AMixedCrowdFollowsTheReferenceWithEveryScan) {
    const MixedCrowd scaled(0.1), unscaled(0);
    for (const Character& character : scaled.characters) EXPECT_FALSE(character.rig.uniform_scale) << character.name;
    for (const Character& character : unscaled.characters) EXPECT_TRUE(character.rig.uniform_scale) << character.name;
    for (const ScanMethod& method : scan_table()) {
        if (method.layout == ScanLayout::kCharacterMajor && has_scan(method.name))
            expect_reference(method.format == ScanFormat::kSimilarity ? unscaled : scaled, method);
    }
}

TEST(Crowd, AutoChoosesAScanAndSaysWhy) {
    const Character character = small_character();
    const ScanAdvice used = create({.groups = {{&character, 7}}, .path = UpdatePath::kStaged}).path(0)->scan;
    EXPECT_TRUE(find_scan_method(used.method.substr(0, used.method.find(':')))) << used.method;
    const std::string why = test_gpu()->is_native() ? "one thread a character" : "7 x 20 joints";
    EXPECT_NE(used.reason.find(why), std::string::npos) << used.reason;
    const Result<ScanAdvice> advice = advise_scan(test_device(), character.rig, 7);
    ASSERT_TRUE(advice);
    EXPECT_EQ(advice->method, used.method);
    EXPECT_EQ(advice->reason, used.reason);
}

// More matrices than one buffer of the device holds: several batches, and several waves through the arena.
TEST(Crowd, ManyLargeCharactersAreSplitIntoBatchesAndWaves) {
    const Character large = make_character({.name = "65535 joints",
                                            .joint_count = 65535,
                                            .shape = RigShape::kBushy,
                                            .scale_spread = 0,
                                            .clip_count = 1,
                                            .axis_count = 1,
                                            .key_count = 2});
    const Character small = small_character();
    const uint64_t range_bytes = std::min(test_device().info().storage_buffer_range_bytes, uint64_t{256} << 20);
    const auto large_count = static_cast<uint32_t>(range_bytes / (65535 * sizeof(Affine))) + 2;
    Crowd crowd = create({.groups = {{&small, 3}, {&large, large_count}, {&small, 4}}, .path = UpdatePath::kStaged});
    EXPECT_GE(crowd.state().batches.size(), 4u);
    EXPECT_GE(crowd.state().staged->wave_count(), 2u);

    Random random(9);
    std::vector<Playback> playbacks = random_playbacks(random, small, 3);
    for (const Playback& playback : random_playbacks(random, large, large_count)) playbacks.push_back(playback);
    for (const Playback& playback : random_playbacks(random, small, 4)) playbacks.push_back(playback);
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
    ASSERT_TRUE(crowd.update(0));
    const uint32_t second_batch = crowd.state().batches[2].first_instance;
    ASSERT_GT(second_batch, 3u);
    for (const uint32_t instance :
         {0u, 2u, 3u, second_batch - 1, second_batch, large_count + 2, large_count + 3, large_count + 6}) {
        const Character& character = instance >= 3 && instance < 3 + large_count ? large : small;
        EXPECT_LE(instance_error(crowd, instance, character, playbacks[instance]), kPoseBound)
            << "instance " << instance;
    }
    uint32_t next = 0;
    for (const OutputBlock& block : crowd.outputs()) {
        EXPECT_EQ(block.first_instance, next);
        EXPECT_EQ(block.joint_count, block.group == 1 ? 65535u : 20u);
        EXPECT_LE(block.instance_count * uint64_t{block.palette_count} * sizeof(Affine), range_bytes);
        EXPECT_TRUE(has_output(block, &OutputBlock::skin));
        EXPECT_TRUE(has_output(block, &OutputBlock::placement));
        EXPECT_FALSE(has_output(block, &OutputBlock::model));
        next += block.instance_count;
    }
    EXPECT_EQ(next, crowd.instance_count());
    std::printf("  %u instances of 65,535 joints: %zu batches, %u waves, %.0f MB\n", large_count,
                crowd.state().batches.size(), crowd.state().staged->wave_count(),
                static_cast<double>(crowd.size_bytes()) * 1e-6);
    const StageTimes times = *crowd.stage_times();
    EXPECT_GT(times.of("scan"), 0);
}

// More instances than the device dispatches workgroups at once.
TEST(Crowd, ManySmallCharactersAreSplitIntoBatches) {
    const Character one = make_character({.name = "one", .joint_count = 1, .vertex_count = 3});
    const uint32_t limit = test_gpu()->properties.limits.maxComputeWorkGroupCount[0];
    if (limit > 1'000'000) GTEST_SKIP() << "the device dispatches " << limit << " workgroups";
    Crowd crowd = create({.groups = {{&one, limit + 5}}});
    EXPECT_EQ(crowd.outputs().size(), 2u);
    Random random(10);
    const std::vector<Playback> playbacks = random_playbacks(random, one, limit + 5);
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
    ASSERT_TRUE(crowd.update(0));
    const uint32_t edge = crowd.outputs()[1].first_instance;
    for (const uint32_t instance : {0u, 1u, edge - 1, edge, limit + 4})
        EXPECT_LE(instance_error(crowd, instance, one, playbacks[instance]), kPoseBound) << instance;
}

// A character with 65,535 joints, with every scan method.
TEST(Crowd, TheLargestCharacterWorksWithEveryScan) {
    const Character large = make_character({.name = "65535 joints",
                                            .joint_count = 65535,
                                            .shape = RigShape::kBushy,
                                            .scale_spread = 0,
                                            .clip_count = 1,
                                            .axis_count = 1,
                                            .key_count = 2});
    ASSERT_EQ(large.rig.joint_count(), 65535u);
    Random random(11);
    const std::vector<Playback> playbacks = random_playbacks(random, large, 2);
    for (const ScanMethod& method : scan_table()) {
        const CrowdSettings settings{.groups = {{&large, 2}},
                                     .path = UpdatePath::kStaged,
                                     .scan = std::string(method.name),
                                     .keep_model_matrices = true};
        const std::vector<uint32_t> threads = method.thread_choices(scan_limits(*test_device().gpu()));
        const bool applies = method.layout == ScanLayout::kCharacterMajor && has_scan(method.name) &&
                             std::any_of(threads.begin(), threads.end(), [&](uint32_t choice) {
                                 return plan_scan(method, ScanRig(large.rig.parents, true),
                                                  scan_limits(*test_device().gpu()), choice)
                                     .unsupported_reason.empty();
                             });
        if (!applies) {
            const Result<Crowd> refused = Crowd::create(test_device(), settings);
            ASSERT_FALSE(refused) << method.name;
            EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
            continue;
        }
        Crowd crowd = create(settings);
        ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
        ASSERT_TRUE(crowd.update(0));
        for (uint32_t i = 0; i < 2; ++i)
            EXPECT_LE(instance_error(crowd, i, large, playbacks[i], true), kPoseBound) << method.name;
    }
}

TEST(Crowd, OnlyChangedInstancesAreSetAnew) {
    const Character character = small_character();
    constexpr uint32_t kCount = 12;
    Crowd crowd = create({.groups = {{&character, 5}, {&character, kCount - 5}}});
    std::vector<Playback> playbacks;
    std::vector<double> ages_s(kCount);
    const auto looping = [](uint32_t clip, double time_s, float speed) {
        return Playback{.first = {.clip = clip, .time_s = time_s, .speed = speed, .loop = true}, .weight = 1};
    };
    for (uint32_t i = 0; i < kCount; ++i)
        playbacks.push_back(looping(i % 3, 0.05 * i, 1 + 0.1f * static_cast<float>(i)));
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
    const auto update_and_compare = [&](double step_s) {
        ASSERT_TRUE(crowd.update(static_cast<float>(step_s)));
        for (uint32_t i = 0; i < kCount; ++i) {
            ages_s[i] += step_s;
            EXPECT_LE(instance_error(crowd, i, character, advanced(playbacks[i], character, ages_s[i])), kPoseBound)
                << "instance " << i;
        }
    };
    const auto change = [&](uint32_t first, uint32_t count, uint32_t clip) {
        std::vector<Playback> changed;
        for (uint32_t i = first; i < first + count; ++i) {
            changed.push_back(playbacks[i] = looping(clip, 0.4 + 0.01 * i, 0.7f));
            ages_s[i] = 0;
        }
        ASSERT_TRUE(crowd.set_playback(Instances::numbered(first, count), changed));
    };
    update_and_compare(0.3);
    update_and_compare(0.25);
    change(4, 2, 1);  // across a group boundary
    update_and_compare(0.11);
    change(2, 3, 0);  // overlapping, out of order, one inside another
    change(1, 5, 2);
    change(3, 1, 1);
    change(11, 1, 2);
    update_and_compare(0.2);
    change(7, 0, 1);  // an empty range
    update_and_compare(0.2);
}

TEST(Crowd, TimeStaysInTheClip) {
    const Character character = small_character();  // clip 0 is 1 s long
    Crowd crowd = create({.groups = {{&character, 4}}});
    const auto play = [&](double time_s, float speed, bool loop) {
        return Playback{.first = {.clip = 0, .time_s = time_s, .speed = speed, .loop = loop}};
    };
    ASSERT_TRUE(crowd.set_playback(
        crowd.instances(), std::vector{play(0, 1, true), play(0, 1, false), play(0, -1, true), play(1, -1, false)}));
    const auto shows = [&](uint32_t instance, double time_s) {
        return instance_error(crowd, instance, character, play(time_s, 0, false)) <= kPoseBound;
    };
    ASSERT_TRUE(crowd.update(0.75f));
    EXPECT_TRUE(shows(0, 0.75) && shows(1, 0.75) && shows(2, 0.25) && shows(3, 0.25));
    ASSERT_TRUE(crowd.update(0.5f));
    EXPECT_TRUE(shows(0, 0.25) && shows(1, 1) && shows(2, 0.75) && shows(3, 0));
    ASSERT_TRUE(crowd.update(0.75f));
    EXPECT_TRUE(shows(0, 0) && shows(1, 1) && shows(2, 0) && shows(3, 0)) << "t = D wraps to 0";
    ASSERT_TRUE(crowd.update(1e9f));
    EXPECT_TRUE(shows(1, 1) && shows(3, 0));
    EXPECT_FALSE(shows(1, 0.5)) << "the comparison cannot tell times apart";
}

// Speeds and steps are finite, but their product need not be.
TEST(Crowd, HugeSpeedsKeepPosesFinite) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}});
    ASSERT_TRUE(crowd.set_playback(crowd.instances(),
                                   std::vector{Playback{.first = {.clip = 0, .speed = 3e38f, .loop = true}},
                                               Playback{.first = {.clip = 0, .speed = 3e38f, .loop = false}}}));
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(crowd.update(1000));
        for (const Affine& matrix : skins_of(crowd))
            for (const auto& row : matrix.row)
                for (const float element : row) ASSERT_TRUE(std::isfinite(element));
    }
}

TEST(Crowd, WeightsZeroAndOneShowOneClip) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 3}}});
    const ClipPlayback a{.clip = 0, .time_s = 0.3}, b{.clip = 1, .time_s = 0.8};
    ASSERT_TRUE(crowd.set_playback(crowd.instances(),
                                   std::vector{Playback{a, b, 1}, Playback{a, b, 0}, Playback{a, b, 0.25f}}));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_LE(instance_error(crowd, 0, character, Playback{a, {}, 1}), kPoseBound);
    EXPECT_LE(instance_error(crowd, 1, character, Playback{b, {}, 1}), kPoseBound);
    EXPECT_LE(instance_error(crowd, 2, character, Playback{b, a, 0.75f}), kPoseBound)
        << "a quarter of a is three quarters of b";
    EXPECT_GT(instance_error(crowd, 2, character, Playback{a, b, 0.75f}), kPoseBound);
}

TEST(Crowd, NewInstancesShowTheRestPoseAtTheOrigin) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}});
    ASSERT_TRUE(crowd.update(0.5f));
    EXPECT_LE(instance_error(crowd, 1, character, Playback{}), kPoseBound);
    EXPECT_EQ(output<Affine>(crowd.outputs()[0], &OutputBlock::placement, 2), std::vector<Affine>(2));
}

TEST(Crowd, PlacementsReachTheDevice) {
    const Character character = small_character();
    constexpr uint32_t kCount = 3000;  // more than one vkCmdUpdateBuffer takes
    Crowd crowd = create({.groups = {{&character, kCount}}});
    Random random(12);
    std::vector<Affine> placements;
    for (uint32_t i = 0; i < kCount; ++i) placements.push_back(to_affine(random.trs(100, 0)).as<float>());
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), placements));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_EQ(output<Affine>(crowd.outputs()[0], &OutputBlock::placement, kCount), placements);
    placements[1234] = {};
    ASSERT_TRUE(crowd.set_placement(InstanceHandle{1234}, placements[1234]));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_EQ(output<Affine>(crowd.outputs()[0], &OutputBlock::placement, kCount), placements);
}

TEST(Crowd, TheSameInputsGiveTheSameBits) {
    const Character character = make_character({.name = "unscaled", .scale_spread = 0});
    for (const ScanMethodInfo& method : scan_methods()) {
        if (!method.in_crowds || !has_scan(method.name)) continue;
        const auto run = [&](bool with_neighbours) {
            Crowd crowd = create(
                {.groups = {{&character, with_neighbours ? 70u : 0u}, {&character, 40}}, .scan = method.name});
            Random random(14);
            const std::vector<Playback> playbacks = random_playbacks(random, character, 40);
            EXPECT_TRUE(crowd.set_playback(Instances::numbered(crowd.instance_count() - 40, 40), playbacks));
            for (int i = 0; i < 3; ++i) EXPECT_TRUE(crowd.update(0.07f));
            std::vector<Affine> skins = skins_of(crowd);
            skins.erase(skins.begin(), skins.end() - static_cast<ptrdiff_t>(40 * character.palette.size()));
            return skins;
        };
        const std::vector<Affine> first = run(false);
        EXPECT_TRUE(same_bits(first, run(false))) << method.name;
        EXPECT_TRUE(same_bits(first, run(true))) << method.name << ": the neighbours matter";
    }
}

// Recorded twice into one command buffer of the caller's, which copies the results in between.
TEST(Crowd, RecordsIntoTheCallersCommandBuffer) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 3}}});
    Random random(15);
    std::vector<Playback> playbacks = random_playbacks(random, character, 3);
    // Loops, so that two steps equal one
    for (Playback& playback : playbacks) playback.first.loop = playback.second.loop = true;
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
    EXPECT_FALSE(crowd.stage_times()) << "nothing has been recorded";

    const Gpu& gpu = *test_gpu();
    const VkDeviceSize size_bytes = 3 * character.palette.size() * sizeof(Affine);
    const Buffer copy(test_gpu(), "copy", size_bytes, 0);
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandPoolCreateInfo pool_create{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool_create.queueFamilyIndex = gpu.queue_family;
    ASSERT_EQ(gpu.vk.vkCreateCommandPool(gpu.device, &pool_create, nullptr, &pool), VK_SUCCESS);
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool;
    allocate.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    ASSERT_EQ(gpu.vk.vkAllocateCommandBuffers(gpu.device, &allocate, &commands), VK_SUCCESS);
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    ASSERT_EQ(gpu.vk.vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
    ASSERT_TRUE(crowd.record(commands, 0.2f));
    const VkBufferCopy region{0, 0, size_bytes};
    gpu.vk.vkCmdCopyBuffer(commands, crowd.outputs()[0].skin.buffer, copy.handle(), 1, &region);
    ASSERT_TRUE(crowd.record(commands, 0.3f));
    ASSERT_EQ(gpu.vk.vkEndCommandBuffer(commands), VK_SUCCESS);
    EXPECT_FALSE(crowd.stage_times()) << "nothing has run";
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    ASSERT_EQ(gpu.vk.vkQueueSubmit(gpu.queue, 1, &submit, VK_NULL_HANDLE), VK_SUCCESS);
    ASSERT_EQ(gpu.vk.vkQueueWaitIdle(gpu.queue), VK_SUCCESS);
    gpu.vk.vkDestroyCommandPool(gpu.device, pool, nullptr);

    const std::vector<Affine> between = download<Affine>(test_gpu(), copy);
    for (uint32_t i = 0; i < 3; ++i) {
        const ReferencePose pose = *reference_pose(character, advanced(playbacks[i], character, 0.2));
        for (size_t entry = 0; entry < pose.model_from_bind.size(); ++entry)
            EXPECT_LE(matrix_error(between[i * pose.model_from_bind.size() + entry], pose.model_from_bind[entry],
                                   character.size),
                      kPoseBound);
        EXPECT_LE(instance_error(crowd, i, character, advanced(playbacks[i], character, 0.5)), kPoseBound);
    }
    EXPECT_TRUE(crowd.stage_times());
}

TEST(Crowd, MeasuresItsStages) {
    const Character character = make_character({.joint_count = 100});
    Crowd crowd = create({.groups = {{&character, 500}}});
    EXPECT_FALSE(crowd.stage_times());
    ASSERT_TRUE(crowd.update(0));
    const Result<StageTimes> times = crowd.stage_times();
    if (!test_gpu()->has_timestamps()) GTEST_SKIP() << "the queue has no timestamps";
    ASSERT_TRUE(times) << times.error().text();
    for (const double time_ms : times->ms) {
        EXPECT_GE(time_ms, 0);
        EXPECT_LT(time_ms, 60'000);
    }
    EXPECT_GT(times->total(), 0);
    double sum = 0;
    for (const char* name : stage_names()) sum += times->of(name);
    EXPECT_EQ(sum, times->total());
    EXPECT_EQ(times->of("no such stage"), 0);
    EXPECT_EQ(index_of_stage("no such stage"), stage_names().size());
    Crowd without = create({.groups = {{&character, 1}}, .timestamps = false});
    ASSERT_TRUE(without.update(0));
    EXPECT_FALSE(without.stage_times());
}

TEST(Crowd, ModelMatricesAreReadOnlyWhereKept) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 1}}});
    ASSERT_TRUE(crowd.update(0));
    const auto model = crowd.read_model_matrices({0});
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(model.error().text().find("keep_model_matrices"), std::string::npos) << model.error().text();
    EXPECT_FALSE(has_output(crowd.outputs()[0], &OutputBlock::model));
}

TEST(Crowd, CanBeMoved) {
    const Character character = small_character();
    Crowd first = create({.groups = {{&character, 2}}});
    const Playback playback{.first = {.clip = 1, .time_s = 0.4}};
    ASSERT_TRUE(first.set_playback(first.instances(), std::vector{playback, playback}));
    Crowd second = std::move(first);
    ASSERT_TRUE(second.update(0));
    EXPECT_LE(instance_error(second, 1, character, playback), kPoseBound);
    second = create({.groups = {{&character, 5}}});
    EXPECT_EQ(second.instance_count(), 5u);
    ASSERT_TRUE(second.update(0));
    EXPECT_LE(instance_error(second, 4, character, Playback{}), kPoseBound);
}

// The character may be destroyed once the crowd is created.
TEST(Crowd, DoesNotKeepTheCharacter) {
    Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 1}}});
    const Character copy = character;
    character = {};
    ASSERT_TRUE(crowd.update(0));
    EXPECT_LE(instance_error(crowd, 0, copy, Playback{}), kPoseBound);
}

TEST(Crowd, ACharacterWithoutClipsShowsItsRestPose) {
    const Character character = make_character({.clip_count = 0});
    Crowd crowd = create({.groups = {{&character, 1}}});
    ASSERT_TRUE(crowd.update(1));
    EXPECT_LE(instance_error(crowd, 0, character, Playback{}), kPoseBound);
    EXPECT_FALSE(crowd.set_playback(InstanceHandle{0}, Playback{.first = {.clip = 0}}));
}

}  // namespace
}  // namespace throng
