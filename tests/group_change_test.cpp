// Groups that are added to a crowd and removed from it: numbers and handles, feedback, memory, pending updates,
// pictures, and what is refused.
#include "crowd/crowd_state.h"
#include "tests/ball.h"
#include "tests/draw_path.h"
#include "tests/group_contents.h"
#include "tests/kinds.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kGroupChangeNatively({Subset::kNative}, {"*GroupChanges*"}),
    kGroupChangeInSubsets({Subset::kGpuAssisted}, {"GroupChanges.GroupsMayHaveSeveralBatches"}),
    kGroupChangeOnOtherDrivers({Subset::kOtherDriver}, {"-GroupChanges.*"});

class GroupChanges : public testing::Test {
protected:
    CrowdSettings settings(uint32_t count, uint32_t capacity = 0) const {
        CrowdSettings of{.groups = {{.character = &character_}}};
        of.groups[0].instance_count = count;
        of.groups[0].capacity = capacity;
        of.culling.emplace();
        return of;
    }
    static void go_on(Crowd& crowd, int update_count = 1) {
        for (int i = 0; i < update_count; ++i) ASSERT_TRUE(crowd.update(0.1f));
    }
    Character character_ = creature(20, 8), other_character_ = creature(33, 9);
};

// For example, the group of a level that no player has reached yet.
TEST_F(GroupChanges, GroupsMayBeEmpty) {
    CrowdSettings of = settings(2);
    of.groups.insert(of.groups.begin(), {.character = &other_character_, .instance_count = 0});
    of.groups.push_back({.character = &other_character_, .instance_count = 0});
    Crowd crowd = create(of);
    EXPECT_EQ(crowd.add_groups(create(of)).value(), (std::vector<GroupIndex>{3, 4, 5}));
    EXPECT_EQ(crowd.instances(4)->first(), 2u);
    EXPECT_EQ(crowd.instances(3)->size(), 0u);
    for (const uint32_t empty : {0u, 5u}) ASSERT_TRUE(crowd.remove_group(empty));
    ASSERT_TRUE(crowd.remove_group(1));
    EXPECT_EQ(crowd.groups(), (std::vector<GroupIndex>{2, 3, 4}));
    EXPECT_EQ(crowd.group_of({2}).value(), 4u);
    EXPECT_FALSE(crowd.group_of({0})) << "of the group that has been removed";
    EXPECT_FALSE(crowd.group_of({4}));
    EXPECT_FALSE(crowd.remove_group(4)) << "the last that is not empty";
    go_on(crowd);
    EXPECT_EQ(crowd.outputs().size(), 1u);
    EXPECT_EQ(crowd.add_groups(create(of)).value(), (std::vector<GroupIndex>{0, 1, 5}));
    EXPECT_EQ(crowd.instances(1)->first(), 0u);
    go_on(crowd);
}

// A group whose matrices do not fit into one buffer of the device.
TEST_F(GroupChanges, GroupsMayHaveSeveralBatches) {
    const Character large = make_character({.joint_count = 65535,
                                            .shape = RigShape::kBushy,
                                            .scale_spread = 0,
                                            .clip_count = 1,
                                            .axis_count = 1,
                                            .key_count = 2});
    const uint64_t range_bytes = std::min(test_device().info().storage_buffer_range_bytes, uint64_t{256} << 20);
    CrowdSettings of = settings(static_cast<uint32_t>(range_bytes / (65535 * sizeof(Affine))) + 2);
    of.groups[0].character = &large;
    of.path = UpdatePath::kStaged;
    CrowdSettings few = settings(3);
    few.path = UpdatePath::kStaged;
    Crowd crowd = create(few);
    ASSERT_TRUE(crowd.add_groups(create(of)));
    ASSERT_TRUE(crowd.add_groups(create(few)));
    ASSERT_TRUE(crowd.remove_group(0));
    EXPECT_EQ(crowd.outputs().size(), 3u);
    const Instances many = *crowd.instances(1);
    EXPECT_EQ(many.first(), 3u);
    EXPECT_EQ(many.size(), of.groups[0].instance_count);
    for (uint32_t i = 3; i < crowd.instance_count(); ++i) {
        const Affine place = to_affine(Trs<float>{.translation = {static_cast<float>(i), 0, 0}});
        ASSERT_TRUE(crowd.set_placement(Instances::numbered(i), place));
    }
    go_on(crowd);
    uint32_t next = 3;
    for (const OutputBlock& block : crowd.outputs()) {
        EXPECT_EQ(block.first_instance, next);
        for (const Affine& place : output<Affine>(block, &OutputBlock::placement, block.instance_count))
            EXPECT_EQ(place.row[0][3], static_cast<float>(next++));
    }
    EXPECT_EQ(next, crowd.instance_count());
}

