// A crowd that restores a saved state goes on exactly as the crowd that saved it, bit for bit.
#include "base/crc64.h"
#include "tests/contents.h"
#include "tests/kinds.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kSavedStateNatively({Subset::kNative}, {"SavedState.*"});

std::vector<InstanceHandle> alive_in(const Crowd& crowd) {
    std::vector<InstanceHandle> alive;
    for (uint32_t i = 0; i < crowd.instance_count(); ++i)
        if (const Result<InstanceHandle> handle = crowd.handle(i)) alive.push_back(*handle);
    return alive;
}

// Makes random calls as an application does: the same calls for crowds in the same state.
class Application {
public:
    Application(UpdatePath path, const Culling& culling) : settings_(kinds_.settings(path)) {
        settings_.culling = culling;
        settings_.pose_request_capacity = 4;
        for (CrowdGroup& group : settings_.groups) {
            group.instance_count = 6;
            group.capacity = kGroupCapacity;
        }
        settings_.groups.push_back({.character = &kinds_.character, .instance_count = 5, .pose_capacity = 3});
        settings_.groups.push_back(
            {.character = &kinds_.character, .instance_count = 4, .sockets = {1}, .is_carried = true});
    }

    Crowd make() const {
        Crowd crowd = create(settings_);
        std::vector<Affine> places;
        for (uint32_t i = 0; i < crowd.instance_count(); ++i) places.push_back(plot(i));
        for (const InstanceHandle& one : alive_in(crowd)) EXPECT_TRUE(crowd.set_placement(one, places[one.instance]));
        return crowd;
    }

    void play(Crowd& crowd, uint32_t update) const {
        Random random(update);
        const std::vector<InstanceHandle> alive = alive_in(crowd);
        std::vector<InstanceHandle> despawned;
        EXPECT_TRUE(crowd.watch(std::vector(alive.begin(), alive.begin() + 20)));
        for (const InstanceHandle& one : alive) {
            if (random.chance(0.3)) change(crowd, one, random);
            if (one.instance < kKinds * kGroupCapacity && random.chance(0.1)) despawned.push_back(one);
        }
        EXPECT_TRUE(crowd.despawn(despawned));
        for (uint32_t group = 0; group < kKinds; ++group) {
            if (*crowd.alive_count(group) + 2 > kGroupCapacity) continue;
            EXPECT_TRUE(crowd.spawn(group, std::array{plot(random.below(900)), plot(random.below(900))}));
        }
        attach_at_random(crowd, random);
        EXPECT_TRUE(crowd.set_wind({.velocity = random.vector(3).as<float>()}));
        EXPECT_TRUE(crowd.request_poses(*crowd.handle(kKinds * kGroupCapacity)));
    }

    // All outputs and feedback of the updates from `first` up to, but not including, `end`.
    std::string go_on(Crowd& crowd, uint32_t first, uint32_t end) const {
        std::string bits;
        for (uint32_t update = first; update < end; ++update) {
            if (update > first) play(crowd, update);
            Random random(1000 + update);
            const float size = kinds_.character.size;
            CrowdView view = view_of_box({static_cast<float>(random.between(0, 9000)), 0, 0}, 9000 + 100 * size);
            view.full_rate_pixels = 1e4f;  // no instance is as large, so all skip updates where allowed
            const Result<void> updated = crowd.update(static_cast<float>(random.between(0, 0.1f)),
                                                      update % 3 == 0 ? nullptr : &view);
            EXPECT_TRUE(updated) << refusal(updated);
            for (const auto& [name, bytes] : contents_of(crowd.outputs())) bits += name + bytes;
            UpdateBits told;
            told.add_feedback(crowd);
            bits.append(reinterpret_cast<const char*>(told.all.data()), told.all.size());
        }
        return bits;
    }

private:
    static constexpr uint32_t kKinds = 5, kCarriers = 2, kCarried = 6;

