// Groups that compute only their sockets: these match any other group's, and there are no other outputs.
#include "tests/kernel_runner.h"
#include "tests/lively_crowd.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <array>

namespace throng::test {
namespace {

const InSubset kSocketsOnlyNatively({Subset::kNative}, {"SocketsOnly.*", "-SocketsOnly.DeviceUpdatesAreRefused"});

// Each of the two is this close to the exact pose. They differ in bits, since clips have other rows for fewer joints.
constexpr double kAlike = 2 * kPoseBound;

constexpr std::array kWatchedSockets{3u, 25u, 59u};  // instances, one from each group

std::vector<Affine> sockets_of(const Crowd& crowd, size_t group) {
    const OutputBlock& block = crowd.outputs()[group];
    EXPECT_EQ(block.socket_count, 3u);
    return output<Affine>(block, &OutputBlock::socket, block.instance_count * uint64_t{block.socket_count});
}

class SocketsOnly : public testing::Test {
protected:
    void SetUp() override {
        if (!test_gpu()->processor) GTEST_SKIP() << "the processor computes nothing for it";
    }
    // Two clips with poses from outside; a controller with inertial transitions; root motion. In both spaces.
    CrowdSettings settings(bool sockets_only) const {
        const std::vector<uint32_t> joints{character_.rig.joint_count() - 1, 0, 7};
        const auto group = [&](const Character& character, const Controller* controller, SocketSpace space) {
            return CrowdGroup{.character = &character,
                              .instance_count = 20,
                              .controller = controller,
                              .sockets = joints,
                              .socket_space = space,
                              .sockets_only = sockets_only};
        };
        CrowdSettings made{.groups = {group(character_, nullptr, SocketSpace::kWorld),
                                      group(character_, &dragon_, SocketSpace::kModel),
                                      group(walking_, &walker_, SocketSpace::kWorld)},
                           .keep_model_matrices = true,
                           .skins_once = true,
                           .pose_request_capacity = 1};
        made.groups[0].pose_capacity = 2;
        return made;
    }
    // Settings with only one group of 2 instances.
    CrowdSettings of_one() const {
        CrowdSettings made{.groups = {settings(true).groups[0]}, .pose_request_capacity = 1};
        made.groups[0].instance_count = 2;
        return made;
    }
    void set(Crowd& crowd, uint32_t update) const {
        Random random(update);
        const auto done = [](const Result<void>& result) { EXPECT_TRUE(result) << refusal(result); };
        if (update == 0) {
            std::vector<Affine> places;
            for (uint32_t i = 0; i < crowd.instance_count(); ++i)
                places.push_back(to_affine(random.trs(9, 0)).as<float>());
            done(crowd.set_placement(crowd.instances(), places));
            std::vector<InstanceHandle> watched;
            for (const uint32_t instance : kWatchedSockets) watched.push_back({instance});
            done(crowd.watch(watched));
        }
        done(crowd.set_playback(Instances::numbered(update, 9), random_playbacks(random, character_, 9)));
        if (update == 1) done(crowd.set_pose(InstanceHandle{3}, character_.rig.rest, 0.2f));
        for (uint32_t instance = 20; instance < 60; ++instance) {
            const auto [parameter, value] = random_change(random, instance < 40 ? dragon_ : walker_);
            if (random.chance(0.3)) done(crowd.set_parameter(InstanceHandle{instance}, parameter, value));
        }
    }

