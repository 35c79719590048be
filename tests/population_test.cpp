// Instances that are spawned and despawned: their handles, what they inherit, and what is left of them.
#include "crowd/crowd_state.h"
#include "tests/kinds.h"
#include "tests/lively_crowd.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <set>

namespace throng::test {
namespace {

const InSubset kPopulationInSubsets({Subset::kGpuAssisted},
                                    {"Population.MayBeEmpty", "Population.EventsBelongToTheInstanceOfTheirUpdate"});
const InSubset kPopulationOnOtherDrivers({Subset::kOtherDriver}, {"-Population.*"});
const InSubset kPopulationNatively({Subset::kNative}, {"Population.*", "-Population.DiscardedSpawnsAndDespawns*"});

struct Few {
    Character character = creature(20, 8);
    Controller controller = example("walker");
    CrowdSettings settings{.groups = {{.character = &character, .instance_count = 2},
                                      {.character = &character, .instance_count = 1, .capacity = 4},
                                      {.character = &character, .controller = &controller, .capacity = 3}}};
    Crowd crowd = create(settings);

    std::vector<InstanceHandle> spawn(uint32_t group, uint32_t count) {
        Result<std::vector<InstanceHandle>> handles = crowd.spawn(group, std::vector(count, Affine{}));
        EXPECT_TRUE(handles) << refusal(handles);
        return handles ? *handles : std::vector<InstanceHandle>(count);
    }
};

TEST(Population, HandlesDistinguishReusedNumbers) {
    Few few;
    Crowd& crowd = few.crowd;
    EXPECT_EQ(crowd.instance_count(), 2u + 4 + 3);
    EXPECT_EQ(*crowd.handle(0), (InstanceHandle{0, 0}));
    EXPECT_EQ(*crowd.handle(2), (InstanceHandle{2, 0}));
    EXPECT_EQ(*crowd.alive_count(0), 2u);
    EXPECT_EQ(*crowd.alive_count(1), 1u);
    const std::vector<InstanceHandle> first = few.spawn(1, 2);
    EXPECT_EQ(first, (std::vector<InstanceHandle>{{3, 0}, {4, 0}}));
    EXPECT_TRUE(crowd.despawn({first.data(), 1}));
    EXPECT_FALSE(crowd.is_alive(first[0]));
    EXPECT_TRUE(crowd.is_alive(first[1]));
    EXPECT_EQ(*crowd.alive_count(1), 2u);
    const std::vector<InstanceHandle> second = few.spawn(1, 2);
    EXPECT_EQ(second, (std::vector<InstanceHandle>{{3, 1}, {5, 0}}));
    EXPECT_FALSE(crowd.is_alive(first[0]));
    EXPECT_TRUE(crowd.is_alive(second[0]));
    EXPECT_FALSE(crowd.is_alive({}));
    EXPECT_FALSE(crowd.is_alive({.instance = 0, .generation = 1}));
}

TEST(Population, RefusesInvalidSpawnsAndHandles) {
    Few few;
    Crowd& crowd = few.crowd;
    const std::vector<InstanceHandle> all = few.spawn(1, 3);
    EXPECT_EQ(refusal(crowd.spawn(1, std::array{Affine{}})),
              "creature: spawn: 1 instances, but CrowdGroup::capacity leaves room for 0");
    EXPECT_EQ(crowd.spawn(1, std::array{Affine{}}).error().code, ErrorCode::kLimit);
    EXPECT_EQ(refusal(crowd.spawn(0, std::array{Affine{}})), "creature: spawn: CrowdGroup::capacity is not set");
    EXPECT_EQ(refusal(crowd.spawn(3, std::array{Affine{}})),
              "crowd: group 3 is out of range: this crowd's group numbers are below 3");
    Affine bad;
    bad.row[1][3] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(refusal(crowd.spawn(2, std::array{Affine{}, bad})), "spawn: placement 1: a number is not finite");
    EXPECT_EQ(*crowd.alive_count(2), 0u) << "nothing has happened";

    EXPECT_EQ(refusal(crowd.despawn(std::array{all[0], all[1], all[0]})), "despawn: instance 3 is given twice");
    EXPECT_EQ(refusal(crowd.despawn(std::array{all[0], *crowd.handle(0)})),
              "despawn: instance 0 of generation 0 cannot be despawned: its group has no CrowdGroup::capacity");
    EXPECT_EQ(*crowd.alive_count(1), 4u) << "nothing has happened";
    ASSERT_TRUE(crowd.despawn({all.data(), 1}));
    EXPECT_EQ(refusal(crowd.despawn({all.data(), 1})), "despawn: instance 3 of generation 0 is not alive");

    const std::string none = "instance 3 is not alive: it has not been spawned, or it has been despawned";
    EXPECT_EQ(refusal(crowd.handle(3)), "handle: " + none);
    EXPECT_EQ(refusal(crowd.set_playback(Instances::numbered(2, 2), Playback())), "playback: " + none);
    EXPECT_EQ(refusal(crowd.set_placement(all[0], Affine{})), "placement: instance 3 of generation 0 is not alive");
    EXPECT_EQ(refusal(crowd.watch(Instances::numbered(3))), "watch: " + none);
    EXPECT_EQ(refusal(crowd.read_skin_matrices(all[0])), "read-back: instance 3 of generation 0 is not alive");
    EXPECT_EQ(refusal(crowd.set_parameter(InstanceHandle{6}, 0, 1.0f)),
              "parameter: instance 6 of generation 0 is not alive");

    CrowdSettings settings = few.settings;
    settings.groups[1].instance_count = 5;
    EXPECT_EQ(refusal(Crowd::create(test_device(), settings)),
              "crowd: capacity: 4 is below the group's instance_count of 5");
    settings = few.settings;
    settings.keep_previous_matrices = true;
    settings.groups[1].sockets = {1};
    EXPECT_EQ(Crowd::create(test_device(), settings).error().code, ErrorCode::kUnsupported);
}

// A crowd that starts empty, fills up and is empty again.
TEST(Population, MayBeEmpty) {
    Few few;
    few.settings.groups.erase(few.settings.groups.begin());
    few.settings.groups[0].instance_count = 0;
    Crowd crowd = create(few.settings);
    const auto update = [&](size_t drawn) {
        EXPECT_TRUE(crowd.update(0.1f));
        EXPECT_EQ(drawn_of(crowd).size(), drawn);
    };
    update(0);
    std::vector<InstanceHandle> all = *crowd.spawn(0, std::vector(4, plot(3)));
    const std::vector<InstanceHandle> walkers = *crowd.spawn(1, std::vector(3, plot(5)));
    all.insert(all.end(), walkers.begin(), walkers.end());
    const Bounds bounds = world_bounds(crowd);
    EXPECT_GT(bounds.min.x, 2900) << "nobody stands at the origin";
    update(7);
    ASSERT_TRUE(crowd.despawn(all));
    EXPECT_EQ(world_bounds(crowd).min.x, 0);
    EXPECT_EQ(world_bounds(crowd).max.x, 0);
    update(0);
    update(0);
}

// A new instance in the slot of another that was drawn has no motion from it: its previous matrices equal its current
// ones.
TEST(Population, PreviousMatricesOfSpawnedInstancesAreTheirOwn) {
    const Device device = native_device();
    const Character character = creature(20, 8);
    Crowd crowd = std::move(
        *Crowd::create(device, {.groups = {{.character = &character, .capacity = 4}}, .keep_previous_matrices = true}));
    const Playback moving{.first = {.clip = 0, .time_s = 0.2}};
    InstanceHandle one = (*crowd.spawn(0, std::array{Affine{}}))[0];
    for (int update = 0; update < 4; ++update) {
        if (update == 3) {
            ASSERT_TRUE(crowd.despawn({&one, 1}));
            one = (*crowd.spawn(0, std::array{Affine{}}))[0];
            EXPECT_EQ(one, (InstanceHandle{0, 1}));
        }
        if (update % 3 == 0) {
            ASSERT_TRUE(crowd.set_playback(one, moving));
        }
        ASSERT_TRUE(crowd.update(0.1f));
        const HostOutputs& host = crowd.outputs()[0].host;
        const size_t size = host.skin.size() / 4;
        EXPECT_EQ(std::ranges::equal(host.skin.first(size), host.previous_skin.first(size)), update % 3 == 0) << update;
    }
}

// feedback() may report an update after its instances have been despawned and others spawned.
TEST(Population, EventsBelongToTheInstanceOfTheirUpdate) {
    const Character character = creature(20, 8);
    const Controller controller = example("dragon");
    Crowd crowd = create({.groups = {{.character = &character, .controller = &controller, .capacity = 2}}});
    const uint32_t forward = parameter_of(controller, "forward");
    uint32_t event_count = 0;
    for (uint32_t round = 0; round < 3; ++round) {
        const InstanceHandle one = (*crowd.spawn(0, std::array{Affine{}}))[0];
        EXPECT_EQ(one, (InstanceHandle{0, 2 * round}));
        ASSERT_TRUE(crowd.set_parameter(one, forward, 1.0f));
        for (int update = 0; update < 3; ++update) ASSERT_TRUE(crowd.update(0.7f));
        ASSERT_TRUE(crowd.despawn({&one, 1}));
        const InstanceHandle unseen = (*crowd.spawn(0, std::array{Affine{}}))[0];  // never in an update
        ASSERT_TRUE(crowd.despawn({&unseen, 1}));
        const std::vector<Feedback> all = *crowd.feedback();
        for (const Feedback& feedback : all)
            for (const CharacterEvent& event : feedback.events) {
                EXPECT_EQ(event.instance.generation, 2 * round);
                ++event_count;
            }
    }
    EXPECT_GT(event_count, 3u);
}

TEST(Population, DespawnedInstancesAreNoLongerWatched) {
    const Character character = creature(20, 8);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2, .sockets = {1}, .capacity = 2}}});
    ASSERT_TRUE(crowd.watch(Instances::numbered(0, 2)));
    ASSERT_TRUE(crowd.despawn(std::array{*crowd.handle(0)}));
    ASSERT_TRUE(crowd.spawn(0, std::array{Affine{}}));
    ASSERT_TRUE(crowd.update(0.1f));
    const Feedback feedback = feedback_of(crowd);
    ASSERT_EQ(feedback.watched.size(), 1u);
    EXPECT_EQ(feedback.watched[0].instance, InstanceHandle{1});
}