// Also if no remaining group has a number below theirs.
TEST_F(GroupChanges, HandlesOfRemovedGroupsAreRefused) {
    Crowd crowd = create(settings(4, 4));
    ASSERT_TRUE(crowd.add_groups(create(settings(4, 4))));
    ASSERT_TRUE(crowd.add_groups(create(settings(4, 4))));
    go_on(crowd);
    for (const uint32_t group : {0u, 1u}) {
        const InstanceHandle removed = alive_in(crowd, group)[1];
        ASSERT_TRUE(crowd.remove_group(group));
        const std::string why = "instance " + std::to_string(removed.instance) +
                                " of generation 0 is gone: its group has been removed";
        EXPECT_FALSE(crowd.is_alive(removed));
        EXPECT_EQ(refusal(crowd.despawn(removed)), "despawn: " + why);
        EXPECT_EQ(refusal(crowd.read_skin_matrices(removed)), "read-back: " + why);
        EXPECT_EQ(refusal(crowd.read_positions(removed)), "read-back: " + why);
    }
}

TEST_F(GroupChanges, NumbersAreReusedButHandlesAreNot) {
    Crowd crowd = create(settings(3));
    EXPECT_EQ(crowd.add_groups(create(settings(4, 4))).value(), std::vector<GroupIndex>{1});
    EXPECT_EQ(crowd.add_groups(create(settings(2))).value(), std::vector<GroupIndex>{2});
    EXPECT_EQ(crowd.instance_count(), 9u);
    const std::vector<InstanceHandle> removed = alive_in(crowd, 1), last = alive_in(crowd, 2);
    EXPECT_EQ(removed.front(), (InstanceHandle{3, 0}));
    EXPECT_EQ(last.front(), (InstanceHandle{7, 0}));
    go_on(crowd);
    ASSERT_TRUE(crowd.despawn({&removed[0], 1}));
    ASSERT_TRUE(crowd.remove_group(1));
    EXPECT_EQ(crowd.instance_count(), 9u);
    for (const InstanceHandle& one : removed) EXPECT_FALSE(crowd.is_alive(one));
    EXPECT_TRUE(crowd.is_alive(last[1]));
    EXPECT_EQ(refusal(crowd.set_placement(removed[1], Affine{})), "placement: instance 4 of generation 0 is not alive");
    EXPECT_EQ(refusal(crowd.set_placement(crowd.instances(), Affine{})),
              "placement: instance 3 is gone: its group has been removed");
    EXPECT_EQ(refusal(crowd.instances(1)), "crowd: group 1 has been removed");
    EXPECT_EQ(refusal(crowd.spawn(1, {})), "crowd: group 1 has been removed");
    EXPECT_FALSE(crowd.handle(3));
    EXPECT_FALSE(crowd.read_skin_matrices(removed[1]));
    go_on(crowd);

    // The groups of two and one fit into the gap, a group of three does not
    CrowdSettings small = settings(2);
    small.groups.push_back({.character = &other_character_, .instance_count = 1});
    EXPECT_EQ(crowd.add_groups(create(small)).value(), (std::vector<GroupIndex>{1, 3}));
    EXPECT_EQ(crowd.add_groups(create(settings(3, 3))).value(), std::vector<GroupIndex>{4});
    EXPECT_EQ(alive_in(crowd, 1), (std::vector<InstanceHandle>{{3, 2}, {4, 2}}));
    EXPECT_EQ(alive_in(crowd, 3), (std::vector<InstanceHandle>{{5, 2}}));
    EXPECT_EQ(alive_in(crowd, 4).front(), (InstanceHandle{9, 2}));
    EXPECT_FALSE(crowd.is_alive(removed[1]));
    ASSERT_TRUE(crowd.set_playback(*crowd.instances(3), {.first = {.clip = 0}}));
    go_on(crowd);
    EXPECT_EQ(crowd.read_model_matrices({5, 2}).error().text(),
              "read-back: model matrices are kept only with CrowdSettings::keep_model_matrices");
    EXPECT_EQ(crowd.read_skin_matrices({5, 2}).value().size(), other_character_.palette.size());
    std::vector<uint32_t> blocks;
    for (const OutputBlock& block : crowd.outputs()) blocks.push_back(block.first_instance);
    EXPECT_EQ(blocks, (std::vector<uint32_t>{0, 3, 5, 7, 9}));
}

