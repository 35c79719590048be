// Crowds whose instances have controllers, against the reference of one character: poses, events, sockets, commands.
#include "tests/crowd_cases.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace throng::test {
namespace {

const InSubset kCrowdControllerInSubsets(
    {Subset::kGpuAssisted},
    {"CrowdController.*", "-CrowdController.SocketsAreTheJointsInModelOrWorldSpace",
     "-CrowdController.InertialPlaysFollowTheReference", "-CrowdController.FeedbackReportsWhatLayersPlay",
     "-CrowdController.ThousandsOfCommandsAreAppliedInTheirOrder", "-CrowdController.WrongCallsAreRefused"});
const InSubset kCrowdControllerWithOtherSubgroups({Subset::kSubgroups, Subset::kWideSubgroups},
                                                  {"CrowdController.PosesFollowTheReferenceFused"}),
    kCrowdControllerOnOtherDrivers({Subset::kOtherDriver}, {"-CrowdController.FeedbackCounts*"});
const InSubset kCrowdControllerNatively({Subset::kNative}, {"CrowdController.*"});

double largest_matrix_error(std::span<const Affine> matrices, std::span<const AffineT<double>> wanted, double size) {
    EXPECT_EQ(matrices.size(), wanted.size());
    double worst = 0;
    for (size_t i = 0; i < std::min(matrices.size(), wanted.size()); ++i)
        worst = std::max(worst, matrix_error(matrices[i], wanted[i], size));
    return worst;
}

// Random parameters over many updates. Compares the poses of all instances at the end, and the events of every update.
void follow_the_reference(UpdatePath path, const char* name, double error) {
    constexpr uint32_t kInstances = 40, kUpdates = 60;
    const Character character = creature(60, 15, error);
    const Controller controller = example(name);
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = kInstances, .controller = &controller}},
         .path = path,
         .keep_model_matrices = true});
    EXPECT_EQ(crowd.path(0)->is_fused, path == UpdatePath::kFused);
    std::vector<ReferenceCharacter> wanted = references(character, controller, kInstances);
    ASSERT_TRUE(crowd.watch(crowd.instances()));
    std::ptrdiff_t fading = 0;
    Random random(11);
    for (uint32_t update = 1; update <= kUpdates; ++update) {
        for (uint32_t i = 0; i < kInstances; ++i) {
            const auto [parameter, value] = random_change(random, controller);
            ASSERT_TRUE(crowd.set_parameter(InstanceHandle{i}, parameter, value));
            ASSERT_TRUE(wanted[i].set_parameter(parameter, value));
        }
        const auto step_s = static_cast<float>(random.between(0, 0.1));
        ASSERT_TRUE(crowd.update(step_s));
        const Result<std::vector<Feedback>> feedback = crowd.feedback();
        ASSERT_TRUE(feedback && feedback->size() == 1);
        EXPECT_EQ((*feedback)[0].update, update);
        std::map<std::pair<uint32_t, uint32_t>, int> seen;
        for (const CharacterEvent& event : (*feedback)[0].events) ++seen[{event.instance.instance, event.event}];
        for (uint32_t i = 0; i < kInstances; ++i) {
            ASSERT_TRUE(wanted[i].update(step_s));
            for (const CharacterEvent& event : wanted[i].events()) --seen[{i, event.event}];
            const WatchedInstance& watched = (*feedback)[0].watched[i];
            EXPECT_EQ(copy_of(watched.layers), wanted[i].layers()) << "instance " << i << ", update " << update;
            EXPECT_TRUE(std::ranges::equal(watched.parameters, wanted[i].parameters()))
                << "instance " << i << ", update " << update;
            fading += std::ranges::count_if(watched.layers, [](const auto& layer) { return layer.size() > 1; });
        }
        for (const auto& [key, count] : seen)
            EXPECT_EQ(count, 0) << "instance " << key.first << ", event " << key.second << ", update " << update;
    }
    EXPECT_GT(fading, 0);
    for (uint32_t i = 0; i < kInstances; ++i) {
        const ReferencePose pose = wanted[i].pose();
        EXPECT_LE(largest_matrix_error(*crowd.read_model_matrices({i}), pose.model_from_joint, character.size), 1e-4)
            << "instance " << i;
        EXPECT_LE(largest_matrix_error(*crowd.read_skin_matrices({i}), pose.model_from_bind, character.size), 1e-4)
            << "instance " << i;
    }
}