// In a view that sees no instance, groups with sockets are still animated, and none of their instances is listed.
TEST(Population, UnseenInstancesWithSocketsAreAnimated) {
    const Character character = creature(30, 10);
    const CrowdGroup group{.character = &character, .sockets = {3}};
    CrowdSettings settings{.groups = {group}, .culling = Culling{}};
    settings.groups[0].instance_count = 4;
    Crowd lasting = create(settings);
    settings.groups[0].instance_count = 0;
    settings.groups[0].capacity = 8;
    Crowd varying = create(settings);
    std::vector<InstanceHandle> alive = *varying.spawn(0, std::vector<Affine>(6));
    ASSERT_TRUE(varying.despawn(std::array{alive[0], alive[3]}));
    alive = {alive[1], alive[2], alive[4], alive[5]};
    Random random(4);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 4);
    ASSERT_TRUE(lasting.set_playback(lasting.instances(), playbacks));
    ASSERT_TRUE(varying.set_playback(alive, playbacks));
    ASSERT_TRUE(lasting.watch(lasting.instances()));
    ASSERT_TRUE(varying.watch(alive));
    const CrowdView elsewhere = view_of_box({1e5f, 0, 0}, 6);
    for (int update = 0; update < 3; ++update) {
        ASSERT_TRUE(lasting.update(0.1f, &elsewhere));
        ASSERT_TRUE(varying.update(0.1f, &elsewhere));
        EXPECT_EQ(drawn_of(varying).size(), 0u);
        const Feedback wanted = feedback_of(lasting), got = feedback_of(varying);
        for (uint32_t i = 0; i < 4; ++i) {
            EXPECT_TRUE(same_bits(*varying.read_skin_matrices(alive[i]), *lasting.read_skin_matrices({i})));
            EXPECT_TRUE(same_bits(got.watched.at(i).sockets, wanted.watched.at(i).sockets));
        }
    }
}

