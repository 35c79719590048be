// Updates that animate only some of the drawn instances: which ones, and how the skin matrices of others are
// interpolated meanwhile.
#include "bind/skin_format.h"
#include "crowd/crowd_state.h"
#include "crowd/cull_stage.h"
#include "crowd/stage_timer.h"
#include "cull/cull_reference.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"
#include "update_rate/update_rate_reference.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <cstdio>

namespace throng::test {
namespace {

const InSubset kUpdateRateUnderValidation({Subset::kGpuAssisted}, {"UpdateRate.AFinerLevelIsAnimatedAtOnce"});
const InSubset kUpdateRateInSubsets({Subset::kNative}, {"UpdateRate.*", "-UpdateRate.TakeNewestReturnsEachUpdateOnce"});

constexpr uint32_t kUpdateRateWidth = 160, kUpdateRateHeight = 120;

// In rows behind each other, all in view.
std::vector<Affine> rows_of(uint32_t count, double size) {
    std::vector<Affine> places;
    for (uint32_t i = 0; i < count; ++i)
        places.push_back(
            to_affine(Trs<double>{.translation = {(i % 5 - 2.0) * 0.1 * size, 0, -size * (2 + i * 0.9)}}).as<float>());
    return places;
}

CrowdView view_along(float full_rate_pixels) {
    CrowdView view = *view_of({.eye = {0, 0, 0}, .target = {0, 0, -1}, .vertical_field_of_view_rad = 1.5f},
                              kUpdateRateWidth, kUpdateRateHeight, {});
    view.lod_pixels = 1e-20f;
    view.full_rate_pixels = full_rate_pixels;
    return view;
}

// The expected number of updates per animation, or 0 if rounding decides.
uint32_t expected_period(const CrowdView& view, const Affine& place, const Group& group) {
    const CullBox box{((group.posed_min + group.posed_max) * 0.5f).as<double>(),
                      ((group.posed_max - group.posed_min) * 0.5f).as<double>()};
    const AffineT<double> world_from_model = place.as<double>();
    const Vec3<double> eye = view.eye.as<double>();
    const double distance = length(transform_point(world_from_model, box.centre) - eye) - length(box.half_extent);
    if (distance <= 0) return 1;
    const double size_pixels = 2 * length(box.half_extent) / distance * double{view.pixels};
    const uint32_t low = period_reference(size_pixels * 0.9999, view.full_rate_pixels),
                   high = period_reference(size_pixels * 1.0001, view.full_rate_pixels);
    return low == high ? low : 0;
}

std::vector<Affine> previous_of(Crowd& crowd, uint32_t instance) {
    const OutputBlock& block = crowd.outputs()[0];
    const uint64_t size_bytes = uint64_t{block.palette_count} * sizeof(Affine);
    return download<Affine>(test_gpu(),
                            output_range(block, &OutputBlock::previous_skin, instance * size_bytes, size_bytes));
}

uint32_t animated_in_last_update(Crowd& crowd) {
    const std::vector<uint32_t> work = download<uint32_t>(test_gpu(), crowd.state().batches[0][io::kWorkBuffer]);
    uint32_t count = 0;
    for (uint32_t section = 0; section < io::kInterpolated; ++section) count += work[2 * section + 1];
    return count;
}

// Against a crowd that is fully animated in every update, and the reference's interpolation between its poses.
void expect_interpolated(const CrowdGroup& group, SkinFormat format, bool keeps_previous, double bound) {
    constexpr uint32_t kCount = 40, kUpdates = 26;
    CrowdGroup copied = group;
    copied.instance_count = kCount;
    const CrowdSettings settings{.groups = {copied},
                                 .path = UpdatePath::kFused,
                                 .skin_format = format,
                                 .keep_previous_matrices = keeps_previous,
                                 .culling = Culling{.skips_updates = true}};
    Crowd skipping = create(settings),
          whole = create({.groups = {copied}, .path = UpdatePath::kFused, .skin_format = format});
    const Group& of = skipping.state().groups[0];
    const std::vector<Affine> places = rows_of(kCount, length(of.posed_max - of.posed_min));
    Random random(4);
    const std::vector<Playback> playbacks = random_playbacks(random, *group.character, kCount);
    for (Crowd* crowd : {&skipping, &whole})
        ASSERT_TRUE(crowd->set_placement(crowd->instances(), places) &&
                    (group.controller || crowd->set_playback(crowd->instances(), playbacks)));
    const CrowdView near = view_along(40),
                    away = *view_of({.eye = {0, 0, 10}, .target = {0, 0, 90}}, kUpdateRateWidth, kUpdateRateHeight, {});
    struct Way {
        std::vector<Affine> shown, target;
        uint32_t left = 0;
        bool was_drawn = false;
    };
    std::vector<Way> ways(kCount);
    std::array<uint32_t, 9> of_period{};
    uint32_t between = 0;
    for (uint32_t update = 0; update < kUpdates; ++update) {
        const bool looks_away = update == 11 || update == 12;
        std::vector<std::vector<Affine>> before;
        for (uint32_t i = 0; i < kCount && keeps_previous && update > 0; ++i)
            before.push_back(*skipping.read_skin_matrices({i}));
        const Result<void> updated = skipping.update(0.02f, looks_away ? &away : &near);
        ASSERT_TRUE(updated) << updated.error().text();
        ASSERT_TRUE(whole.update(0.02f));
        EXPECT_EQ(drawn_of(skipping).size(), looks_away ? 0u : kCount);
        for (uint32_t i = 0; i < kCount; ++i) {
            SCOPED_TRACE("instance " + std::to_string(i) + ", update " + std::to_string(update));
            Way& way = ways[i];
            const bool was_drawn = way.was_drawn;
            way.was_drawn = !looks_away;
            if (looks_away) continue;
            const uint32_t period = expected_period(near, places[i], of);
            if (period == 0) continue;
            ++of_period[period];
            const std::vector<Affine> got = *skipping.read_skin_matrices({i}),
                                      animated = *whole.read_skin_matrices({i});
            if (!was_drawn || period == 1) {
                EXPECT_TRUE(same_bits(got, animated)) << "at once";
                way.shown = animated;
                way.left = 0;
            } else {
                if ((update + i) % period == 0) {
                    way.target = animated;
                    way.left = period;
                }
                for (size_t entry = 0; entry < got.size() && way.left > 0; ++entry) {
                    const AffineT<double> wanted = update_rate_reference(way.shown[entry].as<double>(),
                                                                         way.target[entry].as<double>(), way.left);
                    for (size_t row = 0; row < 3; ++row)
                        for (size_t column = 0; column < 4; ++column)
                            ASSERT_NEAR(got[entry].row[row][column], wanted.row[row][column],
                                        bound * group.character->size);
                }
                EXPECT_TRUE(way.left != 0 || same_bits(got, way.shown)) << "waits";
                // The bound above also holds for instances that reach their target.
                EXPECT_TRUE(way.left != 1 || !rounds_like_the_cpu() || same_bits(got, way.target)) << "arrives";
                between += way.left > 1;
                if (way.left > 0) --way.left;
                way.shown = got;
            }
            EXPECT_TRUE(!keeps_previous || same_bits(previous_of(skipping, i), was_drawn ? before[i] : got))
                << "previous";
        }
    }
    for (const uint32_t period : {1u, 2u, 4u, 8u}) EXPECT_GE(of_period[period], 20u) << "of period " << period;
    EXPECT_GT(between, 100u);
}

TEST(UpdateRate, MatricesAreInterpolatedToTheNextPose) {
    const Character character = small_character();
    const Controller direct = direct_layers(2);
    expect_interpolated({.character = &character}, SkinFormat::kAffine, false, 1e-5);
    expect_interpolated({.character = &character}, SkinFormat::kAffine, true, 1e-5);
    expect_interpolated({.character = &character, .controller = &direct}, SkinFormat::kAffine, false, 1e-5);
    expect_interpolated({.character = &character}, SkinFormat::kHalfAffine, false, 1e-2);
}

TEST(UpdateRate, SimilaritiesTurnOnTheShortestPath) {
    const Character character = creature(24, 8);
    ASSERT_TRUE(character.rig.uniform_scale);
    expect_interpolated({.character = &character}, SkinFormat::kSimilarity, false, 0.05);
}

TEST(UpdateRate, TheCostIsSpreadEvenly) {
    constexpr uint32_t kCount = 4000;
    const Character character = small_character();
    Crowd crowd = create(
        {.groups = {{&character, kCount}}, .path = UpdatePath::kFused, .culling = Culling{.skips_updates = true}});
    ASSERT_TRUE(crowd.set_placement(
        crowd.instances(),
        std::vector<Affine>(kCount,
                            to_affine(Trs<double>{.translation = {0, 0, -1000.0 * character.size}}).as<float>())));
    const CrowdView view = view_along(10);
    ASSERT_TRUE(crowd.update(0.01f, &view));
    EXPECT_EQ(animated_in_last_update(crowd), kCount) << "what appears is animated at once";
    for (int update = 0; update < 9; ++update) {
        ASSERT_TRUE(crowd.update(0.01f, &view));
        EXPECT_EQ(animated_in_last_update(crowd), kCount / 8);
    }
    ASSERT_TRUE(crowd.update(0.01f));
    EXPECT_EQ(animated_in_last_update(crowd), kCount) << "without a view";
}

// Every update exceeds a tiny budget, and none exceeds an infinite one.
TEST(UpdateRate, AnExceededBudgetLowersTheRate) {
    constexpr uint32_t kCount = 640;
    const Character character = small_character();
    Crowd crowd = create(
        {.groups = {{&character, kCount}}, .path = UpdatePath::kFused, .culling = Culling{.skips_updates = true}});
    ASSERT_TRUE(crowd.set_placement(
        crowd.instances(),
        std::vector<Affine>(kCount,
                            to_affine(Trs<double>{.translation = {0, 0, -20.0 * character.size}}).as<float>())));
    CrowdView view = view_along(0);
    const auto updated = [&](float budget_ms) {
        view.budget_ms = budget_ms;
        EXPECT_TRUE(crowd.update(0.01f, &view));
        return animated_in_last_update(crowd);
    };
    EXPECT_EQ(updated(1e9f), kCount);
    EXPECT_EQ(updated(1e9f), kCount);
    for (int update = 0; update < 20; ++update) updated(1e-6f);
    EXPECT_EQ(updated(1e-6f), kCount / 8);
    for (int update = 0; update < 160; ++update) updated(1e9f);
    EXPECT_EQ(updated(1e9f), kCount);
    EXPECT_EQ(updated(0), kCount) << "no budget";
}

TEST(UpdateRate, CoarserLevelsHaveFewerJoints) {
    const Character character = *compile_character(
        *make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500}), {.error = 0});
    ASSERT_GE(character.lods.size(), 2u);
    constexpr uint32_t kCount = 48;
    Crowd reduced = create({.groups = {{&character, kCount}},
                            .path = UpdatePath::kFused,
                            .culling = Culling{.reduces_joints = true}}),
          whole = create({.groups = {{&character, kCount}}, .path = UpdatePath::kFused});
    Random random(8);
    const std::vector<Playback> playbacks = random_playbacks(random, character, kCount);
    const std::vector<Affine> places = rows_of(kCount, 3.0 * character.size);
    for (Crowd* crowd : {&reduced, &whole})
        ASSERT_TRUE(crowd->set_placement(crowd->instances(), places) &&
                    crowd->set_playback(crowd->instances(), playbacks));
    CrowdView view = view_along(0);
    // A set of joints has its own kernel. A native device stores 16-bit rows, whose precision depends on what the
    // joints move
    const double bound = test_gpu()->is_native() ? kPoseBound : 2e-6;
    const std::vector<FusedJoints>& sets = reduced.state().groups[0].fused;
    ASSERT_EQ(sets.size(), 1 + character.lods.size());
    std::array<uint32_t, 4> compared{};
    for (const float lod_pixels : {0.02f, 0.2f}) {  // the finest and the coarsest level
        view.lod_pixels = lod_pixels;
        ASSERT_TRUE(reduced.update(0.1f, &view) && whole.update(0.1f));
        std::array<uint32_t, 4> drawn{};
        for (const DrawnInstance& one : drawn_of(reduced)) {
            ++drawn[one.lod];
            const std::vector<Affine> got = *reduced.read_skin_matrices({one.instance}),
                                      wanted = *whole.read_skin_matrices({one.instance});
            for (size_t entry = 0; entry < got.size(); ++entry) {
                if (one.lod > 0 && character.joint_lods[character.palette[entry].joint] < one.lod) continue;
                ++compared[one.lod];
                for (size_t row = 0; row < 3; ++row)
                    for (size_t column = 0; column < 4; ++column)
                        ASSERT_NEAR(got[entry].row[row][column], wanted[entry].row[row][column], bound * character.size)
                            << "instance " << one.instance << ", entry " << entry;
            }
        }
        const std::vector<uint32_t> work = download<uint32_t>(test_gpu(), reduced.state().batches[0][io::kWorkBuffer]);
        for (size_t lod = 0; lod < sets.size(); ++lod)
            EXPECT_EQ(work[2 * lod + 1], drawn[lod]) << "animated with no more joints than level " << lod << " has";
    }
    for (size_t lod = 0; lod < sets.size(); ++lod) {
        EXPECT_GT(compared[lod], 0u) << "level " << lod;
        std::printf("  level %zu: %u joints\n", lod, sets[lod].joint_count);
        EXPECT_TRUE(lod == 0 || sets[lod].joint_count <= sets[lod - 1].joint_count);
    }
    EXPECT_LT(sets.back().joint_count, character.rig.joint_count() / 2);
    Crowd overridden = create({.groups = {{.character = &character, .instance_count = 1, .pose_capacity = 1}},
                               .path = UpdatePath::kFused,
                               .culling = Culling{.reduces_joints = true}});
    EXPECT_EQ(overridden.state().groups[0].fused.size(), 1u) << "poses from outside may move any joint";
}