TEST(CrowdController, PosesFollowTheReferenceFused) {
    for (const char* name : {"walker", "flyer", "dragon", "guard"})
        follow_the_reference(UpdatePath::kFused, name, 1e-4);
    follow_the_reference(UpdatePath::kFused, "dragon", 0);
}

TEST(CrowdController, PosesFollowTheReferenceStaged) {
    for (const char* name : {"walker", "dragon"}) follow_the_reference(UpdatePath::kStaged, name, 1e-4);
    follow_the_reference(UpdatePath::kStaged, "dragon", 0);
}

// More commands than one round applies, for instances in any order. The last command of a kind wins.
TEST(CrowdController, ThousandsOfCommandsAreAppliedInTheirOrder) {
    const Character character = creature(20);
    const Controller controller = direct_layers(2, {{.name = "tail", .items = {{.joint = character.rig.names[1]}}}});
    constexpr uint32_t kInstances = 3000;
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = 10},
                    {.character = &character, .instance_count = kInstances, .controller = &controller}},
         .keep_model_matrices = true});
    std::vector<ReferenceCharacter> wanted = references(character, controller, kInstances);
    Random random(5);
    for (int round = 0; round < 5; ++round) {
        for (int k = 0; k < 9000; ++k) {
            const uint32_t i = random.below(kInstances), layer = random.below(2);
            const LayerPlayback playback{.clip = {.clip = random.below(4) == 0 ? kNone : random.below(3),
                                                  .time_s = random.between(-1, 3),
                                                  .speed = static_cast<float>(random.between(-2, 2)),
                                                  .loop = random.chance(0.5)},
                                         .fade_s = random.chance(0.3) ? 0 : static_cast<float>(random.between(0, 0.5))};
            const LayerBlend blend{.weight = static_cast<float>(random.unit()),
                                   .fade_s = playback.fade_s,
                                   .mode = random.chance(0.5) ? LayerMode::kAdditive : LayerMode::kOverride,
                                   .mask = random.chance(0.5) ? 0 : kNone};
            ASSERT_TRUE(crowd.play(InstanceHandle{10 + i}, layer, playback));
            ASSERT_TRUE(wanted[i].play(layer, playback));
            ASSERT_TRUE(crowd.set_layer(InstanceHandle{10 + i}, layer, blend));
            ASSERT_TRUE(wanted[i].set_layer(layer, blend));
        }
        ASSERT_TRUE(crowd.update(0.07f));
        for (ReferenceCharacter& one : wanted) ASSERT_TRUE(one.update(0.07f));
    }
    for (uint32_t i = 0; i < kInstances; i += 37)
        EXPECT_LE(largest_matrix_error(*crowd.read_model_matrices({10 + i}), wanted[i].pose().model_from_joint,
                                       character.size),
                  1e-4)
            << "instance " << i;
}

