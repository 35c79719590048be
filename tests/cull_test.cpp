// Updates for a view: which instances are listed at which detail, and that the picture stays the same.
#include "crowd/crowd_state.h"
#include "crowd/cull_stage.h"
#include "cull/cull_reference.h"
#include "tests/kernel_runner.h"
#include "tests/lively_crowd.h"
#include "tests/recorder.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <map>

namespace throng::test {
namespace {

const InSubset kCullInSubsets({Subset::kGpuAssisted, Subset::kSubgroups},
                              {"Cull.ListsWhatTheReferenceSees", "Cull.BatchesChangeNothing"});
const InSubset kCullOnOtherDrivers({Subset::kOtherDriver}, {"-Cull.BatchesChangeNothing"});
const InSubset kCullNatively({Subset::kNative}, {"Cull.*", "-Cull.TiledMethodsAnimateTheListToo"});

constexpr uint32_t kCullWidth = 160, kCullHeight = 120;
constexpr uint32_t kUnseen = ~0u;

// Anywhere within a square, of any size, some mirrored.
std::vector<Affine> random_places(Random& random, uint32_t count, double extent) {
    std::vector<Affine> places;
    for (uint32_t i = 0; i < count; ++i) {
        Trs<double> place = random.trs(1, 0.2);
        place.translation = {random.between(-extent, extent), random.between(-0.05, 0.05) * extent,
                             random.between(-extent, extent)};
        if (random.chance(0.2)) place.scale.x = -place.scale.x;
        places.push_back(to_affine(place).as<float>());
    }
    return places;
}

Camera random_camera(Random& random, double extent) {
    return {.eye = random.vector(extent).as<float>(),
            .target = random.vector(extent).as<float>(),
            .vertical_field_of_view_rad = static_cast<float>(random.between(0.1, 2))};
}

TEST(Cull, ListsWhatTheReferenceSees) {
    const Character character = creature_with_lods();
    ASSERT_GE(character.lods.size(), 2u);
    uint32_t compared = 0, seen_in_all = 0;
    std::map<uint32_t, uint32_t> of_lods;
    for (const uint32_t count : {1u, 63u, 64u, 65u, 1000u, 5000u}) {
        Random random(count);
        const double extent = 200;
        const std::vector<Affine> places = random_places(random, count, extent);
        Crowd crowd = create({.groups = {{&character, count}}, .culling = Culling{}});
        ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
        const Group& group = crowd.state().groups[0];
        const CullBox box{((group.posed_min + group.posed_max) * 0.5f).as<double>(),
                          ((group.posed_max - group.posed_min) * 0.5f).as<double>()};
        for (int round = 0; round < 8; ++round) {
            CrowdView view = *view_of(random_camera(random, extent), kCullWidth, kCullHeight, {});
            view.shadow = random.vector(20).as<float>();
            if (round % 3 > 0) view.ground = static_cast<float>(random.between(-0.3, 0.3) * extent);
            view.lod_pixels = static_cast<float>(random.between(0.1, 3));
            ASSERT_TRUE(crowd.update(0.01f, &view));
            const io::CullView planes = cull_view_of(&view, 0);
            const std::vector<DrawnInstance> drawn = drawn_of(crowd);
            std::vector<uint32_t> lods(count, kUnseen);
            for (size_t i = 0; i < drawn.size(); ++i) {
                ASSERT_LT(drawn[i].instance, count);
                ASSERT_EQ(lods[drawn[i].instance], kUnseen) << "listed twice";
                lods[drawn[i].instance] = drawn[i].lod;
                if (i == 0) continue;
                EXPECT_TRUE(drawn[i - 1].lod < drawn[i].lod ||
                            (drawn[i - 1].lod == drawn[i].lod && drawn[i - 1].instance < drawn[i].instance))
                    << "in order";
            }
            for (uint32_t i = 0; i < count; ++i) {
                constexpr double kRounding = 1e-4;
                const AffineT<double> place = places[i].as<double>();
                const double reach = seen_by(planes, place, box);
                if (std::abs(reach) < kRounding * extent) continue;
                ASSERT_EQ(lods[i] != kUnseen, reach > 0) << "instance " << i;
                ++compared;
                if (reach < 0) continue;
                ++seen_in_all;
                ++of_lods[lods[i]];
                ASSERT_LE(lods[i], character.lods.size());
                const auto spare_of = [&](uint32_t lod) {
                    return spare_of_lod(planes, place, box, character.lods[lod - 1].error);
                };
                ASSERT_TRUE(lods[i] == 0 || spare_of(lods[i]) >= -kRounding * extent) << "too coarse";
                ASSERT_TRUE(lods[i] == character.lods.size() || spare_of(lods[i] + 1) <= kRounding * extent)
                    << "too fine";
            }
            const auto draws = download<io::DrawCommand>(
                test_gpu(), BufferRange(crowd.state().batches[0][io::kDrawsBuffer], 0,
                                        group.sections.size() * io::kLodCount * sizeof(io::DrawCommand)));
            EXPECT_EQ(crowd.outputs()[0].draw.buffer, crowd.state().batches[0][io::kDrawsBuffer].handle());
            for (size_t k = 0; k < draws.size(); ++k) {
                const uint32_t lod = k % io::kLodCount;
                EXPECT_EQ(draws[k].instance_count, std::ranges::count(lods, lod));
                EXPECT_EQ(draws[k].index_count > 0, lod <= character.lods.size());
            }
        }
    }
    EXPECT_GT(seen_in_all, compared / 20);
    EXPECT_LT(seen_in_all, compared * 19 / 20);
    EXPECT_GE(of_lods.size(), 3u);
    std::printf("  %u instances compared, %u seen\n", compared, seen_in_all);
}

TEST(Cull, WithoutAViewAllAreListedInFullDetail) {
    const Character character = creature_with_lods();
    Crowd crowd = create({.groups = {{&character, 70}, {&character, 5}}, .culling = Culling{}});
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<DrawnInstance> drawn = drawn_of(crowd);
    ASSERT_EQ(drawn.size(), 75u);
    for (uint32_t i = 0; i < drawn.size(); ++i) EXPECT_TRUE(drawn[i].instance == i && drawn[i].lod == 0) << i;
}

double largest_difference(std::span<const Affine> a, std::span<const Affine> b) {
    double largest = 0;
    for (size_t i = 0; i < a.size(); ++i)
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 4; ++column)
                largest = std::max(largest, std::abs(double{a[i].row[row][column]} - b[i].row[row][column]));
    return largest;
}

// Visible instances have exactly the matrices that they have without a view, the others keep theirs, and time advances
// for all.
void expect_same_where_drawn(const CrowdGroup& group, UpdatePath path, bool only_drawn,
                             const std::string& scan = "auto") {
    constexpr uint32_t kCount = 130;
    CrowdGroup copied = group;
    copied.instance_count = kCount;
    const CrowdSettings settings{.groups = {copied}, .path = path, .scan = scan, .culling = Culling{}};
    Crowd viewed = create(settings), whole = create(settings);
    Random random(6);
    const std::vector<Affine> places = random_places(random, kCount, 30);
    const std::vector<Playback> playbacks = random_playbacks(random, *group.character, kCount);
    for (Crowd* crowd : {&viewed, &whole})
        ASSERT_TRUE(crowd->set_placement(crowd->instances(), places) &&
                    (group.controller || crowd->set_playback(crowd->instances(), playbacks)) && crowd->update(0.1f));
    uint32_t skipped = 0;
    for (int update = 0; update < 6; ++update) {
        const CrowdView view = *view_of(random_camera(random, 30), kCullWidth, kCullHeight, {});
        std::vector<std::vector<Affine>> before;
        for (uint32_t i = 0; i < kCount; ++i) before.push_back(*viewed.read_skin_matrices({i}));
        ASSERT_TRUE(viewed.update(0.1f, &view) && whole.update(0.1f));
        std::vector<bool> is_drawn(kCount);
        for (const DrawnInstance& one : drawn_of(viewed)) is_drawn[one.instance] = true;
        for (uint32_t i = 0; i < kCount; ++i) {
            const bool is_animated = is_drawn[i] || !only_drawn;
            skipped += !is_animated;
            const std::vector<Affine> got = *viewed.read_skin_matrices({i}),
                                      wanted = is_animated ? *whole.read_skin_matrices({i}) : before[i];
            EXPECT_TRUE(same_bits(got, wanted)) << "instance " << i << (is_animated ? ", animated" : ", kept")
                                                << ", update " << update << ": off " << largest_difference(got, wanted);
        }
    }
    EXPECT_EQ(skipped > kCount, only_drawn);
    ASSERT_TRUE(viewed.update(0.1f) && whole.update(0.1f));
    for (uint32_t i = 0; i < kCount; ++i)
        EXPECT_TRUE(same_bits(*viewed.read_skin_matrices({i}), *whole.read_skin_matrices({i})))
            << "all again, instance " << i;
}

TEST(Cull, OnlyDrawnInstancesAreAnimated) {
    const Character small = small_character(), large = creature(150, 40);
    const Controller walker = example("walker"), inertial = example("dragon"), direct = direct_layers(2);
    const auto expect_same = [](const char* what, const CrowdGroup& group, UpdatePath path, bool only_drawn) {
        SCOPED_TRACE(what);
        expect_same_where_drawn(group, path, only_drawn);
    };
    expect_same("small", {.character = &small}, UpdatePath::kFused, true);
    expect_same("large", {.character = &large}, UpdatePath::kFused, true);
    expect_same("poses from outside", {.character = &large, .pose_capacity = 3}, UpdatePath::kFused, true);
    expect_same("layers", {.character = &large, .controller = &direct}, UpdatePath::kFused, true);
    expect_same("controller", {.character = &large, .controller = &walker}, UpdatePath::kFused, true);
    expect_same("inertial", {.character = &large, .controller = &inertial}, UpdatePath::kFused, false);
    expect_same("staged", {.character = &small}, UpdatePath::kStaged, false);
    expect_same("sockets", {.character = &small, .sockets = {3}}, UpdatePath::kFused, false);
}

// These methods first load local transforms into shared memory, for one or several characters per workgroup.
TEST(Cull, TiledMethodsAnimateTheListToo) {
    const Character small = small_character();
    for (const char* scan : {"subgroup", "fragments", "compressed", "doubling"}) {
        SCOPED_TRACE(scan);
        expect_same_where_drawn({.character = &small}, UpdatePath::kFused, true, scan);
    }
}

TEST(Cull, BatchesChangeNothing) {
    const Character character = creature_with_lods();
    const CrowdSettings settings{.groups = {{&character, 10}}, .culling = Culling{}};
    Crowd whole = create(settings);
    Result<Crowd> parts = Crowd::create(device_of_workgroups(3), settings);
    ASSERT_TRUE(parts) << parts.error().text();
    EXPECT_EQ(parts->outputs().size(), 4u);
    Random random(9);
    const std::vector<Affine> places = random_places(random, 10, 20);
    const CrowdView view = *view_of({.eye = {0, 10, 40}, .target = {5, 0, 0}}, kCullWidth, kCullHeight, {});
    for (Crowd* crowd : {&whole, &*parts})
        ASSERT_TRUE(crowd->set_placement(crowd->instances(), places) && crowd->update(0, &view));
    const auto sorted = [](Crowd& crowd) {
        std::map<uint32_t, uint32_t> lods;
        for (const DrawnInstance& one : drawn_of(crowd)) lods[one.instance] = one.lod;
        return lods;
    };
    EXPECT_EQ(sorted(whole), sorted(*parts));
    EXPECT_FALSE(sorted(whole).empty());
}

// Cells are made when placements stand still, and dropped when any placement changes. A dropped update, whether
// discarded or not, leaves no cell that hides an instance.
TEST(Cull, CellsFollowPlacements) {
    const Character character = small_character();
    constexpr uint32_t kCount = 400;
    Random random(4);
    // Sorted, so that cells are slices of the field and the camera sees one end. Each call reverses the order
    bool from_left = false;
    const auto sorted_places = [&](uint32_t count) {
        std::vector<Affine> sorted = random_places(random, count, 40);
        std::ranges::sort(sorted, {},
                          [&](const Affine& place) { return from_left ? place.row[0][3] : -place.row[0][3]; });
        from_left = !from_left;
        return sorted;
    };
    std::vector<Affine> places = sorted_places(kCount);
    const CrowdView view = *view_of({.eye = {30, 10, 60}, .target = {30, 0, 0}, .vertical_field_of_view_rad = 0.3f},
                                    kCullWidth, kCullHeight, {});
    const CrowdSettings settings{.groups = {{&character, kCount}}, .culling = Culling{}};
    Crowd crowd = create(settings);
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    const auto instances_of = [](Crowd& of) {
        std::vector<uint32_t> instances;
        for (const DrawnInstance& one : drawn_of(of)) instances.push_back(one.instance);
        return instances;
    };
    const auto expect_right = [&](const char* when) {
        Crowd fresh = create(settings);  // which has no cells in its first update
        ASSERT_TRUE(fresh.set_placement(fresh.instances(), places) && fresh.update(0, &view) && crowd.update(0, &view));
        EXPECT_EQ(instances_of(crowd), instances_of(fresh)) << when;
        EXPECT_FALSE(instances_of(fresh).empty());
    };
    const auto move = [&](uint32_t first, uint32_t count) {
        const std::vector<Affine> others = sorted_places(count);
        std::ranges::copy(others, places.begin() + first);
        ASSERT_TRUE(crowd.set_placement(Instances::numbered(first, count), others));
    };
    for (int i = 0; i < 3; ++i) expect_right("at first");
    for (int i = 0; i < 3; ++i) {
        move(100 + 10 * static_cast<uint32_t>(i), 150);
        expect_right("when some move");
    }
    for (int i = 0; i < 3; ++i) expect_right("when they stand still");
    if (test_device().gpu()->is_native()) return;
    for (const bool tells : {true, false}) {
        move(0, kCount);
        expect_right("when all move");
        Recorder recorder;
        recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 0, &view)); });
        EXPECT_TRUE(!tells || crowd.discard_last_record());
        for (int i = 0; i < 3; ++i) expect_right(tells ? "after a discarded update" : "after a dropped update");
    }
}