// Feedback about a removed group's last updates has the handles that its instances had.
TEST_F(GroupChanges, EventsOfRemovedGroupsKeepTheirHandles) {
    const Controller dragon = example("dragon");
    CrowdSettings of = settings(2);
    of.groups[0].controller = &dragon;
    Crowd crowd = create(settings(2));
    go_on(crowd, 2);
    EXPECT_TRUE(crowd.feedback().value().empty()) << "nobody has any";
    uint64_t update_count = 2, event_count = 0;
    for (uint32_t generation = 0; generation < 3; ++generation) {
        ASSERT_EQ(crowd.add_groups(create(of)).value(), std::vector<GroupIndex>{1});
        ASSERT_TRUE(crowd.set_parameter(*crowd.instances(1), parameter_of(dragon, "forward"), 1));
        std::vector<InstanceHandle> watched = alive_in(crowd, 1);
        watched.push_back({1, 0});  // of the group that stays
        ASSERT_TRUE(crowd.watch(watched));
        for (int update = 0; update < 3; ++update) ASSERT_TRUE(crowd.update(0.7f));
        ASSERT_TRUE(crowd.remove_group(1));
        const std::vector<Feedback> all = crowd.feedback().value();
        ASSERT_EQ(all.size(), 3u);
        for (const Feedback& told : all) {
            EXPECT_EQ(told.update, ++update_count);
            for (const CharacterEvent& event : told.events) EXPECT_EQ(event.instance.generation, generation);
            event_count += told.events.size();
            ASSERT_EQ(told.watched.size(), 3u);
            EXPECT_FALSE(told.watched[0].layers.empty());
            EXPECT_EQ(told.watched[1].instance, (InstanceHandle{3, generation}));
        }
        go_on(crowd);
        const Feedback after = feedback_of(crowd);
        EXPECT_EQ(after.update, ++update_count);
        ASSERT_EQ(after.watched.size(), 1u);
        EXPECT_EQ(after.watched[0].instance, (InstanceHandle{1, 0}));
    }
    EXPECT_GT(event_count, 2u);
}

// The added groups may need more feedback per watched instance than those before.
TEST_F(GroupChanges, FeedbackGrowsWithAddedGroups) {
    const Controller dragon = example("dragon");
    CrowdSettings small = settings(2), large = settings(2);
    for (CrowdSettings* const of : {&small, &large}) {
        of->watch_capacity = 2;
        of->path = UpdatePath::kDevice;  // under the validation layers, which report accesses beyond a buffer
    }
    small.groups[0].sockets = {3};
    large.groups[0].controller = &dragon;
    large.groups[0].sockets = {1, 3, 5, 7, 9, 11};
    Crowd crowd = create(small);
    go_on(crowd, 2);
    EXPECT_EQ(crowd.feedback().value().size(), 2u);
    go_on(crowd);
    ASSERT_TRUE(crowd.add_groups(create(large)));
    ASSERT_TRUE(crowd.watch(*crowd.instances(1)));
    for (int update = 0; update < 6; ++update) {
        go_on(crowd);
        const std::vector<Feedback> all = crowd.feedback().value();
        ASSERT_EQ(all.size(), update == 0 ? 2u : 1u) << "and what had not been asked for";
        const Feedback& told = all.back();
        ASSERT_EQ(told.watched.size(), 2u);
        const auto sockets = output<Affine>(crowd.outputs()[1], &OutputBlock::socket, 12);
        EXPECT_TRUE(same_bits(copy_of(told.watched[1].sockets), std::vector(sockets.begin() + 6, sockets.end())));
    }
}