    // Attaches some carried instances to others that have sockets, or to another carried instance.
    static void attach_at_random(Crowd& crowd, Random& random) {
        const Instances carried = *crowd.instances(kCarried), carriers = *crowd.instances(kCarriers);
        for (uint32_t i = 0; i < carried.size(); ++i) {
            if (random.chance(0.5)) continue;
            const InstanceHandle thing = *crowd.handle(carried.number(i));
            const bool is_second = i > 0 && random.chance(0.4);
            const auto carrier = crowd.handle(is_second ? carried.number(random.below(i))
                                                        : carriers.number(random.below(carriers.size())));
            const uint32_t socket = random.below(is_second ? 1 : 2);
            EXPECT_TRUE(carrier ? crowd.attach(thing, Attachment{.carrier = *carrier, .socket = socket})
                                : crowd.detach(thing));
        }
    }

    void change(Crowd& crowd, const InstanceHandle& one, Random& random) const {
        const uint32_t group = one.instance / kGroupCapacity;
        const float x = plot(one.instance).row[0][3] + static_cast<float>(random.between(-20, 20));
        const std::vector<Trs<float>> pose(kinds_.character.rig.rest);
        const float fade_s = static_cast<float>(random.between(0, 0.3f));
        Result<void> done;
        if (group == 1 || group == 2) {
            const auto [parameter, value] = random_change(random, group == 1 ? kinds_.walker : kinds_.dragon);
            done = crowd.set_parameter(one, parameter, value);
        } else {
            done = crowd.set_playback(one, random_playback(random, kinds_.character));
        }
        EXPECT_TRUE(done) << refusal(done);
        if (group == 0) done = random.chance(0.6) ? crowd.set_pose(one, pose, fade_s) : crowd.clear_pose(one, fade_s);
        if (group == 3) done = crowd.set_target(one, 0, {{x, 1, 2}, 0.5f});
        if (group == 4) done = crowd.set_destination(one, {x, 0, 2});
        EXPECT_TRUE(done) << refusal(done);
    }

    Kinds kinds_;
    CrowdSettings settings_;
};

struct Case {
    const char* name;
    UpdatePath path;
    Culling culling;
};

class SavedStateOnPath : public testing::TestWithParam<Case> {};