// Two layers; plays begin before the previous transition has died away, some with a cross-fade between.
TEST(CrowdController, InertialPlaysFollowTheReference) {
    const Character character = creature(40);
    const Controller controller = direct_layers(2, {}, true);
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        constexpr uint32_t kInstances = 20;
        Crowd crowd = create(
            {.groups = {{.character = &character, .instance_count = kInstances, .controller = &controller}},
             .path = path,
             .keep_model_matrices = true});
        std::vector<ReferenceCharacter> wanted = references(character, controller, kInstances);
        Random random(8);
        for (int update = 0; update < 40; ++update) {
            for (uint32_t i = 0; i < kInstances; ++i) {
                if (update > 0 && !random.chance(0.1)) continue;
                const LayerPlayback playback{.clip = {.clip = random.below(3), .time_s = random.between(0, 2)},
                                             .fade_s = static_cast<float>(random.between(0.1, 0.5)),
                                             .fade = random.chance(0.8) ? FadeKind::kInertial : FadeKind::kCross};
                const uint32_t layer = random.below(2);
                ASSERT_TRUE(crowd.play(InstanceHandle{i}, layer, playback) && wanted[i].play(layer, playback));
            }
            ASSERT_TRUE(crowd.update(0.03f));
            for (uint32_t i = 0; i < kInstances; ++i) {
                ASSERT_TRUE(wanted[i].update(0.03f));
                const ReferencePose pose = wanted[i].pose();
                EXPECT_LE(largest_matrix_error(*crowd.read_model_matrices({i}), pose.model_from_joint, character.size),
                          1e-4)
                    << "instance " << i << ", update " << update;
            }
        }
    }
}

TEST(CrowdController, AnInertialPlayStartsFromTheCurrentPose) {
    const Character character = creature(40);
    const Controller controller = direct_layers(1, {}, true);
    const auto jump = [&](FadeKind fade, float fade_s) {
        ReferenceCharacter one = std::move(*ReferenceCharacter::create(character, controller));
        EXPECT_TRUE(one.play(0, {.clip = {.clip = 0}}) && one.update(0.1f) && one.update(0.1f));
        const std::vector<AffineT<double>> before = one.pose().model_from_joint;
        EXPECT_TRUE(one.play(0, {.clip = {.clip = 2, .time_s = 0.5}, .fade_s = fade_s, .fade = fade}) &&
                    one.update(0.0001f));
        const std::vector<AffineT<double>> after = one.pose().model_from_joint;
        double furthest = 0;
        for (size_t joint = 0; joint < before.size(); ++joint)
            for (size_t row = 0; row < 3; ++row)
                furthest = worse_of(furthest,
                                    std::abs(after[joint].row[row][3] - before[joint].row[row][3]) / character.size);
        return furthest;
    };
    EXPECT_LT(jump(FadeKind::kInertial, 0.4f), 0.01);
    EXPECT_GT(jump(FadeKind::kCross, 0), 0.05);
}

TEST(CrowdController, SocketsAreTheJointsInModelOrWorldSpace) {
    const Character character = creature();
    const Controller controller = example("walker");
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged})
        for (const SocketSpace space : {SocketSpace::kModel, SocketSpace::kWorld}) {
            const std::vector<uint32_t> joints{3, 0, character.rig.joint_count() - 1};
            Crowd crowd = create(
                {.groups = {{.character = &character, .instance_count = 5},
                            {.character = &character,
                             .instance_count = 70,
                             .controller = &controller,
                             .sockets = joints,
                             .socket_space = space},
                            {.character = &character, .instance_count = 3, .sockets = {1}, .socket_space = space}},
                 .path = path,
                 .keep_model_matrices = true});
            Affine place;
            place.row[0] = {0, 0, 2, 10};
            place.row[2] = {-2, 0, 0, 20};
            place.row[1] = {0, 2, 0, 30};
            ASSERT_TRUE(crowd.set_placement(InstanceHandle{40}, place));
            ASSERT_TRUE(crowd.set_placement(InstanceHandle{77}, place));
            const std::vector<uint32_t> watched{77, 40, 5};
            ASSERT_TRUE(crowd.watch(std::array{InstanceHandle{77}, InstanceHandle{40}, InstanceHandle{5}}));
            ASSERT_TRUE(crowd.update(0.3f));
            const std::vector<Feedback> feedback = *crowd.feedback();
            ASSERT_EQ(feedback.size(), 1u);
            ASSERT_EQ(feedback[0].watched.size(), 3u);
            for (size_t k = 0; k < 3; ++k) {
                const WatchedInstance& instance = feedback[0].watched[k];
                ASSERT_EQ(instance.instance, InstanceHandle{watched[k]});
                EXPECT_EQ(instance.world_from_model, watched[k] == 5 ? Affine{} : place);
                EXPECT_EQ(instance.move, Affine{});
                const std::vector<uint32_t> of = watched[k] == 77 ? std::vector<uint32_t>{1} : joints;
                ASSERT_EQ(instance.sockets.size(), of.size());
                const std::vector<Affine> model = *crowd.read_model_matrices({watched[k]});
                for (size_t s = 0; s < of.size(); ++s) {
                    const Affine wanted = space == SocketSpace::kWorld && watched[k] != 5 ? place * model[of[s]]
                                                                                          : model[of[s]];
                    for (size_t row = 0; row < 3; ++row)
                        for (size_t column = 0; column < 4; ++column)
                            EXPECT_NEAR(instance.sockets[s].row[row][column], wanted.row[row][column], 1e-4);
                }
            }
        }
}