TEST_F(GroupChanges, MemoryOfRemovedGroupsIsFreed) {
    for (const uint32_t in_flight : {1u, 4u}) {
        CrowdSettings of = settings(50);
        of.frames_in_flight = in_flight;
        Crowd crowd = create(of);
        go_on(crowd, 8);
        const uint64_t before_bytes = crowd.size_bytes();
        for (int time = 0; time < 2; ++time) {
            ASSERT_TRUE(crowd.add_groups(create(of)));
            go_on(crowd, 12);
            EXPECT_GT(crowd.size_bytes(), before_bytes + 50 * character_.palette.size() * sizeof(Affine));
            ASSERT_TRUE(crowd.remove_group(1));
            EXPECT_GT(crowd.size_bytes(), before_bytes + 50 * character_.palette.size() * sizeof(Affine));
            int parts = 0;
            for (int update = 0; update < 40; ++update) {
                const uint64_t size_bytes = crowd.size_bytes();
                go_on(crowd);
                if (crowd.size_bytes() < size_bytes) ++parts;
            }
            EXPECT_GT(parts, 1) << "no update frees all of it";
            EXPECT_EQ(crowd.size_bytes(), before_bytes);
        }
    }
}

// Changes do not wait for recorded updates that have not run yet, in several slots of frames in flight. The initial
// contents of a group's first frame are not lost if that frame is.
TEST_F(GroupChanges, CanBeMadeWhileUpdatesArePending) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "nothing is recorded there";
    CrowdSettings of = settings(5);
    of.path = UpdatePath::kDevice;
    of.frames_in_flight = 2;
    of.keep_previous_matrices = true;
    const auto playing = [&] {
        Crowd crowd = create(of);
        EXPECT_TRUE(crowd.set_playback(crowd.instances(), {.first = {.clip = 0, .time_s = 0.2}}));
        return crowd;
    };
    Crowd crowd = playing(), wanted = playing();
    Recorder recorder;
    std::vector<VkCommandBuffer> recorded;
    const auto record = [&](Crowd& one) {
        recorded.push_back(recorder.record([&](VkCommandBuffer commands) { ASSERT_TRUE(one.record(commands, 0.1f)); }));
    };
    record(crowd);
    Crowd other = playing();
    recorder.submit(recorder.record([&](VkCommandBuffer commands) { ASSERT_TRUE(other.record_uploads(commands)); }));
    ASSERT_TRUE(crowd.add_groups(std::move(other)));
    EXPECT_EQ(
        refusal(crowd.discard_last_record()),
        "discard: there is no record() to discard, or it has been discarded, or an update() has run or groups have "
        "changed since");
    record(crowd);
    ASSERT_TRUE(crowd.discard_last_record());
    recorded.pop_back();
    record(crowd);
    ASSERT_TRUE(crowd.add_groups(playing()));
    record(crowd);
    record(crowd);
    ASSERT_TRUE(crowd.discard_last_record());
    recorded.pop_back();
    ASSERT_TRUE(crowd.remove_group(1));
    record(crowd);
    for (int i = 0; i < 4; ++i) record(crowd);
    for (const VkCommandBuffer commands : recorded) recorder.submit(commands);
    ASSERT_TRUE(crowd.update(0.1f));
    for (size_t i = 0; i < recorded.size() + 1; ++i) ASSERT_TRUE(wanted.update(0.1f));
    expect_same(contents_of_groups(wanted, {0}), contents_of_groups(crowd, {0}), "what has always been there");
    wanted = playing();
    for (size_t i = 0; i < recorded.size() - 1; ++i) ASSERT_TRUE(wanted.update(0.1f));
    expect_same(contents_of_groups(wanted, {0}), contents_of_groups(crowd, {2}), "what has come");
}