// The matrices are filled with a pattern before an update. Where it is still there afterwards, nothing was computed.
TEST(Population, FreeNumbersAreNotAnimatedStageByStage) {
    constexpr uint32_t kUntouched = 0xFFFFFFFF;
    const Character character = creature(20, 6);
    const Controller layered = direct_layers(2);
    Controller in_model_space = layered;
    in_model_space.layers.back().model_space_rotations = true;
    for (const Controller* const controller :
         std::initializer_list<const Controller*>{nullptr, &layered, &in_model_space}) {
        CrowdSettings settings{.groups = {{.character = &character, .controller = controller, .capacity = 7}},
                               .path = UpdatePath::kStaged,
                               .keep_model_matrices = true};
        if (has_scan("levels")) settings.scan = "levels";  // a workgroup for each instance, so that it can be left out
        Crowd crowd = create(settings);
        const std::vector<InstanceHandle> all = crowd.spawn(0, std::vector<Affine>(5)).value();
        ASSERT_TRUE(crowd.update(0.1f));
        ASSERT_TRUE(crowd.despawn(std::vector{all[1], all[3]}));
        ASSERT_TRUE(crowd.update(0.1f));
        const OutputBlock& block = crowd.outputs()[0];
        const auto expect_untouched = [&](const std::set<uint32_t>& numbers) {
            std::vector<std::pair<BufferView OutputBlock::*, uint32_t>> outputs{
                {&OutputBlock::skin, block.palette_count}};
            if (settings.scan == "levels") outputs.emplace_back(&OutputBlock::model, block.joint_count);
            for (const auto& [member, count] : outputs) {
                const uint64_t words = count * sizeof(Affine) / sizeof(uint32_t);
                test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
                    record_fill(*test_gpu(), commands, output_range(block, member, 0, 7 * words * sizeof(uint32_t)),
                                kUntouched);
                });
            }
            ASSERT_TRUE(crowd.update(0.1f));
            for (const auto& [member, count] : outputs) {
                const uint64_t words = count * sizeof(Affine) / sizeof(uint32_t);
                const auto got = output<uint32_t>(block, member, 7 * words);
                for (uint32_t i = 0; i < 5; ++i) EXPECT_EQ(got[i * words] == kUntouched, numbers.contains(i)) << i;
            }
        };
        expect_untouched({1, 3});
        ASSERT_TRUE(crowd.spawn(0, Affine{}));
        expect_untouched({3});
    }
}

