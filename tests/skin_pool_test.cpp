// Skin pools: skin matrices only for instances that are drawn, and poses shared by distant instances.
#include "bench/pixels_off.h"
#include "cull/cull.h"
#include "control/control_reference.h"
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <set>

namespace throng::test {
namespace {

const InSubset kSkinPoolInSubsets({Subset::kGpuAssisted}, {"SkinPool.InstancesWithoutARowShareAPose"}),
    kSkinPoolOnOtherDrivers({Subset::kOtherDriver}, {"-SkinPool.*"}),
    kSkinPoolWithOtherSubgroups({Subset::kSubgroups}, {"SkinPool.OnTheDeviceOwnPosesAreExactAndSharedOnesNear"});
const InSubset kSkinPoolNatively({Subset::kNative}, {"SkinPool.*"});

constexpr uint32_t kSkinPoolWidth = 320, kSkinPoolHeight = 240;

// Random placements in a square in front of view()'s camera.
std::vector<Affine> places(uint32_t count, double extent) {
    Random random(5);
    std::vector<Affine> all;
    for (uint32_t i = 0; i < count; ++i) {
        Trs<double> place = random.trs(1, 0.2);
        place.translation = {random.between(-extent, extent), 0, random.between(-extent, extent)};
        all.push_back(to_affine(place).as<float>());
    }
    return all;
}

CrowdView view(double extent) {
    return *view_of({.eye = {0, 3, static_cast<float>(extent)}, .target = {0, 0, 0}}, kSkinPoolWidth, kSkinPoolHeight,
                    {});
}

struct Counts {
    uint32_t own = 0, shared = 0;
};

// Each drawn instance has its own pose, with the same bits as without a pool in all joints of its level, or a shared
// pose that looks almost the same. No row is assigned twice, and rows of shared poses belong to no instance.
Counts expect_right(Crowd& pooled, Crowd& whole, const Character& character, std::span<const Playback> playbacks,
                    std::span<const Affine> placements, const CrowdView& seen, bool reduces_joints) {
    const GroupSkinPool& pool = *pooled.state().groups[0].skin_pool;
    const std::vector<DrawnInstance> drawn = drawn_of(pooled), drawn_without = drawn_of(whole);
    EXPECT_EQ(drawn.size(), drawn_without.size());
    Counts counts;
    std::set<uint32_t> own_rows;
    for (size_t i = 0; i < std::min(drawn.size(), drawn_without.size()); ++i) {
        const DrawnInstance& one = drawn[i];
        EXPECT_TRUE(one.instance == drawn_without[i].instance && one.lod == drawn_without[i].lod);
        EXPECT_EQ(one.shares_pose, one.skin_row < pool.shared_row_count);
        EXPECT_LT(one.skin_row, pooled.outputs()[0].skin_row_count);
        if (one.shares_pose) {
            ++counts.shared;
            const double pixels = bench::pixels_off(
                *pooled.read_positions({one.instance}),
                reference_positions(character, *reference_pose(character, playbacks[one.instance])),
                placements[one.instance], seen);
            EXPECT_LE(pixels, seen.shared_pose_pixels * 1.01 + 0.01) << "instance " << one.instance;
            continue;
        }
        ++counts.own;
        EXPECT_TRUE(own_rows.insert(one.skin_row).second) << "two instances in a row";
        const std::vector<Affine> got = *pooled.read_skin_matrices({one.instance}),
                                  wanted = *whole.read_skin_matrices({one.instance});
        for (size_t entry = 0; entry < got.size(); ++entry) {
            if (reduces_joints && one.lod > character.joint_lods[character.palette[entry].joint]) continue;
            if (rounds_like_the_cpu())
                EXPECT_EQ(got[entry], wanted[entry]) << "instance " << one.instance << ", entry " << entry;
            else
                EXPECT_LE(matrix_error(got[entry], wanted[entry].as<double>(), character.size), kPoseBound)
                    << "instance " << one.instance << ", entry " << entry;
        }
    }
    return counts;
}

void expect_exact_or_near(UpdatePath path) {
    const Character character = creature_with_lods();
    constexpr uint32_t kCount = 300;
    constexpr double kExtent = 60;
    const std::vector<Affine> placements = places(kCount, kExtent);
    Counts all;
    for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine}) {
        for (const bool reduces : {false, true}) {
            const auto make = [&](std::optional<SkinPool> pool) {
                return create({.groups = {{.character = &character, .instance_count = kCount, .skin_pool = pool}},
                               .path = path,
                               .skin_format = format,
                               .culling = Culling{.reduces_joints = reduces}});
            };
            Crowd pooled = make(SkinPool{.capacity = kCount, .shared_poses_per_s = 60}), whole = make({});
            Random random(7);
            std::vector<Playback> playbacks = random_playbacks(random, character, kCount);
            for (Crowd* crowd : {&pooled, &whole})
                ASSERT_TRUE(crowd->set_placement(crowd->instances(), placements) &&
                            crowd->set_playback(crowd->instances(), playbacks));
            for (const float pixels : {0.0f, 0.25f, 2.0f}) {
                CrowdView seen = view(kExtent);
                seen.shared_pose_pixels = pixels;
                seen.lod_pixels = reduces ? 0.5f : 1.0f;
                for (Crowd* crowd : {&pooled, &whole}) ASSERT_TRUE(crowd->update(0.05f, &seen));
                for (Playback& playback : playbacks) playback = advanced(playback, character, 0.05);
                if (reduces) seen.shared_pose_pixels += seen.lod_pixels;  // positions use fewer joints
                const Counts counts = expect_right(pooled, whole, character, playbacks, placements, seen, reduces);
                EXPECT_GT(counts.own, 0u);
                EXPECT_TRUE(pixels < 2 || counts.shared > 20) << counts.shared;
                all.own += counts.own;
                all.shared += counts.shared;
            }
        }
    }
    std::printf("  %u own poses, %u shared\n", all.own, all.shared);
}