// The mean amount by which a colour lies outside the range of colours that the other picture has there and one pixel
// around: 0 if all that differs has moved by less than a pixel.
double difference_beyond_a_pixel(const Picture& picture, const Picture& other) {
    const int width = static_cast<int>(kCullWidth), height = static_cast<int>(kCullHeight);
    uint64_t sum = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int channel = 0; channel < 4; ++channel) {
                const auto value = [&](const Picture& of, int row, int column) {
                    return int{of.rgba[static_cast<size_t>((row * width + column) * 4 + channel)]};
                };
                int low = 255, high = 0;
                for (int row = std::max(y - 1, 0); row <= std::min(y + 1, height - 1); ++row)
                    for (int column = std::max(x - 1, 0); column <= std::min(x + 1, width - 1); ++column) {
                        low = std::min(low, value(other, row, column));
                        high = std::max(high, value(other, row, column));
                    }
                const int here = value(picture, y, x);
                sum += static_cast<uint64_t>(std::max({low - here, here - high, 0}));
            }
    return static_cast<double>(sum) / static_cast<double>(picture.rgba.size());
}

// A flight over a crowd: the pictures equal those of all instances at full detail, except where a coarser mesh moves a
// surface by less than a pixel.
TEST(Cull, PicturesEqualThoseWithoutCulling) {
    constexpr uint32_t kCount = 150;
    const Character character = creature_with_lods();
    Random random(11);
    const std::vector<Playback> playbacks = random_playbacks(random, character, kCount);
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kCount; ++i)
        places.push_back(to_affine(Trs<double>{.rotation = axis_angle(Vec3<double>{0, 1, 0}, random.between(0, 6)),
                                               .translation = {random.between(-30, 30), 0, random.between(-30, 30)}})
                             .as<float>());
    Crowd viewed = create({.groups = {{&character, kCount}}, .culling = Culling{}}),
          whole = create({.groups = {{&character, kCount}}});
    for (Crowd* crowd : {&viewed, &whole})
        ASSERT_TRUE(crowd->set_placement(crowd->instances(), places) &&
                    crowd->set_playback(crowd->instances(), playbacks));
    Result<Renderer> of_viewed = Renderer::create(test_device(), {.width = kCullWidth, .height = kCullHeight}),
                     of_whole = Renderer::create(test_device(), {.width = kCullWidth, .height = kCullHeight});
    ASSERT_TRUE(of_viewed && of_whole);
    uint64_t drawn = 0;
    double worst = 0, worst_moved = 0;
    for (int frame = 0; frame < 60; ++frame) {
        const double turn = 0.2 * frame;
        const Camera camera{.eye = Vec3<double>{25 * std::sin(turn), 2 + 0.2 * frame, 25 * std::cos(turn)}.as<float>(),
                            .target = Vec3<double>{20 * std::sin(turn + 2), 0, 20 * std::cos(turn + 2)}.as<float>()};
        CrowdView view = *view_of(camera, kCullWidth, kCullHeight, world_bounds(viewed));
        const bool exact = frame % 2 == 0;  // full detail
        const bool is_off_by_less = frame % 4 == 3;
        if (exact) view.lod_pixels = 1e-20f;
        if (is_off_by_less) view.lod_pixels = 0.7f;
        ASSERT_TRUE(viewed.update(0.05f, &view) && whole.update(0.05f));
        drawn += drawn_of(viewed).size();
        const Picture a = of_viewed->render(viewed, camera)->picture, b = of_whole->render(whole, camera)->picture;
        double difference = 0;
        for (size_t i = 0; i < a.rgba.size(); ++i) difference += std::abs(int{a.rgba[i]} - int{b.rgba[i]});
        difference /= static_cast<double>(a.rgba.size());
        const double max_off = rounds_like_the_cpu() ? 0 : 1e-4;  // a few colours differ by one step
        EXPECT_TRUE(!exact || difference <= max_off) << "frame " << frame << ": " << difference;
        if (is_off_by_less) worst = std::max(worst, difference);
        worst_moved = std::max(worst_moved, std::max(difference_beyond_a_pixel(a, b), difference_beyond_a_pixel(b, a)));
    }
    EXPECT_LT(drawn, 60 * kCount * 9 / 10) << "something is culled";
    EXPECT_LE(worst, 1.5) << "of 255, on average, where levels are off by 0.7 pixels";
    EXPECT_LE(worst_moved, 0.2) << "of 255, on average: a surface moves by less than a pixel";
    std::printf("  %.0f %% drawn; levels off by 0.7 pixels change a picture by %.2f of 255, by %.2f beyond a pixel\n",
                100.0 * static_cast<double>(drawn) / (60 * kCount), worst, worst_moved);
}

