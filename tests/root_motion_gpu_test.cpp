// Instances move by the root motion of their clips, as the reference says.
#include "control/controller_reference.h"
#include "control/layer_commands.h"
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/walker.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

const test::InSubset kRootMotionClipInSubsets({test::Subset::kNative}, {"RootMotionOnTheGpu.*"});

using namespace test;

// A crowd of walkers with a layer to play clips on, and the reference's result for each.
class Walking {
public:
    Walking(const Character& character, uint32_t count, bool moves_placements, UpdatePath path = UpdatePath::kAuto,
            Controller controller = direct_layers(1))
        : controller_(std::move(controller)),
          crowd_(create({.groups = {{.character = &character,
                                     .instance_count = count,
                                     .controller = &controller_,
                                     .moves_placements = moves_placements}},
                         .path = path})),
          references_(count, ControllerReference(controller_, character)),
          moves_placements_(moves_placements),
          base_(count),
          place_(count),
          moved_m_(count) {
        for (const Clip& clip : character.clips) durations_s_.push_back(clip.duration_s);
        EXPECT_TRUE(crowd_.watch(InstanceHandle{count - 1}));
    }

    void play(uint32_t instance, const LayerPlayback& playback) {
        const Result<void> played = crowd_.play(InstanceHandle{instance}, 0, playback);
        ASSERT_TRUE(played) << played.error().text();
        references_[instance].apply(play_command(std::vector<LayerKind>(1), durations_s_, 0, playback, "reference"));
    }

    void stand(uint32_t instance, const Affine& world_from_model) {
        ASSERT_TRUE(crowd_.set_placement(InstanceHandle{instance}, world_from_model));
        base_[instance] = world_from_model;
        place_[instance] = {};
        moved_m_[instance] = 0;
    }

    void step(float time_step_s) {
        ASSERT_TRUE(crowd_.update(time_step_s));
        const OutputBlock& block = crowd_.outputs()[0];
        const uint64_t count = references_.size();
        const std::vector<Affine> placements = output<Affine>(block, &OutputBlock::placement, count,
                                                              crowd_.state().gpu);
        ASSERT_EQ(crowd_.state().batches[0][io::kRootsBuffer].size_bytes(), count * sizeof(io::RootState));
        const std::vector<io::RootState> roots = output<io::RootState>(block, &OutputBlock::root, count,
                                                                       crowd_.state().gpu);
        const std::vector<Feedback> feedback = *crowd_.feedback();
        ASSERT_TRUE(feedback.size() == 1 && feedback[0].watched.size() == 1);
        const WatchedInstance& watched = feedback[0].watched[0];
        EXPECT_EQ(watched.world_from_model, placements.back());
        const io::vec4& told = roots.back().move;
        EXPECT_EQ(watched.move.row, (std::array<std::array<float, 4>, 3>{
                                        {{told.z, 0, told.w, told.x}, {0, 1, 0, 0}, {-told.w, 0, told.z, told.y}}}));
        for (uint32_t i = 0; i < count; ++i) {
            const GroundMove move = references_[i].update(time_step_s).move;
            place_[i] = turned_to_length_one(place_[i] * move);
            moved_m_[i] += std::hypot(move.x, move.z);
            const double bound = 1e-4 * moved_m_[i] + 1e-6;
            EXPECT_NEAR(roots[i].move.x, move.x, 1e-5 * (1 + std::hypot(move.x, move.z)));
            EXPECT_NEAR(roots[i].move.y, move.z, 1e-5 * (1 + std::hypot(move.x, move.z)));
            EXPECT_NEAR(roots[i].move.z, move.cos, 1e-5);
            EXPECT_NEAR(roots[i].move.w, move.sin, 1e-5);
            const AffineT<double> wanted = moves_placements_ ? base_[i].as<double>() * affine_of(place_[i])
                                                             : base_[i].as<double>();
            for (size_t row = 0; row < 3; ++row)
                for (size_t column = 0; column < 4; ++column) {
                    const double tolerance = moves_placements_ ? 2 * (column == 3 ? bound : 1e-4) : 0;
                    EXPECT_NEAR(placements[i].row[row][column], wanted.row[row][column], tolerance)
                        << "instance " << i << ": " << row << ", " << column;
                }
        }
    }

    // Odd time steps, some over several cycles and some backwards.
    void steps(uint32_t count, uint64_t seed) {
        Random random(seed);
        for (uint32_t i = 0; i < count && !::testing::Test::HasFailure(); ++i)
            step(static_cast<float>(random.below(20) == 0 ? random.between(-1, 7) : random.between(0, 0.05)));
    }

    double distance_m(uint32_t instance) const { return moved_m_[instance]; }

private:
    static AffineT<double> affine_of(const GroundMove& move) {
        AffineT<double> out;
        out.row = {{{move.cos, 0, move.sin, move.x}, {0, 1, 0, 0}, {-move.sin, 0, move.cos, move.z}}};
        return out;
    }

    Controller controller_;
    Crowd crowd_;
    std::vector<ControllerReference> references_;
    std::vector<float> durations_s_;
    bool moves_placements_;
    std::vector<Affine> base_;
    std::vector<GroundMove> place_;
    std::vector<double> moved_m_;
};

Character walkers(double error) {
    Walker walker(true);
    walker.move("walk", times(2, 30), walk);
    walker.move("stroll", times(1.5, 24), [](double time_s) {
        return ModelPose{axis_angle(kUp, -0.3 * time_s), {0, 0.9, 0.8 * time_s}};
    });
    walker.move("idle", times(1, 30), [](double) { return ModelPose{{}, {0, 0.9, 0}}; });
    return compiled(walker.asset, {.error = error, .root_motion_joint = "hips"});
}