// Saved while changes wait for the next update, between two updates for views, so that some instances are interpolating
// toward a later pose.
TEST_P(SavedStateOnPath, ARestoredCrowdContinuesBitForBit) {
    const Application application(GetParam().path, GetParam().culling);
    Crowd crowd = application.make();
    constexpr uint32_t kSaved = 8, kEnd = 15;
    application.go_on(crowd, 0, kSaved);
    application.play(crowd, kSaved);
    const Result<std::vector<std::byte>> saved = crowd.save_state();
    ASSERT_TRUE(saved) << refusal(saved);
    const std::string wanted = application.go_on(crowd, kSaved, kEnd);
    EXPECT_GT(wanted.size(), 100'000u);

    EXPECT_TRUE(crowd.restore_state(*saved));
    EXPECT_TRUE(*crowd.save_state() == *saved);
    EXPECT_TRUE(application.go_on(crowd, kSaved, kEnd) == wanted) << "the crowd itself";

    Crowd other = application.make();
    for (uint32_t updates = 0; updates < 3; ++updates) {
        EXPECT_TRUE(other.restore_state(*saved));
        EXPECT_TRUE(*other.save_state() == *saved);
        EXPECT_TRUE(application.go_on(other, kSaved, kEnd) == wanted) << "another crowd";
        other = application.make();
        application.go_on(other, 50, 52 + updates);
    }
}

INSTANTIATE_TEST_SUITE_P(SavedState, SavedStateOnPath,
                         testing::Values(Case{"Auto", UpdatePath::kAuto, {}}, Case{"Device", UpdatePath::kDevice, {}},
                                         Case{"Staged", UpdatePath::kStaged, {}},
                                         Case{"AutoSkipping", UpdatePath::kAuto, {.skips_updates = true}},
                                         Case{"DeviceSkipping", UpdatePath::kDevice, {.skips_updates = true}}),
                         [](const testing::TestParamInfo<Case>& of) { return std::string(of.param.name); });

class SavedState : public testing::Test {
protected:
    CrowdSettings settings(uint32_t count = 4) const {
        return {.groups = {{.character = &character_, .instance_count = count, .pose_capacity = 2}}};
    }
    Crowd that_may_request(uint32_t pose_request_capacity) const {
        CrowdSettings made = settings();
        made.pose_request_capacity = pose_request_capacity;
        return create(made);
    }
    static std::string skin_of(const Crowd& crowd) { return contents_of(crowd.outputs()).at("0: skin"); }
    Character character_ = creature(20, 8);
};

// With previous matrices, in slots of frames in flight.
TEST_F(SavedState, KeepsThePreviousUpdatesMatrices) {
    CrowdSettings of = settings();
    of.keep_previous_matrices = true;
    for (const uint32_t in_flight : {1u, 3u}) {
        of.frames_in_flight = in_flight;
        Crowd crowd = create(of), other = create(of), fresh = create(of);
        ASSERT_TRUE(other.update(0.4f));
        ASSERT_TRUE(crowd.set_playback(crowd.instances(), {.first = {.clip = 0}}));
        for (int update = 0; update < 3; ++update) ASSERT_TRUE(crowd.update(0.1f));
        for (Crowd* const one : {&other, &fresh}) ASSERT_TRUE(one->restore_state(*crowd.save_state()));
        for (Crowd* const one : {&crowd, &other, &fresh}) ASSERT_TRUE(one->update(0.1f));
        const Contents wanted = contents_of(crowd.outputs());
        EXPECT_NE(wanted.at("0: skin"), wanted.at("0: previous skin"));
        for (Crowd* const one : {&other, &fresh})
            expect_same(wanted, contents_of(one->outputs()), "in flight " + std::to_string(in_flight));
    }
}

// A budget that no update meets lowers the rate further and further, until every instance is animated only in every
// eighth update.
TEST_F(SavedState, KeepsTheRateLoweredByABudget) {
    CrowdSettings of = settings(16);
    of.culling = Culling{.skips_updates = true};
    of.groups[0].pose_capacity = 0;
    const CrowdView unlimited = view_of_box({}, 10 * character_.size);
    CrowdView view = unlimited;
    view.full_rate_pixels = 1;  // at first, all instances are larger
    view.budget_ms = 1e-6f;
    Crowd crowd = create(of), other = create(of), at_full_rate = create(of);
    for (Crowd* const one : {&crowd, &at_full_rate})
        ASSERT_TRUE(one->set_playback(one->instances(), {.first = {.clip = 0}}));
    for (int update = 0; update < 16; ++update) {
        ASSERT_TRUE(crowd.update(0.03f, &view));
        ASSERT_TRUE(at_full_rate.update(0.03f, &unlimited));
    }
    if (!crowd.stage_times()) GTEST_SKIP() << "the device measures no times";
    EXPECT_FALSE(skin_of(crowd) == skin_of(at_full_rate)) << "nobody skips an update";
    ASSERT_TRUE(other.restore_state(*crowd.save_state()));
    for (int update = 0; update < 4; ++update) {
        for (Crowd* const one : {&crowd, &other}) ASSERT_TRUE(one->update(0.03f, &view));
        EXPECT_TRUE(skin_of(crowd) == skin_of(other)) << update;
    }
}

TEST_F(SavedState, CanBeSavedBeforeTheFirstUpdate) {
    Crowd crowd = create(settings()), other = create(settings());
    ASSERT_TRUE(crowd.set_playback(InstanceHandle{2}, {.first = {.clip = 0, .time_s = 0.3}}));
    ASSERT_TRUE(other.update(1));
    ASSERT_TRUE(other.restore_state(*crowd.save_state()));
    for (Crowd* const one : {&crowd, &other}) ASSERT_TRUE(one->update(0.1f));
    expect_same(contents_of(crowd.outputs()), contents_of(other.outputs()), "");
}

TEST_F(SavedState, KeepsTheOrderOfWatchedInstances) {
    CrowdSettings of = settings();
    of.groups[0].sockets = {3};
    Crowd crowd = create(of), other = create(of);
    const std::array asked{InstanceHandle{2}, InstanceHandle{0}, InstanceHandle{3}};
    ASSERT_TRUE(crowd.watch(asked));
    ASSERT_TRUE(other.restore_state(*crowd.save_state()));
    for (Crowd* const one : {&crowd, &other}) {
        ASSERT_TRUE(one->update(0.1f));
        const Feedback feedback = feedback_of(*one);
        EXPECT_TRUE(std::ranges::equal(feedback.watched, asked, {}, &WatchedInstance::instance));
    }
}

// A refused state leaves the crowd as it was.
TEST_F(SavedState, RefusesDamagedAndForeignStates) {
    Crowd crowd = create(settings()), same = create(settings());
    const std::vector<Trs<float>> pose(character_.rig.rest);
    for (Crowd* const one : {&crowd, &same}) {
        ASSERT_TRUE(one->set_playback(one->instances(), {.first = {.clip = 0}}));
        ASSERT_TRUE(one->set_pose(InstanceHandle{1}, pose, 0.3f));
        ASSERT_TRUE(one->update(0.1f));
    }
    const std::vector<std::byte> saved = *crowd.save_state();
    Random random(3);
    for (int i = 0; i < 300; ++i) {
        std::vector<std::byte> damaged = saved;
        damaged[random.below(static_cast<uint32_t>(damaged.size()))] ^= std::byte{1};
        EXPECT_EQ(crowd.restore_state(damaged).error().code, ErrorCode::kInvalidFile);
        const auto shorter = std::span(saved).first(random.below(static_cast<uint32_t>(saved.size())));
        EXPECT_EQ(crowd.restore_state(shorter).error().code, ErrorCode::kInvalidFile);
    }
    const std::string mismatch = "crowd state: it does not fit this crowd: ";
    const std::string of_group = mismatch + "a group's character, controller or another CrowdGroup setting differs";
    EXPECT_EQ(refusal(create(settings(5)).restore_state(saved)),
              mismatch + "a group's instance_count or capacity differs");
    CrowdSettings other = settings();
    other.groups[0].pose_capacity = 3;
    EXPECT_EQ(refusal(create(other).restore_state(saved)), of_group);
    other = settings();
    other.skin_format = SkinFormat::kHalfAffine;
    EXPECT_EQ(refusal(create(other).restore_state(saved)),
              mismatch + "CrowdSettings::skin_format, keep_previous_matrices or culling differs");
    other = settings();
    other.groups[0].pose_margin = 3;
    EXPECT_EQ(refusal(create(other).restore_state(saved)), of_group);
    other = settings();
    other.groups[0].steering = Steering{};
    EXPECT_EQ(refusal(create(other).restore_state(saved)), of_group);
    other = settings();
    other.path = UpdatePath::kStaged;
    Crowd staged = create(other);
    ASSERT_NE(staged.path(0)->is_fused, crowd.path(0)->is_fused);
    EXPECT_EQ(refusal(staged.restore_state(saved)),
              mismatch + "groups are updated in another way (natively or on a device, CrowdSettings::path, scan)");
    EXPECT_EQ(refusal(crowd.restore_state({})), "crowd state: it ends too early");
    EXPECT_FALSE(Crowd().save_state());
    EXPECT_FALSE(Crowd().restore_state(saved));
    for (Crowd* const one : {&crowd, &same}) ASSERT_TRUE(one->update(0.1f));
    expect_same(contents_of(crowd.outputs()), contents_of(same.outputs()), "after refusals");
}

// All counts are equal, but a group's socket is on another joint, or the state has more watched instances than
// watch_capacity.
TEST_F(SavedState, RefusesOtherSocketsAndTooManyWatchedInstances) {
    const auto with = [&](uint32_t socket, uint32_t watch_capacity) {
        CrowdSettings made = settings();
        made.groups[0].sockets = {socket};
        made.watch_capacity = watch_capacity;
        return create(made);
    };
    Crowd crowd = with(1, 2), other = with(2, 2), narrow = with(1, 1);
    ASSERT_TRUE(crowd.watch(std::array{InstanceHandle{0}, InstanceHandle{1}}));
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<std::byte> saved = *crowd.save_state();
    const std::string mismatch = "crowd state: it does not fit this crowd: ";
    EXPECT_EQ(refusal(other.restore_state(saved)),
              mismatch + "a group's character, controller or another CrowdGroup setting differs");
    const Result<void> refused = narrow.restore_state(saved);
    EXPECT_EQ(refusal(refused), mismatch + "it has 2 watched instances, but CrowdSettings::watch_capacity is 1");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

TEST_F(SavedState, RefusesTooManyPoseRequests) {
    Crowd crowd = that_may_request(4), narrow = that_may_request(1);
    ASSERT_TRUE(crowd.request_poses(Instances::numbered(0, 3)));
    const Result<void> refused = narrow.restore_state(*crowd.save_state());
    EXPECT_EQ(refusal(refused),
              "crowd state: it does not fit this crowd: it has 3 requested poses, more than twice "
              "CrowdSettings::pose_request_capacity, which is 1");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
    ASSERT_TRUE(narrow.update(0.1f));
    EXPECT_TRUE(feedback_of(narrow).poses.empty());
}

// Then generation_at() finds the right generations.
TEST_F(SavedState, FeedbackContinuesTheNumbersOfACrowdWithout) {
    Crowd without = that_may_request(0), crowd = that_may_request(4);
    for (int update = 0; update < 5; ++update) ASSERT_TRUE(without.update(0.1f));
    ASSERT_TRUE(crowd.restore_state(*without.save_state()));
    ASSERT_TRUE(crowd.request_poses(InstanceHandle{1}) && crowd.update(0.1f));
    EXPECT_EQ(feedback_of(crowd).update, 6u);
}

// Replaces numbers in a state, and its checksum.
template <class Number>
std::vector<std::byte> crafted(std::vector<std::byte> state, Number number, Number by) {
    size_t replaced = 0;
    for (size_t at = 0; at + sizeof number <= state.size(); ++at)
        if (std::memcmp(&state[at], &number, sizeof number) == 0) {
            std::memcpy(&state[at], &by, sizeof by);
            ++replaced;
        }
    EXPECT_GT(replaced, 0u) << number;
    const uint64_t checksum = crc64(std::span(state).first(state.size() - sizeof(uint64_t)));
    std::memcpy(&state[state.size() - sizeof checksum], &checksum, sizeof checksum);
    return state;
}

TEST_F(SavedState, RefusesNumbersThatCallsRefuse) {
    constexpr float kPlace = 123.456f, kSpeed = 7.125f, kAside = 0.34375f;
    const ProceduralRules rules{.targets = {"there"},
                                .rules = {LookAtRule{.joint = character_.rig.names[2], .target = "there"}}};
    Crowd crowd = create({.groups = {{.character = &character_,
                                      .instance_count = 2,
                                      .procedural = &rules,
                                      .steering = Steering{},
                                      .pose_capacity = 2}}});
    std::vector<Trs<float>> pose(character_.rig.rest);
    pose[1].translation.x = kAside;
    ASSERT_TRUE(crowd.set_target(InstanceHandle{1}, 0, TargetPlace{{kPlace, 0, 0}, 1}));
    ASSERT_TRUE(crowd.set_destination(InstanceHandle{1}, Vec3<float>{2 * kPlace, 0, 0}));
    ASSERT_TRUE(crowd.set_wind({.velocity = {0, 0, kSpeed}}));
    ASSERT_TRUE(crowd.set_pose(InstanceHandle{1}, pose, 1 / 4.625f));
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<std::byte> saved = *crowd.save_state();
    const auto nan = static_cast<float>(kNan);
    const auto expect_refused = [&](const std::vector<std::byte>& state) {
        const Result<void> restored = crowd.restore_state(state);
        ASSERT_FALSE(restored);
        EXPECT_EQ(restored.error().code, ErrorCode::kInvalidFile) << refusal(restored);
    };
    expect_refused(crafted(saved, kPlace, nan));
    expect_refused(crafted(saved, 2 * kPlace, nan));
    expect_refused(crafted(saved, double{kSpeed}, double{kNan}));
    expect_refused(crafted(saved, kAside, nan));
    expect_refused(crafted(saved, 1 / (1 / 4.625f), -1.0f));
    EXPECT_TRUE(crowd.restore_state(saved));
}

// Another clip of the same length or another joint would go unnoticed until the result is seen.
TEST_F(SavedState, RefusesOtherClipAndJointNames) {
    Crowd crowd = create(settings());
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<std::byte> saved = *crowd.save_state();
    Character other_clips = character_, other_joints = character_;
    std::swap(other_clips.clips[0].name, other_clips.clips[1].name);
    std::swap(other_joints.rig.names[1], other_joints.rig.names[2]);
    for (const Character* const other : {&other_clips, &other_joints}) {
        CrowdSettings of = settings();
        of.groups[0].character = other;
        EXPECT_EQ(refusal(create(of).restore_state(saved)),
                  "crowd state: it does not fit this crowd: a group's character, controller or another CrowdGroup "
                  "setting differs");
    }
}

// After a restore, the next pose takes the same slot as in the original crowd, whatever the order in which slots were
// freed.
TEST_F(SavedState, PosesTakeTheSameSlotsAfterARestore) {
    CrowdSettings of = settings();
    of.groups[0].pose_capacity = 3;
    Crowd crowd = create(of), other = create(of);
    const std::vector<Trs<float>> pose(character_.rig.rest);
    ASSERT_TRUE(crowd.set_pose(Instances::numbered(0, 3), pose));
    ASSERT_TRUE(crowd.update(0.1f));
    for (const uint32_t instance : {0u, 2u}) ASSERT_TRUE(crowd.clear_pose(InstanceHandle{instance}));
    ASSERT_TRUE(other.restore_state(*crowd.save_state()));
    for (Crowd* const one : {&crowd, &other}) {
        ASSERT_TRUE(one->set_pose(InstanceHandle{3}, pose));
        ASSERT_TRUE(one->update(0.1f));
    }
    EXPECT_TRUE(*crowd.save_state() == *other.save_state());
}

TEST_F(SavedState, IsSavedIntoExistingMemory) {
    Crowd crowd = create(settings());
    ASSERT_TRUE(crowd.update(0.1f));
    std::vector<std::byte> out(1'000'000, std::byte{7});
    const std::byte* const memory = out.data();
    ASSERT_TRUE(crowd.save_state(out));
    EXPECT_EQ(out.data(), memory);
    EXPECT_TRUE(out == *crowd.save_state());
    EXPECT_FALSE(Crowd().save_state(out));
    EXPECT_TRUE(out == *crowd.save_state()) << "refused before anything was written";
}

TEST_F(SavedState, RefusesOtherRulesAndControllers) {
    const auto rules = [&](float frequency_hz, const char* target) {
        return ProceduralRules{.targets = {target},
                               .rules = {SpringRule{.joint = character_.rig.names[2], .frequency_hz = frequency_hz}}};
    };
    const auto plays = [&](size_t clip) {
        return Controller{.layers = {{.name = "all",
                                      .states = {{.name = "one", .points = {{.clip = character_.clips[clip].name}}}}}}};
    };
    const ProceduralRules slow = rules(1, "eye"), fast = rules(2, "eye"), renamed = rules(1, "sun");
    const Controller first = plays(0), second = plays(1);
    const auto with = [&](const ProceduralRules& of, const Controller& controller, float radius) {
        CrowdSettings made = settings();
        made.groups[0].procedural = &of;
        made.groups[0].controller = &controller;
        made.groups[0].steering = Steering{.radius = radius};
        return create(made);
    };
    Crowd crowd = with(slow, first, 1), same = with(slow, first, 1);
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<std::byte> saved = *crowd.save_state();
    EXPECT_TRUE(same.restore_state(saved));
    Crowd others[]{with(fast, first, 1), with(renamed, first, 1), with(slow, second, 1), with(slow, first, 2)};
    for (Crowd& other : others) {
        const Result<void> refused = other.restore_state(saved);
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().text().find("controller or another CrowdGroup setting differs"), std::string::npos);
    }
}

// Games compare states to find where two machines have parted.
TEST_F(SavedState, IsEqualForCrowdsDrivenAlike) {
    const auto state = [&](const char* name, size_t clip) {
        return ControllerState{.name = name, .points = {{.clip = character_.clips[clip].name}}};
    };
    const Controller controller{
        .layers = {{.name = "all",
                    .states = {state("one", 0), state("two", 1)},
                    .transitions = {
                        {.from = "one", .to = "two", .exit = 0.1f, .fade_s = 0.3f, .fade = FadeKind::kInertial}}}}};
    const auto driven = [&](bool is_inertial) {
        CrowdSettings of = settings(2);
        if (!test_device().gpu()->is_native()) of.path = UpdatePath::kDevice;
        of.groups[0].capacity = 40;
        of.groups[0].pose_capacity = 0;
        if (is_inertial)
            of.groups[0].controller = &controller;
        else
            of.keep_previous_matrices = true;
        Crowd crowd = create(of);
        EXPECT_TRUE(crowd.spawn(0, std::vector<Affine>(5)));
        for (int update = 0; update < 4; ++update) EXPECT_TRUE(crowd.update(0.1f));
        return *crowd.save_state();
    };
    const auto dirty_the_memory = [&] {
        CrowdSettings other = settings(100);
        if (!test_device().gpu()->is_native()) other.path = UpdatePath::kDevice;
        other.keep_previous_matrices = true;
        Crowd crowd = create(other);
        for (int update = 0; update < 3; ++update) EXPECT_TRUE(crowd.update(0.1f));
    };
    for (const bool is_inertial : {false, true}) {
        const std::vector<std::byte> first = driven(is_inertial);
        for (int run = 0; run < 3; ++run) {
            dirty_the_memory();
            EXPECT_EQ(driven(is_inertial), first) << is_inertial << ", run " << run;
        }
    }
}

// Submitted updates are in the state, discarded ones are not.
TEST_F(SavedState, ContainsSubmittedButNotDiscardedUpdates) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    CrowdSettings of = settings();
    of.path = UpdatePath::kDevice;
    Crowd crowd = create(of), other = create(of);
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), {.first = {.clip = 0}}));
    Recorder recorder;
    const auto record = [&](Crowd& into) {
        return recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(into.record(commands, 0.1f)); });
    };
    for (int update = 0; update < 3; ++update) recorder.submit(record(crowd));
    record(crowd);
    ASSERT_TRUE(crowd.discard_last_record());
    ASSERT_TRUE(other.restore_state(*crowd.save_state()));
    EXPECT_FALSE(other.discard_last_record()) << "there is none";
    for (Crowd* const one : {&crowd, &other}) recorder.submit(record(*one));
    expect_same(contents_of(crowd.outputs()), contents_of(other.outputs()), "");
}

}  // namespace
}  // namespace throng::test