// Skin pool rows go to the current instances, nearest first, and shared poses do not change.
TEST(Population, SkinPoolRowsGoToLivingInstances) {
    const Character character = creature(30, 10);
    CrowdGroup group{.character = &character, .instance_count = 20, .skin_pool = SkinPool{.capacity = 12}};
    Crowd lasting = create({.groups = {group}, .culling = Culling{}});
    group.instance_count = 0;
    group.capacity = 40;
    Crowd varying = create({.groups = {group}});
    const std::vector<InstanceHandle> all = *varying.spawn(0, std::vector<Affine>(40));
    std::vector<InstanceHandle> alive, despawned;
    for (const InstanceHandle& one : all) (one.instance % 2 == 0 ? alive : despawned).push_back(one);
    ASSERT_TRUE(varying.despawn(despawned));
    Random random(8);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 20);
    for (uint32_t i = 0; i < 20; ++i) {
        const Affine place = to_affine(Trs<float>{.translation = {0, 0, static_cast<float>(i)}});
        ASSERT_TRUE(lasting.set_placement(InstanceHandle{i}, place));
        ASSERT_TRUE(varying.set_placement(alive[i], place));
        ASSERT_TRUE(lasting.set_playback(InstanceHandle{i}, playbacks[i]));
        ASSERT_TRUE(varying.set_playback(alive[i], playbacks[i]));
    }
    const CrowdView view = view_of_box({0, 0, 9}, 8);
    for (int update = 0; update < 3; ++update) {
        ASSERT_TRUE(lasting.update(0.1f, &view));
        ASSERT_TRUE(varying.update(0.1f, &view));
        const std::vector<DrawnInstance> wanted = drawn_of(lasting), got = drawn_of(varying);
        ASSERT_EQ(got.size(), wanted.size());
        EXPECT_GT(got.size(), 12u) << "more than there are rows";
        for (size_t i = 0; i < got.size(); ++i) {
            EXPECT_EQ(got[i].instance, alive[wanted[i].instance].instance);
            EXPECT_EQ(got[i].skin_row, wanted[i].skin_row);
            EXPECT_TRUE(same_bits(*varying.read_skin_matrices({got[i].instance}),
                                  *lasting.read_skin_matrices({wanted[i].instance})));
        }
    }
}