TEST(Cull, WrongViewsAreRefused) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}, .culling = Culling{}}),
          plain = create({.groups = {{&character, 2}}});
    const CrowdView sound = *view_of({}, 4, 3, {});
    EXPECT_TRUE(crowd.update(0, &sound));
    const Result<void> unprepared = plain.update(0, &sound);
    ASSERT_FALSE(unprepared);
    EXPECT_EQ(unprepared.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(unprepared.error().text(), "view: CrowdSettings::culling is not set");
    EXPECT_EQ(refusal(plain.read_drawn()), "read-back: CrowdSettings::culling is not set");
    const auto refused = [&](const std::string& says, void (*spoil)(CrowdView&)) {
        CrowdView view = sound;
        spoil(view);
        const Result<void> updated = crowd.update(0, &view);
        ASSERT_FALSE(updated) << says;
        EXPECT_EQ(updated.error().code, ErrorCode::kInvalidArgument);
        EXPECT_EQ(updated.error().text(), "view: " + says);
    };
    const std::string places = "eye, shadow and ground must be finite", sizes = "pixels and lod_pixels must be above 0",
                      rates = "full_rate_pixels must be from 0 to 1e30, and budget_ms must not be negative",
                      detail = "if pixels is infinite, lod_pixels and shared_pose_pixels must be finite";
    refused("clip_from_world must be finite", [](CrowdView& v) { v.clip_from_world[1][2] = kNan; });
    refused(places, [](CrowdView& v) { v.eye.y = kNan; });
    refused(places, [](CrowdView& v) { v.shadow.x = kNan; });
    refused(places, [](CrowdView& v) { v.ground = kNan; });
    refused(sizes, [](CrowdView& v) { v.pixels = 0; });
    refused(sizes, [](CrowdView& v) { v.lod_pixels = -1; });
    refused(rates, [](CrowdView& v) { v.full_rate_pixels = kInfinity; });
    refused(rates, [](CrowdView& v) { v.budget_ms = -1; });
    refused(detail, [](CrowdView& v) { v.pixels = v.lod_pixels = kInfinity; });
    refused(detail, [](CrowdView& v) { v.pixels = v.shared_pose_pixels = kInfinity; });
    CrowdView far = sound;
    far.pixels = kInfinity;
    EXPECT_TRUE(crowd.update(0, &far)) << "full detail";
}