const Affine kSomewhere =
    to_affine(Trs<double>{axis_angle(normalized(Vec3<double>{0.1, 1, 0.2}), 1.1), {5, 1, -3}, {2, 2, 2}}).as<float>();

TEST(RootMotionOnTheGpu, PlacementsFollowTheClips) {
    for (const double error : {0.0, 1e-4})
        for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged}) {
            const Character character = walkers(error);
            Walking walking(character, 2, true, path);
            walking.play(0, {.clip = {.clip = 0}});
            walking.play(1, {.clip = {.clip = 1, .time_s = 0.7}});
            walking.stand(1, kSomewhere);
            walking.steps(200, 1);
            EXPECT_GT(walking.distance_m(0), 10);
        }
}

TEST(RootMotionOnTheGpu, AStateWithoutClipsDoesNotMove) {
    const Character character = walkers(0);
    Controller controller{.name = "stop and go"};
    controller.layers = {{.name = "body",
                          .states = {{.name = "stand"}, {.name = "stroll", .points = {{"stroll"}}}},
                          .transitions = {{.from = "stand", .to = "stroll", .fade_s = 0.5f},
                                          {.from = "stroll", .to = "stand", .exit = 0.5f, .fade_s = 0.5f}}}};
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged}) {
        Walking walking(character, 2, true, path, controller);
        walking.stand(1, kSomewhere);
        walking.steps(200, 9);
        EXPECT_GT(walking.distance_m(0), 2);
    }
}

// Each step is rounded to the float precision at such a distance. Those errors alone would add up to fifteen times the
// bound.
TEST(RootMotionOnTheGpu, ManyShortStepsAddUpPrecisely) {
    constexpr float kStep_s = 1 / 30.0f, kSpeed = 1.5f;
    constexpr int kSteps = 3000;
    Walker walker(true);
    walker.move("run", times(1, 30), [](double time_s) { return ModelPose{{}, {0, 0.9, double{kSpeed} * time_s}}; });
    const Character character = compiled(walker.asset, {.error = 0, .root_motion_joint = "hips"});
    const Controller controller = direct_layers(1);
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged}) {
        Crowd crowd = create(
            {.groups = {{.character = &character, .instance_count = 2, .controller = &controller}}, .path = path});
        ASSERT_TRUE(crowd.play(crowd.instances(), 0, LayerPlayback{.clip = {.clip = 0}}));
        const Affine far_away = to_affine(Trs<float>{.translation = {700, 2, -300}});
        ASSERT_TRUE(crowd.set_placement(InstanceHandle{1}, far_away));
        for (int step = 0; step < kSteps; ++step) ASSERT_TRUE(crowd.update(kStep_s));
        const std::vector<Affine> placements = output<Affine>(crowd.outputs()[0], &OutputBlock::placement, 2,
                                                              crowd.state().gpu);
        const double way = double{kSpeed} * kSteps * double{kStep_s};
        EXPECT_NEAR(placements[0].row[2][3], way, 2e-6 * way);
        EXPECT_NEAR(placements[1].row[2][3], far_away.row[2][3] + way, 2e-6 * way);
        EXPECT_NEAR(placements[1].row[0][3], far_away.row[0][3], 2e-6 * way);
    }
}

TEST(RootMotionOnTheGpu, IsOnlyReportedWithoutMovesPlacements) {
    const Character character = walkers(0);
    Walking walking(character, 2, false);
    walking.play(0, {.clip = {.clip = 0}});
    walking.stand(1, kSomewhere);
    walking.play(1, {.clip = {.clip = 1}});
    walking.steps(200, 2);
    EXPECT_GT(walking.distance_m(1), 5);
}

TEST(RootMotionOnTheGpu, MovementContinuesFromASetPlacement) {
    const Character character = walkers(0);
    Walking walking(character, 2, true);
    walking.play(0, {.clip = {.clip = 0}});
    walking.play(1, {.clip = {.clip = 0, .time_s = 1}});
    walking.steps(50, 3);
    walking.stand(0, kSomewhere);
    walking.steps(100, 4);
    walking.stand(1, kSomewhere);
    walking.steps(50, 5);
}

TEST(RootMotionOnTheGpu, FollowsBackwardAndNonLoopingClips) {
    const Character character = walkers(0);
    Walking walking(character, 2, true);
    walking.play(0, {.clip = {.clip = 0, .time_s = 0.3, .speed = -0.7f}});
    walking.play(1, {.clip = {.clip = 1, .speed = 1.3f, .loop = false}});
    walking.steps(200, 6);
    EXPECT_GT(walking.distance_m(0), 5);
    EXPECT_LT(walking.distance_m(1), 5);
}

TEST(RootMotionOnTheGpu, CrossFadingClipsBlendTheirMovement) {
    const Character character = walkers(0);
    Walking walking(character, 2, true);
    Random random(7);
    for (int round = 0; round < 10; ++round) {
        for (uint32_t i = 0; i < 2; ++i)
            walking.play(i, {.clip = {.clip = random.below(3),
                                      .time_s = random.unit(),
                                      .speed = static_cast<float>(random.between(-1, 2))},
                             .fade_s = static_cast<float>(random.between(0.1, 0.8))});
        walking.steps(20, 8 + static_cast<uint64_t>(round));
    }
}

}  // namespace
}  // namespace throng
