// Updates that are recorded but never submitted, or still running: what record() takes up, what a discard gives back,
// and that record() does not wait for the GPU.
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/recorder.h"

#include "gpu/barrier.h"
#include "gpu/owned.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace throng::test {
namespace {

// Two crowds with groups of all kinds, which get the same calls.
class CrowdPair {
public:
    CrowdPair() {
        CrowdSettings settings{.path = UpdatePath::kDevice,
                               .keep_previous_matrices = true,
                               .culling = Culling{.skips_updates = true},
                               .pose_request_capacity = 64};
        settings.groups = {
            {.character = &character_, .instance_count = kEach, .pose_capacity = kEach / 2},
            {.character = &character_, .instance_count = kEach, .controller = &controller_, .pose_capacity = kEach},
            {.character = &character_,
             .instance_count = kEach,
             .controller = &controller_,
             .sockets = {3, 7},
             .steering = Steering{.radius = 0.5f, .speed = 3}},
            {.character = &character_, .instance_count = kEach, .procedural = &rules_},
            {.character = &character_, .instance_count = kEach, .capacity = kEach}};
        for (Crowd& crowd : crowds) {
            crowd = create(settings);
            std::vector<Affine> places;
            for (uint32_t i = 0; i < crowd.instance_count(); ++i) places.push_back(place(i));
            EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
            EXPECT_TRUE(crowd.update(0) && crowd.feedback());  // instances that are not drawn then have matrices, too
        }
    }

    // Makes one random change of any kind in both crowds.
    void change(Random& random) {
        const uint32_t any = random.below(4 * kEach), two_clips = random.below(kEach),
                       driven = kEach + random.below(2 * kEach), agent = 2 * kEach + random.below(kEach),
                       ruled = 3 * kEach + random.below(kEach);
        const float fade_s = random.chance(0.3) ? 0 : static_cast<float>(random.between(0, 0.4));
        const Vec3<float> somewhere = random.vector(6).as<float>();
        const uint32_t kind = random.chance(0.3) ? 2 : random.below(12);
        const Playback playback = random_playback(random, character_);
        const Affine moved = place(random.below(4 * kEach));
        const auto [parameter, value] = random_change(random, controller_);
        const uint32_t posed = random.below(2 * kEach);
        const std::vector<Trs<float>> pose(character_.rig.rest);
        const std::array watched{InstanceHandle{any}, InstanceHandle{driven}};
        for (Crowd& crowd : crowds) {
            switch (kind) {
                case 0: EXPECT_TRUE(crowd.set_playback(InstanceHandle{two_clips}, playback)); break;
                case 1: EXPECT_TRUE(crowd.set_placement(InstanceHandle{any}, moved)); break;
                case 2: EXPECT_TRUE(crowd.set_parameter(InstanceHandle{driven}, parameter, value)); break;
                case 3: EXPECT_TRUE(crowd.set_target(InstanceHandle{ruled}, 0, {somewhere, 1})); break;
                case 4: EXPECT_TRUE(crowd.set_wind({.velocity = somewhere})); break;
                case 5: EXPECT_TRUE(crowd.set_destination(InstanceHandle{agent}, somewhere)); break;
                case 6: EXPECT_TRUE(crowd.clear_destination(InstanceHandle{agent})); break;
                case 7: EXPECT_TRUE(crowd.clear_pose(InstanceHandle{posed}, fade_s)); break;
                case 8: EXPECT_TRUE(crowd.watch(watched)); break;
                // The group that plays clips has pose capacity for half of its instances. Both crowds must refuse the
                // same calls.
                case 9: set_was_refused_.push_back(refusal(crowd.set_pose(InstanceHandle{posed}, pose, fade_s))); break;
                case 10: EXPECT_TRUE(crowd.request_poses(InstanceHandle{posed})); break;
                default: spawn_or_despawn(crowd, any % 2 == 0, moved);
            }
        }
        if (kind == 9) {
            EXPECT_EQ(set_was_refused_[0], set_was_refused_[1]);
            set_was_refused_.clear();
        }
    }