// What was set before a refused update takes effect in the next one.
TEST(Cull, ARefusedUpdateKeepsPendingChanges) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 3}}, .culling = Culling{}});
    Affine place;
    place.row[0][3] = 5;
    ASSERT_TRUE(crowd.set_placement(InstanceHandle{1}, place));
    CrowdView view = *view_of({}, 4, 3, {});
    view.eye.y = NAN;
    EXPECT_FALSE(crowd.update(0, &view));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_TRUE(same_bits(download<Affine>(test_gpu(), crowd.state().batches[0][io::kPlacementsBuffer]),
                          {Affine(), place, Affine()}));
}

// Positions use the joints of the level that is drawn.
TEST(Cull, PositionsUseTheJointsOfTheDrawnLevel) {
    const Character character = creature_with_lods();
    Crowd crowd = create(
        {.groups = {{&character, 1}}, .path = UpdatePath::kFused, .culling = Culling{.reduces_joints = true}});
    ASSERT_GT(crowd.state().groups[0].fused.size(), 1u);
    const Playback playback{.first = {.clip = 0, .time_s = 0.4}};
    ASSERT_TRUE(crowd.set_playback(InstanceHandle{0}, playback));
    CrowdView view = *view_of({.eye = {0, 0, 3 * character.size}, .target = {0, 0, 0}}, kCullWidth, kCullHeight, {});
    view.lod_pixels = 1e9f;
    ASSERT_TRUE(crowd.update(0, &view));
    const uint32_t lod = drawn_of(crowd).at(0).lod;
    ASSERT_GT(lod, 0u);
    const std::vector<Vec3<float>> got = *crowd.read_positions({0});
    const std::vector<Vec3<double>> all = reference_positions(character, *reference_pose(character, playback));
    double worst = 0;
    for (size_t v = 0; v < got.size(); ++v) worst = worse_of(worst, length(got[v].as<double>() - all[v]));
    EXPECT_LE(worst, 1.01 * double{character.lods[lod - 1].error} + 1e-5 * double{character.size});
}