TEST(Population, DespawnedAgentsDoNotBlock) {
    const Character character = creature(20, 8);
    const auto walk = [&](bool meets_another, bool it_goes) {
        Crowd crowd = create(
            {.groups = {{.character = &character, .steering = Steering{.radius = 0.5f, .speed = 3}, .capacity = 3}}});
        const Affine ahead = to_affine(Trs<float>{.translation = {0.1f, 0, 3}});
        const std::array places{Affine{}, meets_another ? ahead : plot(1), plot(2)};
        const std::vector<InstanceHandle> agents = *crowd.spawn(0, places);
        EXPECT_TRUE(crowd.set_destination(InstanceHandle{0}, Vec3<float>{0, 0, 20}));
        EXPECT_TRUE(crowd.watch(Instances::numbered(0)));
        if (it_goes) {
            EXPECT_TRUE(crowd.despawn({&agents[1], 1}));
        }
        Affine place;
        for (int update = 0; update < 20; ++update) {
            EXPECT_TRUE(crowd.update(0.1f));
            place = feedback_of(crowd).watched.at(0).world_from_model;
        }
        return place.row;
    };
    const auto alone = walk(false, false);
    EXPECT_NE(walk(true, false), alone);
    EXPECT_EQ(walk(true, true), alone);
}

// A new agent starts at rest: it does not take over the step of the agent that had its slot before. The same holds if
// it is spawned in an update with a time step of 0.
TEST(Population, SpawnedAgentsStartAtRest) {
    const Character character = creature(20, 8);
    const std::array ahead{Vec3<float>{0, 0, 500}};
    const auto walk = [&](bool has_predecessor, float born_in_s) {
        Crowd crowd = create(
            {.groups = {{.character = &character, .steering = Steering{.radius = 0.5f, .speed = 3}, .capacity = 1}}});
        if (has_predecessor) {
            const std::vector<InstanceHandle> old = *crowd.spawn(0, std::array{Affine{}});
            EXPECT_TRUE(crowd.set_destination(crowd.instances(), ahead));
            for (int update = 0; update < 20; ++update) EXPECT_TRUE(crowd.update(0.1f));
            EXPECT_TRUE(crowd.despawn(old));
        }
        EXPECT_TRUE(crowd.spawn(0, std::array{Affine{}}));
        EXPECT_TRUE(crowd.update(born_in_s));
        EXPECT_TRUE(crowd.set_destination(crowd.instances(), ahead));
        EXPECT_TRUE(crowd.watch(Instances::numbered(0)));
        EXPECT_TRUE(crowd.update(0.01f));
        return (*crowd.feedback()).back().watched.at(0).world_from_model.row;
    };
    for (const float born_in_s : {0.01f, 0.0f, -0.01f})
        EXPECT_EQ(walk(true, born_in_s), walk(false, born_in_s)) << born_in_s;
}