    void expect_same(const std::string& where) {
        EXPECT_TRUE(same_bits(skins_of(crowds[0]), skins_of(crowds[1]))) << where;
        const auto drawn = [](const DrawnInstance& one) { return std::pair(one.instance, one.lod); };
        const std::vector<DrawnInstance> all[2] = {drawn_of(crowds[0]), drawn_of(crowds[1])};
        EXPECT_TRUE(std::ranges::equal(all[0], all[1], {}, drawn, drawn)) << where;
        const std::vector<Feedback> feedback[2] = {std::move(*crowds[0].feedback()), std::move(*crowds[1].feedback())};
        ASSERT_EQ(feedback[0].size(), 1u) << where;
        ASSERT_EQ(feedback[1].size(), 1u) << where;
        const Feedback &a = feedback[0][0], &b = feedback[1][0];
        EXPECT_EQ(a.update, b.update) << where;
        const auto event = [](const CharacterEvent& one) {
            return std::tuple(one.instance.instance, one.instance.generation, one.event, one.layer, one.time_s);
        };
        EXPECT_TRUE(std::ranges::equal(a.events, b.events, {}, event, event)) << where;
        ASSERT_EQ(a.watched.size(), b.watched.size()) << where;
        for (size_t i = 0; i < a.watched.size(); ++i) {
            EXPECT_EQ(a.watched[i].world_from_model.row, b.watched[i].world_from_model.row) << where;
            EXPECT_EQ(copy_of(a.watched[i].parameters), copy_of(b.watched[i].parameters)) << where;
            EXPECT_EQ(copy_of(a.watched[i].layers), copy_of(b.watched[i].layers)) << where;
        }
        ASSERT_EQ(a.poses.size(), b.poses.size()) << where;
        for (size_t i = 0; i < a.poses.size(); ++i) {
            EXPECT_EQ(a.poses[i].instance, b.poses[i].instance) << where;
            EXPECT_TRUE(same_bits(a.poses[i].parent_from_joint, b.poses[i].parent_from_joint)) << where;
        }
        event_count += a.events.size();
        pose_count += a.poses.size();
    }

    // From anywhere around: some instances are visible, and most are small enough to skip updates.
    CrowdView view(Random& random) const {
        const float size = character_.size;
        const Vec3<float> middle{8 * size, 0, 6 * size}, aside = random.vector(12).as<float>() * size;
        const Camera camera{.eye = middle + Vec3<float>{aside.x, 2 * size + std::abs(aside.y), aside.z},
                            .target = middle + random.vector(6).as<float>() * size};
        return *view_of(camera, 320, 200, {}, {.full_rate_pixels = 100});
    }

    std::array<Crowd, 2> crowds;
    size_t event_count = 0, pose_count = 0;

private:
    static constexpr uint32_t kEach = 12;
    // Spawns an instance in the last group, or despawns its first one.
    static void spawn_or_despawn(Crowd& crowd, bool spawns, const Affine& place) {
        if (spawns && *crowd.alive_count(4) < kEach) {
            EXPECT_TRUE(crowd.spawn(4, {&place, 1}));
            return;
        }
        for (uint32_t i = 4 * kEach; i < 5 * kEach; ++i)
            if (const Result<InstanceHandle> handle = crowd.handle(i)) {
                EXPECT_TRUE(crowd.despawn({&*handle, 1}));
                return;
            }
    }
    Affine place(uint32_t i) const {
        const Vec3<float> at{static_cast<float>(i % 8), 0, static_cast<float>(i / 8)};
        return to_affine(Trs<float>{.translation = at * (2 * character_.size)});
    }