TEST(CrowdController, FeedbackCountsLostEventsAndKeepsFourUpdates) {
    const Character character = creature(20);
    const Controller controller = example("guard");
    constexpr uint32_t kInstances = 50;
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = kInstances, .controller = &controller}},
         .event_capacity = 7});
    for (uint32_t i = 0; i < kInstances; ++i)
        ASSERT_TRUE(crowd.set_parameter(InstanceHandle{i}, controller.find_parameter("speed"), 1.0f));
    for (int update = 0; update < 6; ++update) ASSERT_TRUE(crowd.update(0.5f));
    const std::vector<Feedback> feedback = *crowd.feedback();
    ASSERT_EQ(feedback.size(), 4u);
    uint64_t kept = 0, lost = 0;
    for (const Feedback& one : feedback) {
        EXPECT_LE(one.events.size(), 7u);
        kept += one.events.size();
        lost += one.lost_event_count;
    }
    EXPECT_GT(lost, 0u);
    EXPECT_EQ((kept + lost) % kInstances, 0u);
    EXPECT_EQ(feedback.front().update, 3u);
    EXPECT_TRUE(crowd.feedback()->empty());
}

TEST(CrowdController, FeedbackReportsWhatLayersPlay) {
    const Character character = creature(20);
    const Controller guard = example("guard"), direct = direct_layers(2);
    ASSERT_EQ(guard.layers[0].states[1].name, "move");
    // The first group has no controller, so that offsets in buffers differ from instance numbers.
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2},
                                     {.character = &character, .instance_count = 2, .controller = &guard},
                                     {.character = &character, .instance_count = 2, .controller = &direct}}});
    ASSERT_TRUE(crowd.set_parameter(InstanceHandle{3}, guard.find_parameter("speed"), 2.0f));
    ASSERT_TRUE(crowd.play(InstanceHandle{5}, 0,
                           {.clip = {.clip = 2, .time_s = character.clips[2].duration_s / 4, .speed = 0}}));
    ASSERT_TRUE(crowd.play(InstanceHandle{5}, 1, {.clip = {.clip = 0}}));
    ASSERT_TRUE(crowd.watch(std::array{InstanceHandle{0}, InstanceHandle{3}, InstanceHandle{5}}));
    ASSERT_TRUE(crowd.update(0));
    ASSERT_TRUE(crowd.play(InstanceHandle{5}, 1, {.clip = {.clip = kNone}, .fade_s = 4}));
    ASSERT_TRUE(crowd.update(0));
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<Feedback> feedback = *crowd.feedback();
    ASSERT_EQ(feedback.size(), 3u);
    const std::vector<WatchedInstance>& watched = feedback.back().watched;
    EXPECT_TRUE(watched[0].layers.empty());
    EXPECT_TRUE(watched[0].parameters.empty());
    EXPECT_EQ(copy_of(watched[1].parameters), (std::vector{2.0f, 0.0f}));
    ASSERT_EQ(watched[1].layers.size(), 1u);
    ASSERT_EQ(watched[1].layers[0].size(), 2u);
    EXPECT_EQ(watched[1].layers[0][0].motion, 1u) << "move";
    EXPECT_NEAR(watched[1].layers[0][0].fade, 0.1 / 0.3, 1e-6);
    EXPECT_EQ(watched[1].layers[0][1].motion, 0u) << "idle";
    EXPECT_EQ(watched[1].layers[0][1].fade, 1) << "nothing is behind it";
    ASSERT_EQ(watched[2].layers.size(), 2u);
    EXPECT_EQ(copy_of(watched[2].layers[0]),
              std::vector{(PlayedMotion{.motion = 2, .phase = 0.25f, .loops = 0, .fade = 1, .speed = 0})});
    ASSERT_EQ(watched[2].layers[1].size(), 2u);
    EXPECT_EQ(watched[2].layers[1][0].motion, kNone) << "the rest pose";
    EXPECT_NEAR(watched[2].layers[1][0].fade, 0.1 / 4, 1e-6);
    EXPECT_EQ(watched[2].layers[1][1].motion, 0u);
    // Of four plays the oldest is dropped. The next one has not faded in, but nothing lies behind it.
    for (const uint32_t clip : {1u, 2u}) {
        ASSERT_TRUE(crowd.play(InstanceHandle{5}, 1, {.clip = {.clip = clip}, .fade_s = 4}));
        ASSERT_TRUE(crowd.update(0.1f));
    }
    const std::vector<PlayedMotion> three = copy_of(crowd.feedback()->back().watched[2].layers[1]);
    ASSERT_EQ(three.size(), 3u);
    EXPECT_EQ(three[0].motion, 2u);
    EXPECT_EQ(three[1].motion, 1u);
    EXPECT_EQ(three[2].motion, kNone);
    EXPECT_EQ(three[2].fade, 1);
}

