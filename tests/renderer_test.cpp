// Renderers: consecutive frames, sizes, and what is refused.
#include "crowd/crowd_state.h"
#include "gpu/barrier.h"
#include "gpu/upload.h"
#include "tests/draw_cases.h"
#include "tests/draw_path.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_device.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>

namespace throng {
namespace {

using namespace test;

// Under GPU-assisted validation the excluded test takes too long.
const InSubset kRendererInSubsets({Subset::kGpuAssisted}, {"Renderer.*", "-Renderer.ConsecutiveFramesAreSynchronized"}),
    kRendererNatively({Subset::kNative}, {"Renderer.*"});

Renderer renderer_of(RendererSettings settings = {.width = kDrawWidth, .height = kDrawHeight}) {
    settings.path = device_path();
    Result<Renderer> renderer = Renderer::create(test_device(), settings);
    EXPECT_TRUE(renderer) << (renderer ? "" : renderer.error().text());
    return std::move(*renderer);
}

// One thread can create a renderer while others use the queue.
TEST(Renderer, IsMadeWithoutASubmission) {
    const uint64_t before = test_gpu()->counts.submissions;
    renderer_of();
    EXPECT_EQ(test_gpu()->counts.submissions, before);
}

// Whatever the memory for its matrices contains.
TEST(Renderer, ShowsNoInstanceBeforeTheFirstUpdate) {
    const Character character = compile_character(square()).value();
    for (const DrawPath path : {DrawPath::kNative, DrawPath::kDevice}) {
        if (!undrawable_reason(path).empty()) continue;
        Renderer renderer =
            Renderer::create(test_device(), {.width = kDrawWidth, .height = kDrawHeight, .path = path}).value();
        Crowd crowd = crowd_of(character);
        const Batch& batch = crowd.state().batches[0];
        Uploads uploads(test_gpu());
        for (const Buffer* const buffer : {&batch.skins[0], &batch[io::kPlacementsBuffer]}) {
            const std::vector<Affine> unit(buffer->size_bytes() / sizeof(Affine));
            uploads.add(*buffer, std::as_bytes(std::span(unit)));
        }
        uploads.finish();
        EXPECT_FALSE(is_red(at(renderer.render(crowd, kFront)->picture, 0, 0.5)));
        ASSERT_TRUE(crowd.update(0));
        EXPECT_TRUE(is_red(at(renderer.render(crowd, kFront)->picture, 0, 0.5)));
    }
}

TEST(Renderer, RefusesWhatTheDeviceCannotDo) {
    const DrawPath path = device_path();
    const Result<Renderer> empty = Renderer::create(test_device(), {.width = 0, .height = 5, .path = path});
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().code, ErrorCode::kInvalidArgument);
    const Result<Renderer> huge = Renderer::create(test_device(), {.width = 1u << 20, .height = 5, .path = path});
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, ErrorCode::kLimit);
    const char* const limit = path == DrawPath::kNative ? "exceeds the native renderer's limit of 16384 pixels"
                                                        : "exceeds the device's";
    EXPECT_NE(huge.error().text().find(limit), std::string::npos) << huge.error().text();
}