    Character character_ = creature(30, 10);
    Controller controller_ = example("dragon");
    ProceduralRules rules_{.targets = {"there"},
                           .rules = {WindRule{.joint = character_.rig.names[1]},
                                     LookAtRule{.joint = character_.rig.names.back(), .target = "there"}}};
    std::vector<std::string> set_was_refused_;
};

// The second crowd also records frames that are randomly dropped, with changes before the record and between the record
// and its discard.
TEST(Frames, RandomlyDroppedFramesHaveNoEffect) {
    CrowdPair pair;
    Crowd& dropping = pair.crowds[1];
    Recorder recorder;
    Random random(31);
    uint32_t dropped = 0;
    for (int update = 0; update < 40; ++update) {
        for (uint32_t i = random.below(30); i > 0; --i) pair.change(random);
        const CrowdView view = pair.view(random);
        while (random.chance(0.4)) {
            const auto step_s = static_cast<float>(random.between(0, 0.2));
            recorder.record([&](VkCommandBuffer commands) {
                EXPECT_TRUE(dropping.record(commands, step_s, random.chance(0.8) ? &view : nullptr));
            });
            for (uint32_t i = random.below(4); i > 0; --i) pair.change(random);
            const Result<void> discarded = dropping.discard_last_record();
            ASSERT_TRUE(discarded) << discarded.error().text();
            ++dropped;
        }
        const auto step_s = static_cast<float>(random.between(0, 0.1));
        const CrowdView* seen = random.chance(0.9) ? &view : nullptr;
        for (Crowd& crowd : pair.crowds) ASSERT_TRUE(crowd.update(step_s, seen));
        pair.expect_same("update " + std::to_string(update));
    }
    EXPECT_GT(dropped, 10u);
    EXPECT_GT(pair.event_count, 0u);
    EXPECT_GT(pair.pose_count, 0u);
}

struct DrivenCrowd {
    Character character = creature(20, 8);
    Controller controller = example("walker");
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 4, .controller = &controller}}});
};

TEST(Frames, ManyDiscardedInARowHaveNoEffect) {
    DrivenCrowd driven;
    Recorder recorder;
    for (int frame = 0; frame < 20; ++frame) {
        recorder.record(
            [&](VkCommandBuffer commands) { EXPECT_EQ(refusal(driven.crowd.record(commands, 0.1f)), "") << frame; });
        EXPECT_TRUE(driven.crowd.discard_last_record());
    }
    EXPECT_TRUE(driven.crowd.update(0.1f));
    EXPECT_EQ(driven.crowd.feedback()->size(), 1u);
}

TEST(Frames, OneUnreportedDropDoesNotBlockUpdates) {
    DrivenCrowd driven;
    Recorder recorder;
    ASSERT_TRUE(driven.crowd.update(0.1f));
    recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(driven.crowd.record(commands, 0.1f)); });
    for (int frame = 0; frame < 10; ++frame) EXPECT_EQ(refusal(driven.crowd.update(0.1f)), "") << frame;
    EXPECT_LE(driven.crowd.feedback()->size(), 4u) << "of those that ran";
}

TEST(Frames, RepeatedUnreportedDropsAreRefused) {
    DrivenCrowd driven;
    Recorder recorder;
    std::string last;
    for (int frame = 0; frame < 5; ++frame)
        recorder.record([&](VkCommandBuffer commands) { last = refusal(driven.crowd.record(commands, 0.1f)); });
    EXPECT_NE(last.find("discard_last_record()"), std::string::npos) << last;
}

TEST(Frames, UpdateTakesWhatWasNotSubmittedForDropped) {
    DrivenCrowd driven;
    Recorder recorder;
    for (int frame = 0; frame < 4; ++frame)
        recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(driven.crowd.record(commands, 0.1f)); });
    EXPECT_TRUE(driven.crowd.feedback()->empty());
    for (int frame = 0; frame < 6; ++frame) EXPECT_EQ(refusal(driven.crowd.update(0.1f)), "") << frame;
    const std::vector<Feedback> feedback = *driven.crowd.feedback();
    ASSERT_EQ(feedback.size(), 4u) << "of the last four";
    EXPECT_EQ(feedback.back().update, 10u);
}

