// Occlusion culling: instances hidden behind what has been drawn.
#include "crowd/crowd_state.h"
#include "crowd/cull_stage.h"
#include "cull/occlusion_reference.h"
#include "draw/image.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tools/creatures/creature.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <set>

namespace throng::test {
namespace {

// An image with these depths, ready to be read.
Image depth_image(const std::vector<float>& depths, uint32_t width, uint32_t height) {
    Image image(test_gpu(), {.what = "depths",
                             .extent = {width, height},
                             .format = VK_FORMAT_R32_SFLOAT,
                             .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                      VK_IMAGE_USAGE_SAMPLED_BIT});
    const Buffer staging = upload(test_gpu(), "depths", depths, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
        transition(*test_gpu(), commands, image.handle(), discarded_after(Access{}), kCopyTarget);
        VkBufferImageCopy copy{};
        copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        copy.imageExtent = {width, height, 1};
        test_gpu()->vk.vkCmdCopyBufferToImage(commands, staging.handle(), image.handle(),
                                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
        transition(*test_gpu(), commands, image.handle(), kCopyTarget, kCopySource);
    });
    return image;
}

// Both halves of an update, in one submission.
void update(Crowd& crowd, const CrowdView& view, const DepthImage& depths) {
    test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
        EXPECT_TRUE(crowd.record(commands, 0.01f, &view));
        const Result<void> recorded = crowd.record_disoccluded(commands, depths);
        EXPECT_TRUE(recorded) << (recorded ? "" : recorded.error().text());
    });
}

std::set<uint32_t> instances_drawn(Crowd& crowd) {
    std::set<uint32_t> instances;
    for (const DrawnInstance& one : drawn_of(crowd))
        EXPECT_TRUE(instances.insert(one.instance).second) << "listed twice";
    return instances;
}

// Rectangles at random depths before an empty sky; reversed: 1 is near, 0 is infinitely far.
std::vector<float> random_depths(Random& random, uint32_t width, uint32_t height) {
    std::vector<float> depths(size_t{width} * height, 0);
    for (uint32_t i = 0; i < 6; ++i) {
        const uint32_t left = random.below(width), top = random.below(height), right = left + random.below(width),
                       bottom = top + random.below(height);
        const auto depth = static_cast<float>(1e-4 * std::pow(10, random.between(0, 2)));
        for (uint32_t y = top; y < std::min(bottom, height); ++y)
            for (uint32_t x = left; x < std::min(right, width); ++x)
                depths[size_t{y} * width + x] = std::max(depths[size_t{y} * width + x], depth);
    }
    return depths;
}

TEST(Occlusion, EverythingTheReferenceSeesIsDrawn) {
    const Character character = small_character();
    constexpr uint32_t kCount = 400;
    uint32_t hidden = 0, hidden_by_reference = 0, shown = 0;
    for (const auto& [width, height] : {std::pair{160u, 120u}, {97u, 33u}, {1u, 7u}}) {
        for (const bool reversed : {true, false}) {
            Random random(width + reversed);
            Crowd crowd = create({.groups = {{&character, kCount}}, .path = UpdatePath::kFused, .culling = Culling{}});
            const Group& group = crowd.state().groups[0];
            const double size = length(group.posed_max - group.posed_min);
            std::vector<Affine> places;
            for (uint32_t i = 0; i < kCount; ++i)
                places.push_back(to_affine(Trs<double>{.translation = random.vector(60 * size)}).as<float>());
            ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
            const CullBox box{((group.posed_min + group.posed_max) * 0.5f).as<double>(),
                              ((group.posed_max - group.posed_min) * 0.5f).as<double>()};
            for (int round = 0; round < 6; ++round) {
                CrowdView view = *view_of(
                    {.eye = random.vector(60 * size).as<float>(), .target = random.vector(20 * size).as<float>()},
                    width, height, {});
                view.shadow = round % 2 ? random.vector(2 * size).as<float>() : Vec3<float>{};
                view.ground = round % 3 ? static_cast<float>(random.between(-20, 20) * size) : -1e30f;
                view.occlusion = true;
                std::vector<float> depths = random_depths(random, width, height);
                for (float& depth : depths) depth *= static_cast<float>(size);
                io::CullView seen = cull_view_of(&view, 0);
                std::vector<float> given = depths;
                if (!reversed) {  // the same scene with depths that increase with distance: 1 - z
                    for (float& depth : given) depth = 1 - depth;
                    for (size_t k = 0; k < 4; ++k)
                        view.clip_from_world[2][k] = view.clip_from_world[3][k] - view.clip_from_world[2][k];
                }
                const Image image = depth_image(given, width, height);
                // Twice: first all wait, then those that were visible are listed before the depths are known.
                for (int turn = 0; turn < 2; ++turn) {
                    update(crowd, view, {image.handle(), VK_IMAGE_ASPECT_COLOR_BIT, width, height, reversed});
                    const std::set<uint32_t> drawn = instances_drawn(crowd);
                    for (uint32_t i = 0; i < kCount; ++i) {
                        const AffineT<double> place = places[i].as<double>();
                        if (std::abs(seen_by(seen, place, box)) < 1e-4 * size) continue;
                        const bool in_view = seen_by(seen, place, box) > 0;
                        const double shown_by_reference = shown_by(seen, place, box, depths, width, height);
                        EXPECT_TRUE(in_view || !drawn.contains(i));
                        EXPECT_TRUE(!in_view || shown_by_reference <= -1e-7 || drawn.contains(i))
                            << "instance " << i << " is visible";
                        if (!in_view || turn > 0) continue;
                        hidden += !drawn.contains(i);
                        hidden_by_reference += shown_by_reference < -1e-7;
                        shown += drawn.contains(i);
                    }
                }
            }
        }
    }
    EXPECT_GT(shown, 500u);
    EXPECT_GT(hidden, hidden_by_reference * 6 / 10) << "and most of what is hidden is not drawn";
    std::printf("  %u drawn; %u hidden, by the reference %u\n", shown, hidden, hidden_by_reference);
}