// For example, a ragdoll that falls far from its instance's placement.
TEST(Cull, SetPosesMayReachFarIfTheGroupAllowsIt) {
    const Character character = creature_with_lods();
    const float away = 20 * character.size;
    std::vector<Trs<float>> pose = character.rig.rest;
    for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint)
        if (character.rig.parents[joint] == kNone) pose[joint].translation.x += away;
    const CrowdView view = *view_of({.eye = {away, 0, 5 * character.size}, .target = {away, 0, 0}}, kCullWidth,
                                    kCullHeight, {});
    const auto is_drawn = [&](std::optional<float> pose_margin) {
        Crowd crowd = create(
            {.groups = {{.character = &character, .instance_count = 1, .pose_capacity = 1, .pose_margin = pose_margin}},
             .culling = Culling{}});
        EXPECT_TRUE(crowd.set_pose(InstanceHandle{0}, pose));
        EXPECT_TRUE(crowd.update(0, &view));
        return drawn_of(crowd).size() == 1;
    };
    EXPECT_FALSE(is_drawn(std::nullopt));
    EXPECT_FALSE(is_drawn(0.0f));
    EXPECT_TRUE(is_drawn(20.0f));
    for (const float wrong : {-1.0f, 1001.0f, std::nanf("")}) {
        const auto refused = Crowd::create(
            test_device(), {.groups = {{.character = &character, .instance_count = 1, .pose_margin = wrong}}});
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().text().find("pose margin: "), std::string::npos) << refused.error().text();
    }
}