TEST(Frames, OnlyTheLastRecordIsDiscarded) {
    DrivenCrowd driven;
    Recorder recorder;
    EXPECT_FALSE(driven.crowd.discard_last_record()) << "nothing has been recorded";
    recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(driven.crowd.record(commands, 0.1f)); });
    EXPECT_TRUE(driven.crowd.discard_last_record());
    EXPECT_FALSE(driven.crowd.discard_last_record()) << "it has been discarded";
}

// A stage that runs out of memory in the middle of an update, for example.
class FailingStage : public Stage {
public:
    explicit FailingStage(const StageContext& context) : Stage(context) {}
    void record(const Update&) override {
        if (fails) throw Failure(ErrorCode::kOutOfMemory, "a stage", "of this test");
    }
    bool fails = false;
};

FailingStage& add_failing_stage(const Crowd& crowd) {
    CrowdState& state = crowd.state();
    Uploads uploads(state.gpu);
    const CrowdSettings settings;
    state.stages.push_back(std::make_unique<FailingStage>(
        StageContext{uploads, settings, state.groups, state.batches, state.instance_count, nullptr, state.stages}));
    return static_cast<FailingStage&>(*state.stages.back());
}

TEST(Frames, AFailedRecordCannotBeDiscarded) {
    DrivenCrowd driven;
    FailingStage& stage = add_failing_stage(driven.crowd);
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(driven.crowd.record(commands, 0.1f)); });
    stage.fails = true;
    recorder.record([&](VkCommandBuffer commands) { EXPECT_FALSE(driven.crowd.record(commands, 0.1f)); });
    EXPECT_FALSE(driven.crowd.discard_last_record()) << "it would be the update before";
    EXPECT_FALSE(driven.crowd.save_state()) << "the commands of the first have not run";
    stage.fails = false;
    EXPECT_EQ(refusal(driven.crowd.update(0.1f)), "");
}

// Also if the update was for a view with occlusion, whose second half can no longer be recorded.
TEST(Frames, RestoreStateWorksAfterAFailedUpdate) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}, .culling = Culling{}});
    FailingStage& stage = add_failing_stage(crowd);
    const std::vector<std::byte> saved = *crowd.save_state();
    CrowdView view = *view_of({.eye = {0, 0, 0}, .target = {0, 0, -1}}, 64, 64, {});
    view.occlusion = true;
    stage.fails = true;
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) { EXPECT_FALSE(crowd.record(commands, 0.1f, &view)); });
    EXPECT_EQ(refusal(crowd.restore_state(saved)), "");
    stage.fails = false;
    EXPECT_EQ(refusal(crowd.update(0.1f)), "");
    EXPECT_TRUE(crowd.save_state());
}

// The buffers' initial contents are uploaded again, since they were part of the failed update.
TEST(Frames, RestoreStateWorksAfterAFailedFirstUpdate) {
    const Character character = small_character();
    const auto make = [&] { return create({.groups = {{&character, 2}}, .path = UpdatePath::kDevice}); };
    Crowd crowd = make(), twin = make();
    const std::vector<std::byte> saved = *twin.save_state();
    FailingStage& stage = add_failing_stage(crowd);
    stage.fails = true;
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) { EXPECT_FALSE(crowd.record(commands, 0.1f)); });
    stage.fails = false;
    EXPECT_EQ(refusal(crowd.restore_state(saved)), "");
    ASSERT_TRUE(crowd.update(0.1f) && twin.update(0.1f));
    EXPECT_TRUE(same_bits(skins_of(crowd), skins_of(twin)));
}