// A waiting instance is animated as soon as nothing hides it. One that becomes hidden is drawn once more, since it may
// hide others, and then no longer.
TEST(Occlusion, AppearingInstancesAreAnimatedAtOnce) {
    const Character character = small_character();
    constexpr uint32_t kCount = 20, kSize = 64;
    Crowd crowd = create({.groups = {{&character, kCount}},
                          .path = UpdatePath::kFused,
                          .keep_previous_matrices = true,
                          .culling = Culling{.skips_updates = true}}),
          whole = create({.groups = {{&character, kCount}}, .path = UpdatePath::kFused});
    const std::vector<Affine> places(kCount,
                                     to_affine(Trs<double>{.translation = {0, 0, -10.0 * character.size}}).as<float>());
    Random random(3);
    const std::vector<Playback> playbacks = random_playbacks(random, character, kCount);
    for (Crowd* one : {&crowd, &whole})
        ASSERT_TRUE(one->set_placement(one->instances(), places) && one->set_playback(one->instances(), playbacks));
    CrowdView view = *view_of({.eye = {0, 0, 0}, .target = {0, 0, -1}}, kSize, kSize, {});
    view.occlusion = true;
    const Image open = depth_image(std::vector<float>(kSize * kSize, 0.0f), kSize, kSize),
                closed = depth_image(std::vector<float>(kSize * kSize, 1.0f), kSize, kSize);
    const std::vector<std::pair<const Image*, size_t>> steps{
        {&closed, 0}, {&closed, 0}, {&open, kCount}, {&open, kCount}, {&closed, kCount}, {&closed, 0}, {&open, kCount}};
    for (const auto& [image, count] : steps) {
        update(crowd, view, {image->handle(), VK_IMAGE_ASPECT_COLOR_BIT, kSize, kSize});
        ASSERT_TRUE(whole.update(0.01f));
        EXPECT_EQ(instances_drawn(crowd).size(), count);
        for (uint32_t i = 0; i < kCount && count > 0; ++i)
            EXPECT_TRUE(same_bits(*crowd.read_skin_matrices({i}), *whole.read_skin_matrices({i}))) << i;
    }
    const std::vector<Affine> previous = download<Affine>(
        test_gpu(),
        BufferRange(crowd.outputs()[0].previous_skin.buffer, 0, crowd.outputs()[0].palette_count * sizeof(Affine)));
    EXPECT_TRUE(same_bits(previous, *crowd.read_skin_matrices({0}))) << "what appears has not moved";
}