// Joints that only the finer level has were not animated before: they are animated at once, and their previous matrices
// equal the current ones.
TEST(UpdateRate, AFinerLevelIsAnimatedAtOnce) {
    const Character character = *compile_character(
        *make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500}), {.error = 0});
    constexpr uint32_t kCount = 8;
    Crowd crowd = create({.groups = {{&character, kCount}},
                          .path = UpdatePath::kFused,
                          .keep_previous_matrices = true,
                          .culling = Culling{.skips_updates = true, .reduces_joints = true}});
    Crowd whole = create({.groups = {{&character, kCount}}, .path = UpdatePath::kFused});
    Random random(12);
    const std::vector<Playback> playbacks = random_playbacks(random, character, kCount);
    const std::vector<Affine> places(kCount,
                                     to_affine(Trs<double>{.translation = {0, 0, -20.0 * character.size}}).as<float>());
    for (Crowd* one : {&crowd, &whole})
        ASSERT_TRUE(one->set_placement(one->instances(), places) && one->set_playback(one->instances(), playbacks));
    CrowdView view = view_along(1e6f);  // animated in every eighth update
    for (const float lod_pixels : {1e6f, 1e6f, 1e6f, 1e-20f}) {
        view.lod_pixels = lod_pixels;
        ASSERT_TRUE(crowd.update(0.05f, &view) && whole.update(0.05f));
        for (const DrawnInstance& one : drawn_of(crowd)) EXPECT_EQ(one.lod == 0, lod_pixels < 1);
    }
    for (uint32_t i = 0; i < kCount; ++i) {
        EXPECT_TRUE(same_bits(*crowd.read_skin_matrices({i}), *whole.read_skin_matrices({i}))) << "instance " << i;
        EXPECT_TRUE(same_bits(previous_of(crowd, i), *crowd.read_skin_matrices({i}))) << "instance " << i;
    }
    ASSERT_TRUE(crowd.update(0.05f, &view));
    EXPECT_LT(animated_in_last_update(crowd), kCount) << "then it waits again";
}