// The next update is the instance's first, as if nothing had been recorded.
TEST(Frames, InstancesSpawnedBeforeADiscardAreNewInTheNextUpdate) {
    const Character character = creature(20, 8);
    Recorder recorder;
    std::array<Crowd, 2> crowds;
    for (Crowd& crowd : crowds) {
        crowd = create(
            {.groups = {{.character = &character, .steering = Steering{.radius = 0.5f, .speed = 3}, .capacity = 2}},
             .path = UpdatePath::kDevice});
        ASSERT_TRUE(crowd.update(0.1f));
        const bool discards = &crowd == &crowds[1];
        if (discards) recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 0.1f)); });
        const InstanceHandle walker = *crowd.spawn(0, Affine{});
        EXPECT_TRUE(!discards || crowd.discard_last_record());
        ASSERT_TRUE(crowd.set_destination(walker, Vec3<float>{0, 0, 10}));
    }
    for (int update = 0; update < 4; ++update) {
        std::array<std::vector<Affine>, 2> places;
        for (size_t i = 0; i < crowds.size(); ++i) {
            ASSERT_TRUE(crowds[i].update(0.05f));
            places[i] = output<Affine>(crowds[i].outputs()[0], &OutputBlock::placement, 1);
        }
        EXPECT_EQ(places[0][0].row, places[1][0].row) << update;
        EXPECT_GT(places[0][0].row[2][3], 0) << update;
    }
}

// Also the last step, with which the fade would end.
TEST(Frames, DiscardsTakeStepsOfPoseFadesBack) {
    const Character character = creature(20, 8);
    std::vector<Trs<float>> pose = character.rig.rest;
    pose[0].translation.x += character.size;
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1, .pose_capacity = 1}}});
    const InstanceHandle instance{0};
    Recorder recorder;
    const auto expect_step_taken_back = [&](const char* fade) {
        ASSERT_TRUE(crowd.update(0.25f));
        const std::vector<Affine> halfway = *crowd.read_skin_matrices(instance);
        recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 1)); });
        ASSERT_TRUE(crowd.discard_last_record());
        ASSERT_TRUE(crowd.update(0));
        EXPECT_TRUE(same_bits(*crowd.read_skin_matrices(instance), halfway)) << fade;
    };
    ASSERT_TRUE(crowd.set_pose(instance, pose, 0.5f));
    expect_step_taken_back("in");
    ASSERT_TRUE(crowd.update(1) && crowd.clear_pose(instance, 0.5f));
    expect_step_taken_back("out");
}

// Pose requests of a discarded record() are queued before later ones; together they are more than one update has
// capacity for.
TEST(Frames, PoseRequestsOfADiscardedRecordAreSaved) {
    const Character character = creature(20, 5);
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = 4, .pose_capacity = 4}}, .pose_request_capacity = 2});
    ASSERT_TRUE(crowd.update(0));
    const Instances first = Instances::numbered(0, 2), last = Instances::numbered(2, 2);
    ASSERT_TRUE(crowd.request_poses(first));
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 0)); });
    ASSERT_TRUE(crowd.request_poses(last) && crowd.discard_last_record());
    const Result<std::vector<std::byte>> saved = crowd.save_state();
    ASSERT_TRUE(saved);
    EXPECT_EQ(refusal(crowd.restore_state(*saved)), "");
    std::vector<uint32_t> shown;
    for (int update = 0; update < 2; ++update) {
        ASSERT_TRUE(crowd.update(0));
        const Result<std::vector<Feedback>> feedback = crowd.feedback();
        ASSERT_TRUE(feedback);
        for (const Feedback& one : *feedback)
            for (const ShownPose& pose : one.poses) shown.push_back(pose.instance.instance);
    }
    EXPECT_EQ(shown, (std::vector<uint32_t>{0, 1, 2, 3}));
}