// One instance is set to the state that feedback reports of another, also when the command waits in a saved state.
TEST(CrowdController, AStateReportedByFeedbackCanBeSetOnAnotherInstance) {
    const Character character = creature(20);
    const Controller guard = example("guard");
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2, .controller = &guard}}});
    const InstanceHandle follower{1};
    ASSERT_TRUE(crowd.watch(crowd.instances()));
    ASSERT_TRUE(crowd.set_parameter(crowd.instances(), guard.find_parameter("speed"), 2.0f));
    ASSERT_TRUE(crowd.update(0) && crowd.update(0.7f));
    ASSERT_TRUE(crowd.set_parameter(follower, guard.find_parameter("speed"), 0.0f) && crowd.update(1));
    const auto played = [&] { return copy_of(crowd.feedback()->back().watched[1].layers[0]); };  // by the follower
    const Feedback told = std::move(crowd.feedback()->back());
    const PlayedMotion of_leader = told.watched[0].layers[0][0], of_follower = told.watched[1].layers[0][0];
    ASSERT_NE(of_leader.motion, of_follower.motion);
    ASSERT_TRUE(crowd.set_parameter(follower, guard.find_parameter("speed"), 2.0f));
    ASSERT_TRUE(crowd.set_state(follower, 0, of_leader));
    const std::vector<std::byte> saved = *crowd.save_state();
    for (int again = 0; again < 2; ++again) {
        ASSERT_TRUE(crowd.update(0));
        const std::vector<PlayedMotion> shown = played();
        ASSERT_EQ(shown.size(), 1u);
        EXPECT_EQ(shown[0], of_leader);
        ASSERT_TRUE(crowd.update(0.1f));
        ASSERT_TRUE(crowd.restore_state(saved));
    }
    ASSERT_TRUE(crowd.set_state(follower, 0, of_follower, 2) && crowd.update(0.5f));
    EXPECT_NEAR(played()[0].fade, 0.25, 1e-6);
}