// At coarser levels, the matrices of the level's joints are interpolated and reach their target, wherever they are in
// the palette.
TEST(UpdateRate, CoarserLevelsAreInterpolatedToo) {
    const Character character = *compile_character(
        *make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500}), {.error = 0});
    constexpr uint32_t kCount = 8;
    for (const bool keeps_previous : {false, true}) {
        Crowd crowd = create({.groups = {{&character, kCount}},
                              .path = UpdatePath::kFused,
                              .keep_previous_matrices = keeps_previous,
                              .culling = Culling{.skips_updates = true, .reduces_joints = true}});
        Crowd whole = create({.groups = {{&character, kCount}}, .path = UpdatePath::kFused});
        Random random(13);
        const std::vector<Affine> places(
            kCount, to_affine(Trs<double>{.translation = {0, 0, -20.0 * character.size}}).as<float>());
        for (Crowd* one : {&crowd, &whole}) ASSERT_TRUE(one->set_placement(one->instances(), places));
        CrowdView view = view_along(1e6f);  // animated in every eighth update
        view.lod_pixels = 1e6f;
        // Sets a pose that shows at once, then interpolates to another one.
        for (const uint32_t updates : {1u, 17u}) {
            const std::vector<Playback> playbacks = random_playbacks(random, character, kCount);
            for (Crowd* one : {&crowd, &whole}) ASSERT_TRUE(one->set_playback(one->instances(), playbacks));
            for (uint32_t update = 0; update < updates; ++update) ASSERT_TRUE(crowd.update(0, &view));
            ASSERT_TRUE(whole.update(0));
            uint32_t compared = 0, left_out = 0;
            for (const DrawnInstance& one : drawn_of(crowd)) {
                ASSERT_EQ(one.lod, character.lods.size());
                const std::vector<Affine> got = *crowd.read_skin_matrices({one.instance}),
                                          wanted = *whole.read_skin_matrices({one.instance}),
                                          before = keeps_previous ? previous_of(crowd, one.instance) : got;
                for (size_t entry = 0; entry < got.size(); ++entry) {
                    if (character.joint_lods[character.palette[entry].joint] < one.lod) {
                        ++left_out;
                        continue;
                    }
                    ++compared;
                    for (size_t row = 0; row < 3; ++row)
                        for (size_t column = 0; column < 4; ++column) {
                            ASSERT_NEAR(got[entry].row[row][column], wanted[entry].row[row][column],
                                        2e-6 * character.size)
                                << "instance " << one.instance << ", entry " << entry;
                            ASSERT_NEAR(before[entry].row[row][column], wanted[entry].row[row][column],
                                        2e-6 * character.size)
                                << "instance " << one.instance << ", entry " << entry << " before";
                        }
                }
            }
            EXPECT_GT(compared, 0u);
            EXPECT_GT(left_out, 0u);
        }
    }
}