TEST(SkinPool, OwnPosesAreExactAndSharedOnesNear) { expect_exact_or_near(UpdatePath::kAuto); }
TEST(SkinPool, OnTheDeviceOwnPosesAreExactAndSharedOnesNear) { expect_exact_or_near(UpdatePath::kDevice); }

void expect_shared_where_full(UpdatePath path) {
    const Character character = creature_with_lods();
    constexpr uint32_t kCount = 200, kCapacity = 37;
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = kCount, .skin_pool = SkinPool{.capacity = kCapacity}}},
         .path = path,
         .culling = Culling{.reduces_joints = true}});
    const std::vector<Affine> placements = places(kCount, 30);
    std::vector<Playback> playbacks(kCount);
    for (uint32_t i = 0; i < kCount; ++i)
        playbacks[i] = {.first = {.clip = 0, .time_s = 0.01 * i}, .second = {.clip = 1}, .weight = 0.7f};
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), placements) && crowd.set_playback(crowd.instances(), playbacks));
    CrowdView seen = view(30);
    seen.shared_pose_pixels = 0;
    ASSERT_TRUE(crowd.update(0, &seen));
    const std::vector<DrawnInstance> drawn = drawn_of(crowd);
    ASSERT_GT(drawn.size(), kCapacity);
    const auto own = static_cast<uint32_t>(std::ranges::count(drawn, false, &DrawnInstance::shares_pose));
    EXPECT_EQ(own, kCapacity);
    // The finest levels get rows first and come first in lists
    EXPECT_FALSE(drawn.front().shares_pose);
    EXPECT_TRUE(drawn.back().shares_pose);
    // The others show a pose of the clip with the largest weight, near their own time
    const auto& clips = character.clips;
    for (const DrawnInstance& one : drawn) {
        if (!one.shares_pose) {
            EXPECT_LE(instance_error(crowd, one.instance, character, playbacks[one.instance]),
                      one.lod == 0 ? kPoseBound : 1);
            continue;
        }
        const double row = one.skin_row;
        const double time_s = local_time_reference(0.01 * one.instance, clips[0].duration_s, true),
                     intervals = std::ceil(double{clips[0].duration_s} * 30);
        EXPECT_NEAR(row, time_s / clips[0].duration_s * intervals, 0.51);
        const Playback shared{.first = {.clip = 0, .time_s = clips[0].duration_s * row / intervals, .loop = false}};
        const ReferencePose pose = *reference_pose(character, shared);
        const std::vector<Affine> got = *crowd.read_skin_matrices({one.instance});
        for (size_t i = 0; i < got.size(); ++i)
            EXPECT_LE(matrix_error(got[i], pose.model_from_bind[i], character.size), kPoseBound);
    }
}