// A picture with more texels than the device dispatches workgroups. A larger one follows while the first one's update
// is still running.
TEST(Occlusion, PicturesMayBeLargeAndChangeInSize) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}, .culling = Culling{}});
    const std::vector<Affine> places(2,
                                     to_affine(Trs<double>{.translation = {0, 0, -10.0 * character.size}}).as<float>());
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    CrowdView view = *view_of({.eye = {0, 0, 0}, .target = {0, 0, -1}}, 64, 64, {});
    view.occlusion = true;
    constexpr uint32_t kWidth = 16384, kHeight = 1040;
    const Image small = depth_image(std::vector<float>(64, 0.0f), 8, 8),
                large = depth_image(std::vector<float>(size_t{kWidth} * kHeight, 1.0f), kWidth, kHeight);
    test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
        ASSERT_TRUE(crowd.record(commands, 0.01f, &view) &&
                    crowd.record_disoccluded(commands, {small.handle(), VK_IMAGE_ASPECT_COLOR_BIT, 8, 8}));
        for (int turn = 0; turn < 2; ++turn)
            ASSERT_TRUE(
                crowd.record(commands, 0.01f, &view) &&
                crowd.record_disoccluded(commands, {large.handle(), VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight}));
    });
    EXPECT_EQ(instances_drawn(crowd).size(), 0u) << "all hidden, wherever they are looked for";
    update(crowd, view, {small.handle(), VK_IMAGE_ASPECT_COLOR_BIT, 8, 8});
    EXPECT_EQ(instances_drawn(crowd).size(), 2u);
}

TEST(Occlusion, SaveAndRestoreBetweenTheHalvesAreRefused) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}, .culling = Culling{}});
    CrowdView view = *view_of({.eye = {0, 0, 0}, .target = {0, 0, -1}}, 64, 64, {});
    view.occlusion = true;
    const Image depths = depth_image(std::vector<float>(64, 0.0f), 8, 8);
    const std::vector<std::byte> before = *crowd.save_state();
    test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
        ASSERT_TRUE(crowd.record(commands, 0.01f, &view));
        const auto saved = crowd.save_state();
        ASSERT_FALSE(saved);
        EXPECT_EQ(saved.error().text(),
                  "crowd state: the last record() was for a view with occlusion: call record_disoccluded() first");
        EXPECT_EQ(refusal(crowd.restore_state(before)), saved.error().text());
        ASSERT_TRUE(crowd.record_disoccluded(commands, {depths.handle(), VK_IMAGE_ASPECT_COLOR_BIT, 8, 8}));
    });
    EXPECT_TRUE(crowd.save_state());
}

// A gap of one column in a wall, at every position in turn. What comes within a texel of the gap is drawn, since the
// wall was drawn with different rounding.
TEST(Occlusion, OneTexelAroundABoxIsTestedToo) {
    const Character character = small_character();
    constexpr uint32_t kCount = 12, kSize = 48;
    Crowd crowd = create({.groups = {{&character, kCount}}, .path = UpdatePath::kFused, .culling = Culling{}});
    const Group& group = crowd.state().groups[0];
    const CullBox box{((group.posed_min + group.posed_max) * 0.5f).as<double>(),
                      ((group.posed_max - group.posed_min) * 0.5f).as<double>()};
    const double size = length(group.posed_max - group.posed_min);
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kCount; ++i)
        places.push_back(to_affine(Trs<double>{.translation = {(i - 5.5) * 0.37 * size, 0, -10 * size}}).as<float>());
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    CrowdView view = *view_of({.eye = {0, 0, 0}, .target = {0, 0, -1}}, kSize, kSize, {});
    const CrowdView away = *view_of({.eye = {0, 0, 0}, .target = {0, 0, 1}}, kSize, kSize, {});
    view.occlusion = true;
    const io::CullView seen = cull_view_of(&view, 0);
    uint32_t hidden = 0, shown = 0;
    for (uint32_t gap = 0; gap < kSize; ++gap) {
        std::vector<float> depths(kSize * kSize, 1), wider = depths;
        for (uint32_t i = 0; i < kSize * kSize; ++i) {
            if (i % kSize == gap) depths[i] = 0;
            if (i % kSize + 1 >= gap && i % kSize <= gap + 1) wider[i] = 0;
        }
        const Image image = depth_image(depths, kSize, kSize);
        ASSERT_TRUE(crowd.update(0, &away));
        update(crowd, view, {image.handle(), VK_IMAGE_ASPECT_COLOR_BIT, kSize, kSize});
        const std::set<uint32_t> drawn = instances_drawn(crowd);
        for (uint32_t i = 0; i < kCount; ++i) {
            const bool is_near = shown_by(seen, places[i].as<double>(), box, wider, kSize, kSize) > 0;
            EXPECT_TRUE(!is_near || drawn.contains(i)) << "instance " << i << ", gap " << gap;
            shown += is_near;
            hidden += !drawn.contains(i);
        }
    }
    EXPECT_GT(shown, kCount);
    EXPECT_GT(hidden, kCount * kSize / 2);
}