// In the first update, the previous matrices equal the current ones.
TEST_F(GroupChanges, AddedGroupsStartWithoutMotion) {
    CrowdSettings of = settings(3);
    of.culling.reset();
    of.keep_previous_matrices = true;
    Crowd crowd = create(of);
    go_on(crowd, 3);
    ASSERT_TRUE(crowd.add_groups(create(of)));
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), {.first = {.clip = 0}}));
    go_on(crowd);
    const Contents first = contents_of_groups(crowd, {1});
    EXPECT_EQ(first.at("0: skin"), first.at("0: previous skin"));
    go_on(crowd);
    const Contents second = contents_of_groups(crowd, {1});
    EXPECT_NE(second.at("0: skin"), second.at("0: previous skin"));
    EXPECT_EQ(first.at("0: skin"), second.at("0: previous skin"));
}

TEST_F(GroupChanges, AttachmentsOfRemovedCarriersStayInPlace) {
    CrowdSettings carriers = settings(2), carried = settings(2);
    carriers.groups[0].sockets = {3};
    carried.groups[0].is_carried = true;
    Crowd crowd = create(settings(2));
    ASSERT_TRUE(crowd.add_groups(create(carriers)));
    ASSERT_TRUE(crowd.add_groups(create(carried)));
    ASSERT_TRUE(crowd.set_placement(*crowd.instances(1), to_affine(Trs<float>{.translation = {7, 0, 0}})));
    const std::vector<InstanceHandle> things = alive_in(crowd, 2);
    ASSERT_TRUE(crowd.attach(things, Attachment{.carrier = alive_in(crowd, 1)[1], .socket = 0}));
    go_on(crowd, 2);
    const std::string hanging = contents_of_groups(crowd, {2}).at("0: placement");
    ASSERT_TRUE(crowd.remove_group(1));
    ASSERT_TRUE(crowd.add_groups(create(carriers)));
    go_on(crowd, 2);
    EXPECT_EQ(contents_of_groups(crowd, {2}).at("0: placement"), hanging);
    ASSERT_TRUE(crowd.attach(things, Attachment{.carrier = alive_in(crowd, 1)[1], .socket = 0}));
    go_on(crowd, 1);
    EXPECT_NE(contents_of_groups(crowd, {2}).at("0: placement"), hanging);
}

TEST_F(GroupChanges, IncompatibleCrowdsAreRefused) {
    Crowd crowd = create(settings(2));
    go_on(crowd);
    const auto refused = [&](const auto& change) {
        CrowdSettings of = settings(1);
        change(of);
        Crowd other = create(of);
        const std::string why = refusal(crowd.add_groups(std::move(other)));
        EXPECT_EQ(other.instance_count(), 1u) << "it is still there";
        EXPECT_TRUE(other.update(0.1f));
        return why;
    };
    const std::string setting = "add groups: the two crowds differ in CrowdSettings::";
    EXPECT_EQ(refused([](CrowdSettings& of) { of.skin_format = SkinFormat::kHalfAffine; }), setting + "skin_format");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.skin_blend = SkinBlend::kDualQuaternion; }), setting + "skin_blend");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.skins_once = true; }), setting + "skins_once");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.keep_model_matrices = true; }), setting + "keep_model_matrices");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.keep_previous_matrices = true; }), setting + "keep_previous_matrices");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.frames_in_flight = 2; }), setting + "frames_in_flight");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.culling.reset(); }),
              setting + "culling: the other one needs it too (CrowdGroup::capacity and skin_pool turn it on)");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.culling->skips_updates = true; }), setting + "Culling::skips_updates");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.culling->reduces_joints = true; }),
              setting + "Culling::reduces_joints");
    EXPECT_EQ(refused([](CrowdSettings& of) { of.pose_request_capacity = 1; }),
              setting + "pose_request_capacity, which must be above 0 in both or in neither");
    Crowd updated = create(settings(1));
    go_on(updated);
    EXPECT_EQ(refusal(crowd.add_groups(std::move(updated))), "add groups: the other crowd has been updated");
    EXPECT_FALSE(crowd.add_groups(Crowd()));
    EXPECT_FALSE(crowd.add_groups(std::move(crowd)));
    EXPECT_EQ(refusal(crowd.remove_group(0)),
              "remove group: it is the only group with instances, and a crowd needs one");
    EXPECT_EQ(refusal(crowd.remove_group(1)), "crowd: group 1 is out of range: this crowd's group numbers are below 1");
    if (!test_gpu()->processor || test_gpu()->is_native()) return;
    const auto on_device = [](CrowdSettings& of) { of.path = UpdatePath::kDevice; };
    EXPECT_EQ(refused(on_device),
              "add groups: " + character_.name +
                  " is not updated natively, but this crowd is; make this crowd with UpdatePath::kDevice");
    CrowdSettings of = settings(2);
    on_device(of);
    crowd = create(of);
    ASSERT_TRUE(crowd.add_groups(create(settings(2))));
    go_on(crowd);
    EXPECT_FALSE(crowd.path(1).value().is_native);
}