TEST(SkinPool, InstancesWithoutARowShareAPose) {
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kDevice}) expect_shared_where_full(path);
}

TEST(SkinPool, ControllersShareThePoseOfTheLowestClip) {
    const Character character = creature_with_lods();
    constexpr uint32_t kCount = 90;
    Controller controller;
    controller.name = "two clips";
    controller.layers.push_back({.name = "base"});
    const auto make = [&](std::optional<SkinPool> pool) {
        return create(
            {.groups =
                 {{.character = &character, .instance_count = kCount, .controller = &controller, .skin_pool = pool}},
             .culling = Culling{}});
    };
    Crowd pooled = make(SkinPool{.capacity = kCount, .shared_poses_per_s = 60}), whole = make({});
    const std::vector<Affine> placements = places(kCount, 40);
    std::vector<Playback> playbacks;
    Random random(3);
    for (uint32_t i = 0; i < kCount; ++i) {
        const ClipPlayback clip{.clip = random.below(2), .time_s = random.unit(), .speed = 0};
        playbacks.push_back({.first = clip});
        for (Crowd* crowd : {&pooled, &whole}) ASSERT_TRUE(crowd->play(InstanceHandle{i}, 0, {.clip = clip}));
    }
    CrowdView seen = view(40);
    seen.shared_pose_pixels = 0.3f;
    for (Crowd* crowd : {&pooled, &whole})
        ASSERT_TRUE(crowd->set_placement(crowd->instances(), placements) && crowd->update(0, &seen) &&
                    crowd->update(0, &seen));
    const Counts counts = expect_right(pooled, whole, character, playbacks, placements, seen, false);
    EXPECT_GT(counts.own, 5u);
    EXPECT_GT(counts.shared, 5u);
}

TEST(SkinPool, WithoutAViewAllAreAnimated) {
    const Character character = small_character();
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = 70, .skin_pool = SkinPool{.capacity = 1000}}},
         .culling = Culling{}});
    ASSERT_TRUE(crowd.update(0.1f));
    for (const DrawnInstance& one : drawn_of(crowd)) EXPECT_FALSE(one.shares_pose) << one.instance;
    EXPECT_EQ(drawn_of(crowd).size(), 70u);
}