TEST(Occlusion, RunningOutOfMemoryLeavesTheCrowdUnchanged) {
    const Device device = another_device();
    const Character character = creature(20, 8);
    Crowd crowd =
        Crowd::create(device, {.groups = {{&character, 4}}, .path = UpdatePath::kDevice, .culling = Culling{}}).value();
    Renderer renderer = Renderer::create(device, {.width = 64, .height = 64, .path = DrawPath::kDevice}).value();
    ASSERT_TRUE(renderer.set_options({.occlusion = true}));
    const Camera camera{.eye = {0, 2, 9}, .target = {}};
    const std::vector<std::byte> before = *crowd.save_state();
    uint32_t& limit_bytes = device.gpu()->properties.limits.maxStorageBufferRange;
    const uint32_t enough_bytes = std::exchange(limit_bytes, 64 * 64 * 4 - 1);  // the depths of the picture do not fit
    const Result<RenderResult> refused = renderer.render_frame(crowd, 0.1f, camera);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kLimit) << refused.error().text();
    limit_bytes = enough_bytes;
    EXPECT_EQ(*crowd.save_state(), before);
    EXPECT_TRUE(renderer.render_frame(crowd, 0.1f, camera));
    EXPECT_FALSE(drawn_of(crowd).empty());
}

Character at_full_lod(Character character) {
    character.lods.clear();
    character.lod_ranges.clear();
    character.lod_indices.clear();
    character.joint_lods.clear();
    return character;
}

// A block that moves with the root of a character, and fills nine tenths of its bounds.
Character block_of(Character character) {
    const Vec3<float> middle = (character.bounds_min + character.bounds_max) * 0.5f,
                      half = (character.bounds_max - character.bounds_min) * 0.45f;
    MeshSection section = character.sections[0];
    section.first_vertex = section.first_influences = section.first_index = 0;
    section.influence_sets = 1;
    section.vertex_count = 8, section.lod_vertex_count = 0;
    character.vertices.clear();
    character.influences.clear();
    for (uint32_t corner = 0; corner < 8; ++corner) {
        character.vertices.push_back(
            {.position = middle + Vec3<float>{corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                                              corner & 4 ? half.z : -half.z},
             .normal_octahedral = 0});
        character.influences.push_back({.weights = {1, 0, 0, 0}, .entries = {}});
    }
    character.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                         2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    section.index_count = static_cast<uint32_t>(character.indices.size());
    character.sections = {section};
    return character;
}

// Jumps between random views, one submission each: the picture equals that of a fully animated and drawn crowd to the
// pixel, shadows included. Every tenth view stays for three frames, of which the last hides most.
struct Kept {
    bool skins_once = false;
    bool pools = false;  // skin matrices only of what is drawn, instead of skipped updates
};