// The device refuses at every possible point. Both crowds must go on as before.
PFN_vkCreateBuffer driver_create_buffer;
PFN_vkCreateEvent driver_create_event;
uint32_t made_until_refusal;
VkResult refuse_buffer(VkDevice device, const VkBufferCreateInfo* info, const VkAllocationCallbacks* allocator,
                       VkBuffer* buffer) {
    return made_until_refusal-- == 0 ? VK_ERROR_OUT_OF_DEVICE_MEMORY
                                     : driver_create_buffer(device, info, allocator, buffer);
}
VkResult refuse_event(VkDevice device, const VkEventCreateInfo* info, const VkAllocationCallbacks* allocator,
                      VkEvent* event) {
    return made_until_refusal-- == 0 ? VK_ERROR_OUT_OF_DEVICE_MEMORY
                                     : driver_create_event(device, info, allocator, event);
}

TEST_F(GroupChanges, FailedChangesHaveNoEffect) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it makes no buffers";
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    const auto make = [&] {
        CrowdSettings of = settings(3);
        of.path = UpdatePath::kStaged;
        of.groups[0].steering = Steering{.radius = 0.1f};
        Crowd crowd = Crowd::create(device, of).value();
        EXPECT_TRUE(crowd.set_placement(crowd.instances(), to_affine(Trs<float>{.translation = {4, 5, 6}})));
        return crowd;
    };
    const auto shown = [](Crowd& crowd) {
        EXPECT_TRUE(crowd.update(0.1f));
        return std::pair(crowd.outputs().size(), crowd.instance_count());
    };
    Crowd crowd = make(), other = make();
    ASSERT_TRUE(crowd.add_groups(make()));
    ASSERT_TRUE(crowd.update(0.1f));
    crowd.state().follow_placements(true);  // as a renderer does
    driver_create_buffer = gpu.vk.vkCreateBuffer;
    driver_create_event = gpu.vk.vkCreateEvent;
    uint32_t failure_count = 0;
    const auto until_it_works = [&](const auto& change) {
        for (uint32_t until = 0;; ++until) {
            gpu.vk.vkCreateBuffer = refuse_buffer;
            gpu.vk.vkCreateEvent = refuse_event;
            made_until_refusal = until;
            const std::string why = refusal(change());
            gpu.vk.vkCreateBuffer = driver_create_buffer;
            gpu.vk.vkCreateEvent = driver_create_event;
            if (why.empty()) return;
            ++failure_count;
            EXPECT_EQ(shown(crowd), std::pair(size_t{2}, 6u)) << why;
            EXPECT_EQ(other.instance_count(), 3u);
            EXPECT_TRUE(other.save_state()) << "as it is, before its first update";
        }
    };
    until_it_works([&] { return crowd.remove_group(0); });
    EXPECT_GT(failure_count, 2u);
    EXPECT_EQ(shown(crowd), std::pair(size_t{1}, 6u));
    crowd = make();
    ASSERT_TRUE(crowd.add_groups(make()));
    crowd.state().follow_placements(true);
    failure_count = 0;
    until_it_works([&] { return crowd.add_groups(std::move(other)); });
    EXPECT_GT(failure_count, 2u);
    EXPECT_EQ(shown(crowd), std::pair(size_t{3}, 9u));
    EXPECT_EQ(output<Affine>(crowd.outputs()[2], &OutputBlock::placement, 3, device.gpu())[2].row[1][3], 5);
}