TEST(SkinPool, PicturesEqualThoseWithoutAPool) {
    const Character character = creature_with_lods();
    constexpr uint32_t kCount = 120;
    const std::vector<Affine> placements = places(kCount, 25);
    Random random(9);
    const std::vector<Playback> playbacks = random_playbacks(random, character, kCount);
    std::map<std::string, Picture> pictures;
    for (const auto& [name, pool, pixels] : {std::tuple{"without", std::optional<SkinPool>(), 0.0f},
                                             {"own", SkinPool{.capacity = kCount}, 0.0f},
                                             {"shared", SkinPool{.capacity = kCount}, 0.5f}}) {
        Crowd crowd = create(
            {.groups = {{.character = &character, .instance_count = kCount, .skin_pool = pool}}, .culling = Culling{}});
        ASSERT_TRUE(crowd.set_placement(crowd.instances(), placements) &&
                    crowd.set_playback(crowd.instances(), playbacks));
        Renderer renderer = *Renderer::create(test_device(), {.width = kSkinPoolWidth, .height = kSkinPoolHeight});
        const Camera camera{.eye = {0, 3, 25}, .target = {0, 0, 0}};
        CrowdView seen = *view_of(camera, kSkinPoolWidth, kSkinPoolHeight, {});
        seen.shared_pose_pixels = pixels;
        ASSERT_TRUE(crowd.update(0.1f, &seen));
        Result<RenderResult> rendered = renderer.render(crowd, camera);
        ASSERT_TRUE(rendered) << rendered.error().text();
        pictures[name] = std::move(rendered->picture);
    }
    EXPECT_LE(different_bytes(pictures["without"], pictures["own"]), rounds_like_the_cpu() ? 0u : 12u)
        << "an edge may fall to either side of a pixel where kernels round differently";
    const std::vector<uint8_t>&exact = pictures["own"].rgba, &near = pictures["shared"].rgba;
    EXPECT_NE(exact, near);
    double difference = 0;
    for (size_t i = 0; i < exact.size(); ++i) difference += std::abs(int{exact[i]} - int{near[i]});
    EXPECT_LE(difference / static_cast<double>(exact.size()), 0.5) << "of 255, on average";
}

// Two batches with one pool each, beside a group without a pool and an empty group.
TEST(SkinPool, EachBatchHasAPool) {
    const Character character = creature_with_lods();
    constexpr uint32_t kCount = 300, kCapacity = 3;
    const CrowdGroup pooled{
        .character = &character, .instance_count = kCount, .skin_pool = SkinPool{.capacity = kCapacity}};
    CrowdGroup nobody = pooled;
    nobody.instance_count = 0;
    Result<Crowd> crowd = Crowd::create(device_of_workgroups(kCapacity),
                                        {.groups = {pooled, nobody, {&character, 2}}, .culling = Culling{}});
    ASSERT_TRUE(crowd) << crowd.error().text();
    const std::vector<OutputBlock> blocks(crowd->outputs().begin(), crowd->outputs().end());
    ASSERT_EQ(blocks.size(), 3u);
    EXPECT_FALSE(blocks[2].skin_row);
    const std::vector<Affine> placements = places(kCount + 2, 20);
    std::vector<Playback> playbacks(kCount + 2);
    for (uint32_t i = 0; i < playbacks.size(); ++i) playbacks[i] = {.first = {.clip = 0, .time_s = 0.01 * i}};
    CrowdView seen = view(20);
    seen.shared_pose_pixels = 0;
    ASSERT_TRUE(crowd->set_placement(crowd->instances(), placements) &&
                crowd->set_playback(crowd->instances(), playbacks) && crowd->update(0, &seen));
    std::map<uint32_t, uint32_t> own;
    for (const DrawnInstance& one : drawn_of(*crowd)) {
        if (one.shares_pose) continue;
        ++own[one.instance < blocks[1].first_instance ? 0u : one.instance < kCount ? 1u : 2u];
        EXPECT_LE(instance_error(*crowd, one.instance, character, playbacks[one.instance]), kPoseBound);
    }
    EXPECT_EQ(own[0], kCapacity);
    EXPECT_EQ(own[1], kCapacity);
    EXPECT_GT(own[2], 0u);
}