TEST(Renderer, RefusesACameraThatSeesNothing) {
    const Result<Character> character = compile_character(square(), kExact);
    ASSERT_TRUE(character);
    Result<Crowd> crowd = Crowd::create(test_device(), {.groups = {{&*character, 1}}});
    ASSERT_TRUE(crowd && crowd->update(0));
    Renderer& renderer = shared_renderer(1);
    const float infinity = std::numeric_limits<float>::infinity();
    for (const Camera& camera : {Camera{.eye = {1, 1, 1}, .target = {1, 1, 1}}, Camera{.eye = {infinity, 0, 0}},
                                 Camera{.vertical_field_of_view_rad = 0}, Camera{.vertical_field_of_view_rad = 4}}) {
        const Result<RenderResult> result = renderer.render(*crowd, camera);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    }
    const Camera down{.eye = {0, 5, 0}, .target = {0, 0, 0}};
    EXPECT_TRUE(renderer.render(*crowd, down)) << "straight down is a direction, too";
}
// Two frames in one command buffer, so that only barriers separate them, for crowds that cull and keep two sets of
// matrices, and for crowds that do neither.
TEST(Renderer, ConsecutiveFramesAreSynchronized) {
    const Result<Character> character = compile_character(square(), kExact);
    ASSERT_TRUE(character);
    Renderer one = renderer_of();
    Renderer& other = shared_renderer(4);
    for (const CrowdSettings& settings :
         {CrowdSettings{}, CrowdSettings{.keep_previous_matrices = true, .culling = Culling{}}}) {
        Crowd apart = crowd_of(*character, settings), together = crowd_of(*character, settings),
              recorded = crowd_of(*character, settings);
        std::vector<Picture> expected;
        for (int frame = 0; frame < 2; ++frame) {
            ASSERT_TRUE(apart.update(0.4f));
            expected.push_back(one.render(apart, kFront)->picture);
            const Result<RenderResult> result = other.render_frame(together, 0.4f, kFront);
            ASSERT_TRUE(result) << result.error().text();
            EXPECT_EQ(result->picture.rgba, expected.back().rgba) << "frame " << frame;
            EXPECT_EQ(result->draw_ms, other.draw_ms());
        }
        EXPECT_NE(expected[0].rgba, expected[1].rgba);

        if (test_device().gpu()->is_native()) continue;
        const std::shared_ptr<Gpu> gpu = test_device().gpu();
        std::array<Buffer, 2> copies;
        for (Buffer& copy : copies) copy = Buffer(gpu, "copy", expected[0].rgba.size(), 0, MemoryKind::kReadback);
        gpu->submit_and_wait([&](VkCommandBuffer commands) {
            for (const Buffer& copy : copies) {
                const Result<void> result = one.record(commands, recorded, 0.4f, kFront);
                ASSERT_TRUE(result) << result.error().text();
                VkBufferImageCopy region{};
                region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
                region.imageExtent = {kDrawWidth, kDrawHeight, 1};
                gpu->vk.vkCmdCopyImageToBuffer(commands, one.picture(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                               copy.handle(), 1, &region);
            }
            memory_barrier(*gpu, commands, kTransferWrite, kHostRead);
        });
        for (size_t frame = 0; frame < 2; ++frame)
            EXPECT_EQ(std::memcmp(copies[frame].mapped(), expected[frame].rgba.data(), expected[frame].rgba.size()), 0)
                << "frame " << frame;
    }
}

TEST(Renderer, DetectsAnotherCrowdAtTheSameAddress) {
    Asset green = square();
    green.materials[0].base_color = {0.02f, 0.8f, 0.02f, 1};
    const Result<Character> first = compile_character(square(), kExact), second = compile_character(green, kExact);
    ASSERT_TRUE(first && second);
    Renderer& renderer = shared_renderer(4);
    Crowd crowd = crowd_of(*first), kept = crowd_of(*first);
    EXPECT_TRUE(is_red(at(renderer.render_frame(crowd, 0, kFront)->picture, -1.5, 0.5)));
    EXPECT_TRUE(is_red(at(renderer.render_frame(kept, 0, kFront)->picture, -1.5, 0.5)));
    crowd = crowd_of(*second);
    EXPECT_TRUE(is_green(at(renderer.render_frame(crowd, 0, kFront)->picture, -1.5, 0.5)));
    EXPECT_TRUE(is_red(at(renderer.render_frame(kept, 0, kFront)->picture, -1.5, 0.5)));
}

TEST(Renderer, CanBeResized) {
    const Result<Character> character = compile_character(square(), kExact);
    ASSERT_TRUE(character);
    Crowd crowd = crowd_of(*character);
    Renderer renderer = renderer_of({.width = 20, .height = 90});
    ASSERT_TRUE(renderer.render_frame(crowd, 0, kFront));
    ASSERT_TRUE(renderer.resize(kDrawWidth, kDrawHeight));
    EXPECT_TRUE(is_red(at(renderer.render_frame(crowd, 0, kFront)->picture, -1.5, 0.5)));
    const Result<void> empty = renderer.resize(0, 4), huge = renderer.resize(1u << 20, 4);
    ASSERT_FALSE(empty || huge);
    EXPECT_EQ(empty.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(huge.error().code, ErrorCode::kLimit);
    EXPECT_EQ(renderer.render_frame(crowd, 0, kFront)->picture.width, kDrawWidth) << "keeps its size";
}

TEST(Renderer, RefusesWrongOptions) {
    Renderer renderer = renderer_of({.width = 8, .height = 8});
    const float infinity = std::numeric_limits<float>::infinity();
    for (const DrawOptions& options :
         {DrawOptions{.exposure = 0}, DrawOptions{.exposure = infinity}, DrawOptions{.to_sun = {1, 0.04f, 0}},
          DrawOptions{.to_sun = {0, 0, 0}}, DrawOptions{.to_sun = {0, infinity, 0}}, DrawOptions{.lod_pixels = 0},
          DrawOptions{.lod_pixels = infinity}, DrawOptions{.full_rate_pixels = -1},
          DrawOptions{.full_rate_pixels = infinity}, DrawOptions{.budget_ms = -1}}) {
        const Result<void> result = renderer.set_options(options);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
        EXPECT_FALSE(
            Renderer::create(test_device(), {.width = 8, .height = 8, .options = options, .path = device_path()}));
    }
    ASSERT_TRUE(renderer.set_options({.exposure = 2}));
    EXPECT_EQ(renderer.options().exposure, 2);
}

}  // namespace
}  // namespace throng