    const Character character_ = creature(30, 10), walking_ = walking_creature();
    const Controller dragon_ = example("dragon"), walker_ = example("walker");
};

TEST_F(SocketsOnly, EqualTheSocketsOfFullGroups) {
    Crowd whole = create(settings(false)), only = create(settings(true));
    for (uint32_t group = 0; group < 3; ++group) EXPECT_TRUE(whole.path(group)->is_native);
    for (uint32_t update = 0; update < 5; ++update) {
        SCOPED_TRACE(update);
        for (Crowd* const crowd : {&whole, &only}) {
            set(*crowd, update);
            ASSERT_TRUE(crowd->update(0.1f));
        }
        const Feedback feedback = feedback_of(only);
        for (uint32_t group = 0; group < 3; ++group) {
            const std::vector<Affine> sockets = sockets_of(only, group), wanted = sockets_of(whole, group);
            const double size = group < 2 ? character_.size : walking_.size;
            double worst = 0;
            for (size_t i = 0; i < sockets.size(); ++i)
                worst = std::max(worst, matrix_error(sockets[i], wanted.at(i).as<double>(), size));
            EXPECT_LE(worst, kAlike) << "group " << group;
            const auto told = sockets.begin() + 3 * (kWatchedSockets[group] - 20 * group);
            EXPECT_EQ(copy_of(feedback.watched.at(group).sockets), std::vector(told, told + 3));
        }
    }
    // A world-space socket against the same joint of the whole pose.
    const Affine world_from_model = output<Affine>(whole.outputs()[0], &OutputBlock::placement, 4)[3],
                 joint = whole.read_model_matrices({3})->at(7), socket = sockets_of(only, 0)[3 * 3 + 2];
    EXPECT_LE(matrix_error(socket, world_from_model.as<double>() * joint.as<double>(), character_.size), kAlike);
}

TEST_F(SocketsOnly, HaveNoOtherOutputs) {
    Crowd whole = create(settings(false)), only = create(settings(true));
    for (Crowd* const crowd : {&whole, &only}) ASSERT_TRUE(crowd->update(0.1f));
    const OutputBlock& block = only.outputs()[0];
    EXPECT_EQ(block.palette_count, 0u);
    EXPECT_TRUE(!has_output(block, &OutputBlock::model) && has_output(whole.outputs()[0], &OutputBlock::model));
    EXPECT_TRUE(!block.skinned && block.host.skinned.empty());
    EXPECT_LT(only.size_bytes(), whole.size_bytes());
    const std::string& name = character_.name;
    const std::string no_read = "read-back: " + name + " has CrowdGroup::sockets_only";
    EXPECT_EQ(refusal(only.read_skin_matrices({0})), no_read);
    EXPECT_EQ(refusal(only.read_model_matrices({0})), no_read);
    EXPECT_EQ(refusal(only.read_positions({0})), no_read);
    EXPECT_TRUE(whole.request_poses(InstanceHandle{0}));
    EXPECT_EQ(refusal(only.request_poses(InstanceHandle{0})),
              "pose request: " + name + " has CrowdGroup::sockets_only");
    Renderer renderer = Renderer::create(test_device(), {.width = 16, .height = 16}).value();
    EXPECT_EQ(refusal(renderer.render(only, {.eye = {0, 1, 9}})),
              "render: " + name + " has CrowdGroup::sockets_only and cannot be drawn");
}

TEST_F(SocketsOnly, UnsupportedSettingsAreRefused) {
    const std::string place = character_.name + ": sockets only: ",
                      not_alone = place +
                                  "only a native update in one pass can compute sockets alone, but this one is ";
    const auto expect_refused = [](const CrowdSettings& of, ErrorCode code, const std::string& begin) {
        const Result<Crowd> refused = Crowd::create(test_device(), of);
        ASSERT_FALSE(refused) << begin;
        EXPECT_EQ(refused.error().code, code);
        EXPECT_TRUE(refused.error().text().starts_with(begin)) << refused.error().text();
    };
    CrowdSettings without = of_one();
    without.groups[0].sockets.clear();
    expect_refused(without, ErrorCode::kInvalidArgument, place + "CrowdGroup::sockets is empty");
    const ProceduralRules rules{.rules = {SpringRule{.joint = character_.rig.names[1]}}};
    CrowdSettings with_rules = of_one(), staged = of_one();
    with_rules.groups[0].procedural = &rules;
    expect_refused(with_rules, ErrorCode::kUnsupported, not_alone);
    staged.path = UpdatePath::kStaged;
    expect_refused(staged, ErrorCode::kUnsupported, not_alone);
}

// Also if another group is the one that cannot be updated natively.
TEST_F(SocketsOnly, DeviceUpdatesAreRefused) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "there is nothing but the processor";
    const std::string place = character_.name + ": sockets only: ";
    CrowdSettings of = of_one();
    of.culling.emplace();
    Crowd crowd = create(of), same = create(of);
    CrowdSettings on_device = of;
    on_device.path = UpdatePath::kDevice;
    const Result<Crowd> refused = Crowd::create(test_device(), on_device);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
    EXPECT_TRUE(refused.error().text().starts_with(place + "only a native update")) << refused.error().text();
    on_device.groups[0].sockets_only = false;
    Crowd host = create(on_device);
    EXPECT_EQ(refusal(host.add_groups(create(of))),
              "add groups: " + character_.name +
                  " has CrowdGroup::sockets_only, which needs native updates, and this crowd's are not native");

    const std::string natively_alone = place + "they are computed only natively: by update(), and without occlusion";
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), Playback{.first = {.clip = 0}}));
    ASSERT_TRUE(same.set_playback(same.instances(), Playback{.first = {.clip = 0}}));
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) {
        const Result<void> recorded = crowd.record(commands, 0.1f);
        ASSERT_FALSE(recorded);
        EXPECT_EQ(recorded.error().code, ErrorCode::kUnsupported);
        EXPECT_EQ(recorded.error().text(), natively_alone);
    });
    CrowdView view = view_of_box({}, 100);
    view.occlusion = true;
    EXPECT_EQ(refusal(crowd.update(0.1f, &view)), natively_alone);
    for (Crowd* const one : {&crowd, &same}) ASSERT_TRUE(one->update(0.1f));
    EXPECT_TRUE(same_bits(sockets_of(crowd, 0), sockets_of(same, 0))) << "what was refused has changed nothing";
}

}  // namespace
}  // namespace throng::test