// The kernels produce the same lists as their native versions, which are tested against the reference.
TEST(SkinPool, LargeCrowdsUseSeveralCellsPerWorkgroup) {
    const Character character = small_character();
    constexpr uint32_t kCount = 140'000;
    ASSERT_EQ(cells_of_workgroup(kCount), 3u);
    const std::vector<Affine> placements = places(kCount, 400);
    const CrowdView seen = view(400);
    std::vector<std::vector<DrawnInstance>> lists;
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kDevice}) {
        Crowd crowd = create(
            {.groups = {{.character = &character, .instance_count = kCount, .skin_pool = SkinPool{.capacity = 2000}}},
             .path = path,
             .culling = Culling{}});
        ASSERT_TRUE(crowd.set_placement(crowd.instances(), placements));
        for (int update = 0; update < 2; ++update) {  // first without cells, then with them
            ASSERT_TRUE(crowd.update(0, &seen));
            lists.push_back(drawn_of(crowd));
        }
    }
    EXPECT_GT(lists[0].size(), 1000u);
    EXPECT_LT(lists[0].size(), kCount - 1000);
    const auto key = [](const DrawnInstance& one) { return std::tuple(one.instance, one.lod, one.skin_row); };
    for (size_t i = 1; i < lists.size(); ++i) EXPECT_TRUE(std::ranges::equal(lists[0], lists[i], {}, key, key)) << i;
}

TEST(SkinPool, InstancesNotDrawnHaveNoMatrices) {
    const Character character = small_character();
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = 2, .skin_pool = SkinPool{.capacity = 1}}},
         .culling = Culling{}});
    const std::vector<Affine> placements{to_affine(Trs<double>{}).as<float>(),
                                         to_affine(Trs<double>{.translation = {0, 0, 1e4}}).as<float>()};
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), placements));
    const CrowdView seen = view(20);
    ASSERT_TRUE(crowd.update(0.1f, &seen));
    EXPECT_TRUE(crowd.read_skin_matrices({0}));
    EXPECT_TRUE(crowd.read_positions({0}));
    const Result<std::vector<Affine>> matrices = crowd.read_skin_matrices({1});
    ASSERT_FALSE(matrices);
    EXPECT_EQ(matrices.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(matrices.error().text().find("instance 1 was not drawn in the last update"), std::string::npos)
        << matrices.error().text();
    EXPECT_FALSE(crowd.read_positions({1}));
}

TEST(SkinPool, MatrixMemoryDoesNotGrowWithInstances) {
    const Character character = creature_with_lods();
    const auto bytes = [&](std::optional<SkinPool> pool, uint32_t count) {
        return create({.groups = {{.character = &character, .instance_count = count, .skin_pool = pool}},
                       .culling = Culling{}})
            .size_bytes();
    };
    const uint64_t matrices = character.palette.size() * 48;
    EXPECT_GT(bytes({}, 3000), 3000 * matrices);
    const uint64_t few = bytes(SkinPool{.capacity = 10}, 1000), many = bytes(SkinPool{.capacity = 10}, 3000);
    EXPECT_LT(many - few, 2000u * 200);  // only the state of instances
}

// At 30 poses per second the three clips and the rest pose need 2^64 + 18 poses, which overflows 64 bits to 18.
TEST(SkinPool, ClipsOfExcessiveDurationAreRefused) {
    Character character = make_character({.name = "endless", .joint_count = 4, .clip_count = 3});
    ASSERT_EQ(character.clips.size(), 3u);
    character.clips[0].duration_s = 614'891'432'473'264'128.0f;
    character.clips[1].duration_s = 36'650'385'408.0f;
    character.clips[2].duration_s = 2185;
    const Result<Crowd> crowd = Crowd::create(
        test_device(),
        {.groups = {{.character = &character, .instance_count = 1, .skin_pool = SkinPool{.capacity = 1}}},
         .culling = Culling{}});
    ASSERT_FALSE(crowd);
    EXPECT_EQ(crowd.error().code, ErrorCode::kLimit) << crowd.error().text();
}