// How far a pose may reach beyond the boxes of all clips if the group does not say so, measured by how far away a view
// may begin and still see the instance.
TEST(Cull, ByDefaultPosesStayNearTheirClips) {
    const Character character = creature(30, 10);
    const Controller controller = example("dragon");
    const ProceduralRules rules{.rules = {WindRule{.joint = character.rig.names[1]}}};
    float end = character.bounds_max.x;
    for (const Clip& clip : character.clips) end = std::max(end, clip.bounds_max.x);
    const auto is_drawn = [&](Crowd& crowd, float sizes_beyond) {
        const float half = 10 * character.size;
        const CrowdView view = view_of_box({end + sizes_beyond * character.size + half, 0, 0}, half);
        EXPECT_TRUE(crowd.update(0, &view));
        return drawn_of(crowd).size() == 1;
    };
    const auto expect_reach = [&](float sizes, CrowdGroup group, SkinBlend blend, const char* what) {
        group.character = &character;
        group.instance_count = 1;
        Crowd crowd = create({.groups = {group}, .culling = Culling{}, .skin_blend = blend});
        EXPECT_TRUE(is_drawn(crowd, 0.9f * sizes)) << what;
        EXPECT_FALSE(is_drawn(crowd, 1.1f * sizes)) << what;
    };
    constexpr float kBlends = 0.1f, kAnything = 0.5f;
    expect_reach(kBlends, {}, SkinBlend::kLinear, "two clips");
    expect_reach(kAnything, {.controller = &controller}, SkinBlend::kLinear, "a controller");
    expect_reach(kAnything, {.procedural = &rules}, SkinBlend::kLinear, "rules");
    expect_reach(kAnything, {.pose_capacity = 1}, SkinBlend::kLinear, "poses from outside");
    expect_reach(kAnything, {}, SkinBlend::kDualQuaternion, "dual quaternions");
    expect_reach(0.3f, {.controller = &controller, .pose_margin = 0.3f}, SkinBlend::kLinear, "what the group says");
}

}  // namespace
}  // namespace throng::test