// Commands for an instance that is despawned before the next update leave nothing behind, and commands for other
// instances are kept.
TEST(Population, CommandsForDespawnedInstancesAreDropped) {
    const Character character = creature(20, 8);
    const Controller controller = example("dragon");
    const uint32_t forward = parameter_of(controller, "forward");
    Crowd crowd = create({.groups = {{.character = &character, .controller = &controller, .capacity = 2}}});
    const InstanceHandle stays = *crowd.spawn(0, Affine{});
    ASSERT_TRUE(crowd.set_parameter(stays, forward, 1.0f));
    const auto come = [&](float value) {
        const InstanceHandle one = *crowd.spawn(0, Affine{});
        EXPECT_TRUE(crowd.set_parameter(one, forward, value));
        return one;
    };
    EXPECT_TRUE(crowd.despawn(come(2)));
    const size_t once_bytes = crowd.save_state()->size();
    for (int life = 0; life < 2000; ++life) EXPECT_TRUE(crowd.despawn(come(3)));
    EXPECT_LT(crowd.save_state()->size(), once_bytes + 1000);
    ASSERT_TRUE(crowd.watch(std::array{stays, come(4)}));
    ASSERT_TRUE(crowd.update(0));
    const Feedback feedback = feedback_of(crowd);
    EXPECT_EQ(feedback.watched.at(0).parameters[forward], 1);
    EXPECT_EQ(feedback.watched.at(1).parameters[forward], 4);
}

// Instances spawned and despawned in a dropped frame take effect in the next one, whether before or after the record.
TEST(Population, DiscardedSpawnsAndDespawnsTakeEffectLater) {
    const Character character = creature(20, 8);
    const Controller controller = example("dragon");
    const CrowdSettings settings{.groups = {{.character = &character, .controller = &controller, .capacity = 8},
                                            {.character = &character, .sockets = {1}, .capacity = 8}},
                                 .path = UpdatePath::kDevice};
    std::array crowds{create(settings), create(settings)};
    Recorder recorder;
    Random random(9);
    std::vector<InstanceHandle> alive;
    const uint32_t forward = parameter_of(controller, "forward");
    const auto change = [&] {
        if (alive.size() > 4 && random.chance(0.6)) {
            std::swap(alive[random.below(static_cast<uint32_t>(alive.size()))], alive.back());
            for (Crowd& crowd : crowds) ASSERT_TRUE(crowd.despawn({&alive.back(), 1}));
            alive.pop_back();
        }
        const std::array place{plot(random.below(100))};
        const uint32_t group = random.below(2);
        const Result<std::vector<InstanceHandle>> come[2] = {crowds[0].spawn(group, place),
                                                             crowds[1].spawn(group, place)};
        ASSERT_EQ(refusal(come[0]), refusal(come[1]));
        if (!come[0]) return;
        EXPECT_EQ(*come[0], *come[1]);
        alive.push_back((*come[0])[0]);
        for (Crowd& crowd : crowds) EXPECT_TRUE(group != 0 || crowd.set_parameter(alive.back(), forward, 1.0f));
    };
    size_t event_count = 0;
    for (int update = 0; update < 60; ++update) {
        change();
        while (random.chance(0.5)) {
            recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowds[1].record(commands, 0.2f)); });
            for (uint32_t i = random.below(3); i > 0; --i) change();
            EXPECT_TRUE(crowds[1].discard_last_record());
        }
        for (Crowd& crowd : crowds) ASSERT_TRUE(crowd.update(0.3f));
        for (uint32_t i = random.below(3); i > 0; --i) change();  // before feedback() is called
        const Feedback a = feedback_of(crowds[0]), b = feedback_of(crowds[1]);
        EXPECT_TRUE(same_events(a, b)) << update;
        event_count += a.events.size();
        const auto number = [](const DrawnInstance& one) { return one.instance; };
        const std::vector<DrawnInstance> drawn[2] = {drawn_of(crowds[0]), drawn_of(crowds[1])};
        EXPECT_TRUE(std::ranges::equal(drawn[0], drawn[1], {}, number, number)) << update;
        for (const DrawnInstance& one : drawn[0])
            if (const Result<InstanceHandle> handle = crowds[0].handle(one.instance)) {
                EXPECT_TRUE(same_bits(*crowds[0].read_skin_matrices(*handle), *crowds[1].read_skin_matrices(*handle)))
                    << update;
            }
    }
    EXPECT_GT(event_count, 20u);
}

}  // namespace
}  // namespace throng::test