TEST(CrowdController, WrongCallsAreRefused) {
    const Character character = creature(20);
    const Controller controller = example("guard"), direct = direct_layers(1);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1},
                                     {.character = &character, .instance_count = 1, .controller = &controller},
                                     {.character = &character, .instance_count = 1, .controller = &direct}}});
    const Playback playback;
    EXPECT_NE(refusal(crowd.set_playback(InstanceHandle{1}, playback)).find("controller"), std::string::npos);
    EXPECT_NE(refusal(crowd.play(InstanceHandle{0}, 0, LayerPlayback())).find("no controller"), std::string::npos);
    EXPECT_NE(refusal(crowd.play(InstanceHandle{1}, 0, LayerPlayback())).find("has states"), std::string::npos);
    EXPECT_NE(refusal(crowd.play(InstanceHandle{2}, 1, LayerPlayback()))
                  .find("layer 1 is out of range: the controller has 1"),
              std::string::npos);
    EXPECT_NE(refusal(crowd.play(InstanceHandle{2}, 0, {.clip = {.clip = 9}})).find("clip 9"), std::string::npos);
    EXPECT_NE(refusal(crowd.play(InstanceHandle{2}, 0, {.clip = {.clip = 0}, .fade_s = -1})).find("fade"),
              std::string::npos);
    EXPECT_NE(refusal(crowd.play(InstanceHandle{2}, 0,
                                 {.clip = {.clip = 0, .speed = std::numeric_limits<float>::infinity()}}))
                  .find("finite"),
              std::string::npos);
    const auto refused_state = [&](uint32_t instance, uint32_t layer, const PlayedMotion& motion, float fade_s = 0) {
        return refusal(crowd.set_state(InstanceHandle{instance}, layer, motion, fade_s));
    };
    EXPECT_NE(refused_state(2, 0, {.motion = 0}).find("has no states: call play()"), std::string::npos);
    EXPECT_NE(refused_state(1, 0, {.motion = 9}).find("state 9 is out of range: the layer has "), std::string::npos);
    EXPECT_NE(refused_state(1, 0, {.motion = 0, .phase = 1.5f}).find("phase"), std::string::npos);
    EXPECT_NE(refused_state(1, 0, {.motion = 0}, -1).find("fade"), std::string::npos);
    EXPECT_NE(refusal(crowd.set_layer(InstanceHandle{2}, 0, {.weight = 2})).find("weight"), std::string::npos);
    EXPECT_NE(refusal(crowd.set_layer(InstanceHandle{2}, 0, {.mask = 0})).find("mask 0"), std::string::npos);
    EXPECT_NE(
        refusal(crowd.set_parameter(InstanceHandle{1}, 2, 0)).find("parameter 2 is out of range: the controller has 2"),
        std::string::npos);
    EXPECT_NE(
        refusal(crowd.set_parameter(InstanceHandle{1}, 0, std::numeric_limits<float>::quiet_NaN())).find("finite"),
        std::string::npos);
    const std::string out_of_range = "instance 3 is out of range: this crowd's instance numbers are below 3";
    EXPECT_NE(refusal(crowd.play(InstanceHandle{3}, 0, LayerPlayback())).find(out_of_range), std::string::npos);
    EXPECT_NE(refusal(crowd.play(InstanceHandle{2}, 0, {.clip = {.clip = 0}, .fade_s = 1, .fade = FadeKind::kInertial}))
                  .find("inertial"),
              std::string::npos);
    EXPECT_NE(refusal(crowd.watch(InstanceHandle{3})).find(out_of_range), std::string::npos);
    EXPECT_NE(refusal(crowd.watch(std::vector<InstanceHandle>(65, {0}))).find("watch_capacity is 64"),
              std::string::npos);
    Crowd plain = create({.groups = {{.character = &character, .instance_count = 1}}});
    EXPECT_NE(refusal(plain.watch(InstanceHandle{0})).find("no group has a controller"), std::string::npos);
    EXPECT_NE(refusal(Crowd::create(test_device(),
                                    {.groups = {{.character = &character, .instance_count = 1, .sockets = {2, 2}}}}))
                  .find("twice"),
              std::string::npos);
    EXPECT_NE(refusal(Crowd::create(test_device(),
                                    {.groups = {{.character = &character, .instance_count = 1, .sockets = {99}}}}))
                  .find("joint 99"),
              std::string::npos);
    ASSERT_TRUE(crowd.update(0.1f));
}

}  // namespace
}  // namespace throng::test