// All joints are computed for each shared pose, although only one of them has a skin matrix.
TEST(SkinPool, PosesThatWouldTakeHoursAreRefused) {
    Asset asset{.name = "long"};
    for (uint32_t node = 0; node < 128; ++node)
        asset.nodes.push_back({.name = "joint", .parent = node == 0 ? kNone : node - 1});
    asset.skins = {{.joints = {127}, .inverse_binds = std::vector<Affine>(1)}};
    AssetPrimitive triangle{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                            .influence_count = 4,
                            .influence_joints = std::vector<uint16_t>(12),
                            .influence_weights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                            .indices = {0, 1, 2}};
    asset.meshes = {{.primitives = {triangle}}};
    asset.mesh_instances = {{.node = 0, .mesh = 0, .skin = 0}};
    const float seconds = 2500;
    asset.clips = {{.name = "clip", .duration_s = seconds}};
    for (uint32_t node = 0; node < 128; ++node)
        asset.clips[0].tracks.push_back({.node = node,
                                         .target = TrackTarget::kRotation,
                                         .times_s = {0, seconds},
                                         .values = {0, 0, 0, 1, 0, 0, 1, 0}});
    const Character character = compile_character(asset).value();
    ASSERT_EQ(character.rig.joint_count(), 128u);
    const auto refusal = [&](float poses_per_s) {
        const SkinPool pool{.capacity = 1, .shared_poses_per_s = poses_per_s};
        const Result<Crowd> crowd = Crowd::create(
            test_device(),
            {.groups = {{.character = &character, .instance_count = 1, .skin_pool = pool}}, .culling = Culling{}});
        return crowd ? std::string() : crowd.error().text();
    };
    EXPECT_NE(refusal(1000).find("poses times joints are at most"), std::string::npos) << refusal(1000);
    EXPECT_EQ(refusal(1), "");
}

TEST(SkinPool, IncompatibleSettingsAreRefused) {
    const Character character = small_character();
    const auto message = [&](CrowdGroup group, CrowdSettings settings) {
        group.character = &character;
        group.instance_count = 10;
        settings.groups = {group};
        const Result<Crowd> crowd = Crowd::create(test_device(), settings);
        return crowd ? std::string() : crowd.error().text();
    };
    const CrowdGroup pooled{.skin_pool = SkinPool{.capacity = 5}};
    EXPECT_EQ(message(pooled, {.culling = Culling{}}), "");
    EXPECT_EQ(message(pooled, {}), "") << "it turns culling on";
    CrowdGroup with_sockets = pooled, with_poses = pooled, empty = pooled, too_many = pooled;
    with_sockets.sockets = {0};
    with_poses.pose_capacity = 3;
    empty.skin_pool->capacity = 0;
    too_many.skin_pool->shared_poses_per_s = 1e6f;
    const std::vector<std::pair<std::string, std::string>> refused{
        {message(pooled, {.path = UpdatePath::kStaged, .culling = Culling{}}), "stage by stage"},
        {message(pooled, {.keep_model_matrices = true, .culling = Culling{}}), "keep_model_matrices"},
        {message(pooled, {.keep_previous_matrices = true, .culling = Culling{}}), "keep_previous_matrices"},
        {message(pooled, {.culling = Culling{.skips_updates = true}}), "skips_updates"},
        {message(pooled, {.culling = Culling{}, .skins_once = true}), "skins_once"},
        {message(with_sockets, {.culling = Culling{}}), "sockets"},
        {message(with_poses, {.culling = Culling{}}), "pose_capacity"},
        {message(empty, {.culling = Culling{}}), "above 0"},
        {message(too_many, {.culling = Culling{}}), "at most 1000"}};
    for (const auto& [text, reason] : refused) {
        EXPECT_NE(text.find("skin pool"), std::string::npos) << text;
        EXPECT_NE(text.find(reason), std::string::npos) << text;
    }
    CrowdView seen = view(10);
    seen.shared_pose_pixels = -1;
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1}}, .culling = Culling{}});
    const Result<void> updated = crowd.update(0, &seen);
    ASSERT_FALSE(updated);
    EXPECT_EQ(updated.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(updated.error().text(), "view: shared_pose_pixels must not be negative");
}

}  // namespace
}  // namespace throng::test