// Inertia begins with the group's first update, whether the update before it ran or was discarded.
TEST(Frames, InertialGroupsMayComeAfterARecordedUpdate) {
    const Character character = creature(20, 8);
    const Controller inertial = direct_layers(1, {}, true);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1}}});
    ASSERT_TRUE(crowd.update(0.1f));
    Recorder recorder;
    for (const bool runs : {true, false}) {
        const VkCommandBuffer commands = recorder.record(
            [&](VkCommandBuffer into) { EXPECT_EQ(refusal(crowd.record(into, 0.1f)), ""); });
        if (runs) recorder.submit(commands);
        EXPECT_TRUE(runs || crowd.discard_last_record());
        const auto added = crowd.add_groups(
            create({.groups = {{.character = &character, .instance_count = 1, .controller = &inertial}}}));
        ASSERT_TRUE(added) << added.error().text();
        EXPECT_EQ(refusal(crowd.update(0.1f)), "") << runs;
        ASSERT_TRUE(crowd.remove_group(added->front()));
    }
}

// Validation layers report it if a buffer was created without this usage.
TEST(Frames, OutputsMayBeBoundAsVertexBuffers) {
    const Character character = creature(20, 8);
    const Controller controller = example("walker");
    Crowd crowd = create({.groups = {{.character = &character,
                                      .instance_count = 4,
                                      .controller = &controller,
                                      .sockets = {3},
                                      .outfits = {Outfit{}}}},
                          .keep_model_matrices = true,
                          .keep_previous_matrices = true,
                          .culling = Culling{},
                          .skins_once = true});
    ASSERT_TRUE(crowd.update(0.1f));
    const OutputBlock& block = crowd.outputs()[0];
    const std::array views{block.skin,      block.previous_skin, block.model, block.placement, block.socket,
                           block.parameter, block.look,          block.list,  block.draw,      block.skinned};
    Recorder().record([&](VkCommandBuffer commands) {
        for (const BufferView& view : views) {
            ASSERT_TRUE(view);
            test_gpu()->vk.vkCmdBindVertexBuffers(commands, 0, 1, &view.buffer, &view.offset_bytes);
        }
    });
}

// An event blocks the GPU in the middle of an update. Another thread sets it after a while or once record() has
// returned; if record() waits for the GPU, it returns only after the event was set.
TEST(Frames, RecordDoesNotWaitForTheGpu) {
    if (!test_gpu()->has_timestamps()) GTEST_SKIP() << "the queue has no timestamps";
    const Gpu& gpu = *test_gpu();
    const Character character = creature(20, 8);
    Crowd crowd = create({.groups = {{&character, 4}}, .culling = Culling{}});
    const CrowdView view = *view_of({.eye = {0, 5, 20}, .target = {}}, 320, 200, {},
                                    {.full_rate_pixels = 10, .budget_ms = 1});
    const OwnedEvent go_on(test_gpu(), gpu.vk.vkCreateEvent, VkEventCreateInfo{VK_STRUCTURE_TYPE_EVENT_CREATE_INFO},
                           "vkCreateEvent");
    const OwnedEvent begun(test_gpu(), gpu.vk.vkCreateEvent, VkEventCreateInfo{VK_STRUCTURE_TYPE_EVENT_CREATE_INFO},
                           "vkCreateEvent");
    Recorder recorder;
    ASSERT_TRUE(crowd.update(0.1f, &view));
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    const VkEvent wait_for = go_on.get();
    recorder.submit(recorder.record([&](VkCommandBuffer commands) {
        EXPECT_TRUE(crowd.record(commands, 0.1f, &view));
        gpu.vk.vkCmdSetEvent(commands, begun.get(), VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
        gpu.vk.vkCmdWaitEvents2(commands, 1, &wait_for, &dependency);
    }));
    while (gpu.vk.vkGetEventStatus(gpu.device, begun.get()) != VK_EVENT_SET) std::this_thread::yield();
    std::atomic<bool> has_returned = false, was_let_go = false;
    std::thread rescuer([&] {
        for (int tenth = 0; tenth < 50 && !has_returned; ++tenth)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        was_let_go = !has_returned;
        gpu.vk.vkSetEvent(gpu.device, wait_for);
    });
    recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 0.1f, &view)); });
    has_returned = true;
    rescuer.join();
    EXPECT_FALSE(was_let_go) << "record() came back only when the GPU went on";
}

}  // namespace
}  // namespace throng::test
