// Calls for one instance and for many, addressed by handles and by numbers.
#include "tests/crowd_cases.h"

#include <limits>

namespace throng::test {
namespace {

// The example walker, with an extra layer for play() above the states.
Controller walker_and_layer() {
    Controller controller = example("walker");
    controller.layers.push_back({.name = "played"});
    return controller;
}

class CrowdCalls : public testing::Test {
protected:
    Character character = creature(20, 5);
    Controller controller = walker_and_layer();
    ProceduralRules rules{.targets = {"prey"},
                          .rules = {LookAtRule{.joint = character.rig.names[1], .target = "prey"}}};
    // Groups of three: two clips with capacity for poses; a controller; rules; agents. Then four that are spawned and
    // despawned.
    CrowdSettings settings{
        .groups = {{.character = &character, .instance_count = 3, .pose_capacity = 2},
                   {.character = &character, .instance_count = 3, .controller = &controller},
                   {.character = &character, .instance_count = 3, .procedural = &rules},
                   {.character = &character, .instance_count = 3, .steering = Steering{.radius = 0.5f, .speed = 3}},
                   {.character = &character, .pose_capacity = 4, .capacity = 4}},
        .culling = Culling{}};

    static void expect_same(Crowd& a, Crowd& b, const std::vector<InstanceHandle>& instances) {
        ASSERT_TRUE(a.update(0.1f) && b.update(0.1f));
        for (const InstanceHandle& one : instances)
            EXPECT_EQ(*a.read_skin_matrices(one), *b.read_skin_matrices(one)) << "instance " << one.instance;
    }
    static std::string not_alive_message(const std::string& place) {
        return place + ": instance 12 of generation 0 is not alive";
    }
};

TEST_F(CrowdCalls, OneCallForManyEqualsACallForEach) {
    Crowd together = create(settings), one_by_one = create(settings);
    Random random(31);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 3);
    const std::array<Affine, 3> places{placed_at(1, 0, 2), placed_at(3, 0, 4), placed_at(5, 0, 6)};
    const std::vector<InstanceHandle> mixed{{8}, {0}, {6}};  // of several groups, unordered
    ASSERT_TRUE(together.set_playback(mixed, playbacks) && together.set_placement(mixed, places));
    for (size_t i = 0; i < 3; ++i)
        ASSERT_TRUE(one_by_one.set_playback(mixed[i], playbacks[i]) && one_by_one.set_placement(mixed[i], places[i]));
    const std::array<LayerPlayback, 2> plays{LayerPlayback{.clip = {.clip = 0, .time_s = 0.3}},
                                             LayerPlayback{.clip = {.clip = 1}, .fade_s = 0.2f}};
    const std::array<InstanceHandle, 2> driven{InstanceHandle{5}, InstanceHandle{3}};
    const auto layer = static_cast<uint32_t>(controller.layers.size()) - 1;
    ASSERT_TRUE(together.play(driven, layer, plays) && together.set_layer(driven, layer, {.weight = 0.5f}));
    ASSERT_TRUE(together.set_parameter(driven, 0, std::array{1.0f, 0.5f}));
    ASSERT_TRUE(together.set_target(Instances::numbered(6, 3), 0, {.world_place = {9, 2, 9}}));
    ASSERT_TRUE(together.set_destination(*together.instances(3), {30, 0, 30}));
    for (uint32_t i = 0; i < 2; ++i)
        ASSERT_TRUE(one_by_one.play(driven[i], layer, plays[i]) &&
                    one_by_one.set_layer(driven[i], layer, std::array{LayerBlend{.weight = 0.5f}}) &&
                    one_by_one.set_parameter(driven[i], 0, i == 0 ? 1.0f : 0.5f));
    for (uint32_t i = 0; i < 3; ++i)
        ASSERT_TRUE(one_by_one.set_target(InstanceHandle{6 + i}, 0, {{9, 2, 9}, 1}) &&
                    one_by_one.set_destination(InstanceHandle{9 + i}, {30, 0, 30}));
    std::vector<InstanceHandle> all;
    for (uint32_t i = 0; i < 12; ++i) all.push_back({i});
    for (int update = 0; update < 4; ++update) expect_same(together, one_by_one, all);
    EXPECT_NE(*together.read_skin_matrices({5}), *together.read_skin_matrices({4})) << "something was set";
    EXPECT_NE(*together.read_skin_matrices({6}), *together.read_skin_matrices({7})) << "something was set";
}

TEST_F(CrowdCalls, SetPoseTakesOnePoseForAllOrOneForEach) {
    Crowd crowd = create(settings), wanted = create(settings);
    const size_t joints = character.rig.joint_count();
    std::vector<Trs<float>> poses(2 * joints);
    Random random(32);
    for (Trs<float>& joint : poses) joint.translation = random.vector(1).as<float>();
    const std::span<const Trs<float>> first(poses.data(), joints), second(poses.data() + joints, joints);
    const std::vector<InstanceHandle> two{{2}, {0}};
    const auto expect_same_after = [&](Result<void> set) {
        ASSERT_TRUE(set) << refusal(set);
        expect_same(crowd, wanted, {{0}, {1}, {2}});
        EXPECT_NE(*crowd.read_skin_matrices({0}), *crowd.read_skin_matrices({1}));
    };
    ASSERT_TRUE(wanted.set_pose(two[0], first) && wanted.set_pose(two[1], second));
    expect_same_after(crowd.set_pose(two, poses));
    ASSERT_TRUE(wanted.set_pose(two[0], second) && wanted.set_pose(two[1], second));
    expect_same_after(crowd.set_pose(two, second));

    // The capacity is two. A third pose is refused, and the whole call with it.
    EXPECT_EQ(crowd.set_pose(Instances::numbered(0, 3), first).error().code, ErrorCode::kLimit);
    EXPECT_EQ(refusal(crowd.set_pose(two, std::span(poses).first(joints + 1))).find("pose of instance 0"), 0u);
    expect_same(crowd, wanted, {{0}, {1}, {2}});
    ASSERT_TRUE(crowd.clear_pose(two) && wanted.clear_pose(two[0]) && wanted.clear_pose(two[1]));
    expect_same(crowd, wanted, {{0}, {1}, {2}});
    // Neither a refused call nor an instance named twice uses up capacity.
    EXPECT_EQ(crowd.set_pose(Instances::numbered(0, 3), first).error().code, ErrorCode::kLimit);
    const std::vector<InstanceHandle> twice{{1}, {2}, {1}};
    ASSERT_TRUE(crowd.set_pose(twice, first)) << "two instances";
    ASSERT_TRUE(wanted.set_pose(twice[0], first) && wanted.set_pose(twice[1], first));
    expect_same(crowd, wanted, {{0}, {1}, {2}});
}

// Spawned instances: slot 13 has been used twice, 12 is despawned.
TEST_F(CrowdCalls, AHandleThatIsStaleSetsNothing) {
    Crowd crowd = create(settings), untouched = create(settings);
    std::vector<InstanceHandle> handles;
    for (Crowd* one : {&crowd, &untouched}) {
        handles = *one->spawn(4, std::array{Affine{}, Affine{}, Affine{}});
        ASSERT_EQ(handles.front().instance, 12u);
        ASSERT_TRUE(one->despawn(std::span(handles).first(2)));
        const std::vector<InstanceHandle> respawned = *one->spawn(4, std::array{Affine{}, Affine{}});
        ASSERT_TRUE(one->despawn(std::span(respawned).first(1)));
        handles = {respawned[1], handles[0], handles[2]};
    }
    ASSERT_EQ(handles[0], (InstanceHandle{13, 1}));
    const Playback playback{.first = {.clip = 0, .time_s = 0.4}};
    EXPECT_EQ(refusal(crowd.set_playback(handles, playback)), not_alive_message("playback"));
    EXPECT_EQ(refusal(crowd.set_placement(handles, placed_at(1, 2, 3))), not_alive_message("placement"));
    EXPECT_EQ(refusal(crowd.set_pose(handles, character.rig.rest)), not_alive_message("pose"));
    EXPECT_EQ(refusal(crowd.clear_pose(handles)), not_alive_message("pose"));
    EXPECT_EQ(refusal(crowd.play(handles, 0, LayerPlayback())), not_alive_message("play"));
    EXPECT_EQ(refusal(crowd.set_layer(handles, 0, LayerBlend())), not_alive_message("layer"));
    EXPECT_EQ(refusal(crowd.set_parameter(handles, 0, 1)), not_alive_message("parameter"));
    EXPECT_EQ(refusal(crowd.set_target(handles, 0, TargetPlace())), not_alive_message("target"));
    EXPECT_EQ(refusal(crowd.set_destination(handles, Vec3<float>())), not_alive_message("destination"));
    EXPECT_EQ(refusal(crowd.clear_destination(handles)), not_alive_message("destination"));
    EXPECT_EQ(refusal(crowd.watch(handles)), not_alive_message("watch"));
    EXPECT_EQ(refusal(crowd.read_skin_matrices(handles[1])), not_alive_message("read-back"));
    EXPECT_EQ(refusal(crowd.read_positions(handles[1])), not_alive_message("read-back"));
    EXPECT_EQ(refusal(crowd.set_playback(InstanceHandle{13}, playback)),
              "playback: instance 13 of generation 0 is not alive")
        << "another has its number now";
    EXPECT_EQ(refusal(crowd.set_playback(InstanceHandle{0, 1}, playback)),
              "playback: instance 0 of generation 1 is not alive");
    EXPECT_EQ(refusal(crowd.set_playback(InstanceHandle{}, playback)),
              "playback: the handle is empty: use one from Crowd::spawn() or handle()");
    EXPECT_EQ(refusal(crowd.read_skin_matrices(InstanceHandle())),
              "read-back: the handle is empty: use one from Crowd::spawn() or handle()");
    EXPECT_EQ(refusal(crowd.despawn(InstanceHandle())),
              "despawn: the handle is empty: use one from Crowd::spawn() or handle()");
    EXPECT_EQ(refusal(crowd.handle(99)),
              "handle: instance 99 is out of range: this crowd's instance numbers are below 16");
    expect_same(crowd, untouched, {handles[0], handles[2], {0}});
    EXPECT_TRUE(crowd.set_playback(handles[0], playback) && crowd.set_playback(Instances::numbered(13), playback));
}

TEST_F(CrowdCalls, ValuesThatAreTooFewOrWrongSetNothing) {
    Crowd crowd = create(settings), untouched = create(settings);
    const Instances three = Instances::numbered(0, 3);
    const Playback good{.first = {.clip = 0}}, bad{.first = {.clip = 99}};
    EXPECT_EQ(refusal(crowd.set_playback(three, std::array{good, good})), "playback: 2 values for 3 instances");
    EXPECT_EQ(refusal(crowd.set_placement(three, std::vector<Affine>(1))), "placement: 1 values for 3 instances");
    EXPECT_EQ(refusal(crowd.set_parameter(*crowd.instances(1), 0, std::vector<float>(4))),
              "parameter: 4 values for 3 instances");
    EXPECT_EQ(refusal(crowd.set_playback(three, std::array{good, good, bad})).find("playback of instance 2"), 0u);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(refusal(crowd.set_parameter(*crowd.instances(1), 0, std::array{1.0f, 2.0f, nan})),
              "parameter of instance 5: the value must be finite");
    EXPECT_EQ(refusal(crowd.set_parameter(Instances::numbered(3, 4), 0, 1)),
              "parameter of instance 6: creature has no controller");
    EXPECT_EQ(refusal(crowd.set_destination(*crowd.instances(3), std::vector<Vec3<float>>{{}, {}, {nan, 0, 0}})),
              "destination of instance 11: a number is not finite");
    EXPECT_EQ(
        refusal(crowd.set_target(Instances::numbered(6, 4), 0, TargetPlace{{1, 2, 3}, 1})).find("target of instance 9"),
        0u);
    EXPECT_EQ(refusal(crowd.instances(5)), "crowd: group 5 is out of range: this crowd's group numbers are below 5");
    std::vector<InstanceHandle> all;
    for (uint32_t i = 0; i < 12; ++i) all.push_back({i});
    expect_same(crowd, untouched, all);
    EXPECT_EQ(crowd.instances().size(), 16u);
    EXPECT_EQ(crowd.instances(4)->number(0), 12u);
    EXPECT_TRUE(crowd.set_playback(std::vector<InstanceHandle>(), good)) << "of nobody";
}

// What an application changes in a Character cannot make a kernel read outside its buffers.
TEST(EditedCharacter, InvalidEditsAreRefusedByName) {
    const Character character = creature(20, 6);
    const std::pair<const char*, std::function<void(Character&)>> edits[]{
        {"parents[5]", [](Character& c) { c.rig.parents[5] = 19; }},
        {"rig", [](Character& c) { c.rig.rest.pop_back(); }},
        {"times[", [](Character& c) { c.clips[0].row_count += 100; }},
        {"palette[3]", [](Character& c) { c.palette[3].joint = 20; }},
        {"indices", [](Character& c) { c.indices[7] = 1u << 30; }},
        {"influences", [](Character& c) { c.influences.resize(2); }},
        {"sections[0]", [](Character& c) { c.sections[0].material = 99; }},
        {"vertices", [](Character& c) { c.vertices[0].position.x = std::nanf(""); }},
        {"lod", [](Character& c) { c.lod_ranges.clear(); }},
        {"joint lods", [](Character& c) { c.joint_lods.resize(3); }}};
    for (const auto& [place, edit] : edits) {
        Character edited = character;
        edit(edited);
        const auto refused = Crowd::create(test_device(), {.groups = {{&edited, 2}}});
        ASSERT_FALSE(refused) << place;
        EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(refused.error().text().find(place), std::string::npos) << refused.error().text();
    }
}

}  // namespace
}  // namespace throng::test