// A failed change also leaves batches moved: their old memory is freed.
TEST_F(GroupChanges, FollowedPlacementsFindBatchesThatHaveMoved) {
    CrowdSettings of = settings(3);
    of.groups[0].steering = Steering{.radius = 0.1f};
    Crowd crowd = create(of);
    ASSERT_TRUE(crowd.update(0.1f));
    CrowdState& state = crowd.state();
    state.follow_placements(true);
    std::vector<Batch> emptied(state.batches.size());  // where a stale pointer would point
    state.batches.swap(emptied);
    std::ranges::move(emptied, state.batches.begin());
    ASSERT_TRUE(crowd.set_destination(crowd.instances(), Vec3<float>{100, 0, 0}));
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(crowd.update(0.2f));
    const Affine there = output<Affine>(crowd.outputs()[0], &OutputBlock::placement, 3, test_gpu())[0];
    EXPECT_GT(there.row[0][3], 0) << "it walks";
    EXPECT_EQ(state.placements->known()[0], there);
}

class GroupChangesDrawn : public testing::TestWithParam<DrawPath> {};

// With textures; existing ones are not decoded again.
TEST_P(GroupChangesDrawn, PicturesFollowGroupChanges) {
    if (const std::string reason = undrawable_reason(GetParam()); !reason.empty()) GTEST_SKIP() << reason;
    Asset ball = make_ball();
    ball.images.push_back({.name = "gradient", .encoded = png_bytes(gradient(8, 8))});
    ball.materials[0].image = 0;
    const Character first = creature(20, 8), second = compile_character(ball, {.lods = false}).value();
    const auto crowd_of = [&](const std::vector<const Character*>& characters) {
        CrowdSettings of{.keep_model_matrices = true, .culling = Culling{}};
        for (const Character* character : characters)
            of.groups.push_back({.character = character, .instance_count = 2});
        Crowd crowd = create(of);
        uint32_t i = 0;
        for (const Character* character : characters)
            for (int k = 0; k < 2; ++k, ++i) {
                const Vec3<float> place{static_cast<float>(k), 0, character == &second ? 1.0f : 0.0f};
                EXPECT_TRUE(crowd.set_placement(InstanceHandle{i}, to_affine(Trs<float>{.translation = place})));
            }
        return crowd;
    };
    const Camera camera{.eye = {1, 1.5f, 5}, .target = {0.5f, 0.5f, 0}};
    Renderer renderer = Renderer::create(
                            test_device(),
                            {.width = 160, .height = 90, .options = {.skeletons = true}, .path = GetParam()})
                            .value();
    const auto picture_of = [&](Crowd& crowd) {
        return renderer.render_frame(crowd, 0.1f, camera).value().picture.rgba;
    };
    Crowd crowd = crowd_of({&first}), both = crowd_of({&first, &second}), alone = crowd_of({&second});
    const std::vector<uint8_t> of_first = picture_of(crowd), of_both = picture_of(both), of_second = picture_of(alone);
    EXPECT_NE(of_first, of_both);
    EXPECT_NE(of_second, of_both);
    ASSERT_TRUE(crowd.add_groups(crowd_of({&second})));
    EXPECT_EQ(picture_of(crowd), of_both);
    ASSERT_TRUE(crowd.remove_group(0));
    EXPECT_EQ(picture_of(crowd), of_second);
    for (int frame = 0; frame < 7; ++frame) EXPECT_EQ(picture_of(crowd), of_second);
    ASSERT_TRUE(crowd.add_groups(crowd_of({&first})));
    EXPECT_EQ(crowd.outputs()[0].group, 0u);
    EXPECT_EQ(picture_of(crowd), of_both);
}

INSTANTIATE_TEST_SUITE_P(GroupChanges, GroupChangesDrawn, kBothDrawPaths, name_of_path);

}  // namespace
}  // namespace throng::test