void expect_nothing_lost(uint32_t view_count, const Kept& kept) {
    constexpr uint32_t kCount = 40, kBlocks = 10;
    const Character character = at_full_lod(
                        *compile_character(*make_creature({.joint_count = 20, .level_count = 6, .face_count = 100}))),
                    block = block_of(character);
    Random random(21);
    const double size = character.size;
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kBlocks + kCount; ++i) {
        const double scale = i < kBlocks ? 3 : 0.5;
        places.push_back(to_affine(Trs<double>{axis_angle(Vec3<double>{0, 1, 0}, random.between(0, 6)),
                                               {random.between(-9, 9) * size, -character.bounds_min.y * scale,
                                                random.between(-9, 9) * size},
                                               {scale, scale, scale}})
                             .as<float>());
    }
    const std::vector<Playback> playbacks = random_playbacks(random, character, kBlocks + kCount);
    const std::vector<CrowdGroup> groups{{&block, kBlocks}, {&character, kCount}};
    std::vector<CrowdGroup> pooled = groups;
    if (kept.pools)
        for (CrowdGroup& group : pooled) group.skin_pool = SkinPool{.capacity = group.instance_count};
    Crowd crowd = create(
              {.groups = pooled, .culling = Culling{.skips_updates = !kept.pools}, .skins_once = kept.skins_once}),
          whole = create({.groups = groups, .skins_once = kept.skins_once});
    for (Crowd* one : {&crowd, &whole})
        ASSERT_TRUE(one->set_placement(one->instances(), places) && one->set_playback(one->instances(), playbacks));
    Result<Renderer> renderer = Renderer::create(test_device(), {.width = 48, .height = 36, .path = DrawPath::kDevice});
    ASSERT_TRUE(renderer);
    uint64_t drawn = 0, in_view = 0;
    const auto see = [&](const Camera& camera) {
        const Result<RenderResult> seen = renderer->render_frame(crowd, 0.01f, camera),
                                   wanted = renderer->render_frame(whole, 0.01f, camera);
        if (!seen || !wanted) return false;
        // Pools use other kernels, so an edge may fall on either side of a pixel centre.
        return different_bytes(seen->picture, wanted->picture) <= (kept.pools && !rounds_like_the_cpu() ? 12 : 0);
    };
    for (uint32_t number = 0; number < view_count; ++number) {
        const Camera camera{
            .eye = Vec3<double>{random.between(-10, 10) * size, random.between(0.1, 3) * size,
                                random.between(-10, 10) * size}
                       .as<float>(),
            .target = Vec3<double>{random.between(-5, 5) * size, size, random.between(-5, 5) * size}.as<float>()};
        ASSERT_TRUE(renderer->set_options({.shadows = number % 3 == 0, .occlusion = true, .shared_pose_pixels = 0}));
        ASSERT_TRUE(see(camera)) << "view " << number;
        if (number % 10 > 0) continue;
        ASSERT_TRUE(see(camera) && see(camera)) << "view " << number << ", seen again";
        drawn += drawn_of(crowd).size();
        CrowdView view = *view_of(camera, 48, 36, world_bounds(crowd), renderer->options());
        ASSERT_TRUE(crowd.update(0, &view) && whole.update(0));
        in_view += drawn_of(crowd).size();
    }
    EXPECT_LT(drawn + view_count / 20, in_view) << "some are hidden";
    std::printf("  of %llu in view %llu are drawn\n", static_cast<unsigned long long>(in_view),
                static_cast<unsigned long long>(drawn));
}

TEST(Occlusion, RandomViewsHideNothingVisible) { expect_nothing_lost(1000, {}); }
TEST(Occlusion, RandomViewsWithSkinsOnceHideNothingVisible) { expect_nothing_lost(60, {.skins_once = true}); }
TEST(Occlusion, RandomViewsWithASkinPoolHideNothingVisible) { expect_nothing_lost(100, {.pools = true}); }

TEST(Occlusion, WrongUseIsRefused) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}, .culling = Culling{}}),
          plain = create({.groups = {{&character, 2}}});
    CrowdView view = *view_of({}, 4, 3, {});
    const Image image = depth_image(std::vector<float>(12), 4, 3);
    const auto refused = [&](Crowd& of, const DepthImage& depths) {
        Result<void> result;
        test_gpu()->submit_and_wait(
            [&](VkCommandBuffer commands) { result = of.record_disoccluded(commands, depths); });
        return !result && result.error().code == ErrorCode::kInvalidArgument;
    };
    const DepthImage depths{image.handle(), VK_IMAGE_ASPECT_COLOR_BIT, 4, 3};
    EXPECT_TRUE(refused(plain, depths));
    EXPECT_TRUE(refused(crowd, depths)) << "nothing recorded";
    ASSERT_TRUE(crowd.update(0, &view));
    EXPECT_TRUE(refused(crowd, depths)) << "a view without occlusion";
    view.occlusion = true;
    ASSERT_TRUE(crowd.update(0, &view));
    EXPECT_TRUE(refused(crowd, {})) << "no image";
    EXPECT_FALSE(refused(crowd, depths));
    EXPECT_TRUE(refused(crowd, depths)) << "twice";
}

}  // namespace
}  // namespace throng::test