// While updates are pending, the reported times are those of the newest finished one, and each is reported once.
TEST(UpdateRate, TakeNewestReturnsEachUpdateOnce) {
    if (!test_gpu()->has_timestamps()) GTEST_SKIP() << "the queue has no timestamps";
    StageTimer timer(test_gpu(), 2);
    EXPECT_FALSE(timer.take_newest());
    const auto record = [&](VkCommandBuffer commands, const char* stage) {
        timer.begin(commands);
        timer.end_stage(commands, stage);
        timer.publish(commands);
    };
    test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
        record(commands, "cull");
        EXPECT_FALSE(timer.take_newest()) << "recorded, not run";
    });
    const std::optional<StageTimes> first = timer.take_newest();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->total(), first->of("cull"));
    EXPECT_FALSE(timer.take_newest()) << "taken";
    EXPECT_EQ(timer.read().of("cull"), first->of("cull")) << "but still there";
    test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
        for (int i = 0; i < 6; ++i) {
            record(commands, "scan");
            EXPECT_FALSE(timer.take_newest()) << "an older one's times are not the newest's";
            EXPECT_EQ(i < 3 ? timer.read().of("cull") : first->of("cull"), first->of("cull"));
        }
    });
    const std::optional<StageTimes> later = timer.take_newest();
    ASSERT_TRUE(later);
    EXPECT_EQ(later->total(), later->of("scan"));
}

}  // namespace
}  // namespace throng::test
