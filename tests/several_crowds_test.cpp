// Several crowds in one picture: the same picture as one crowd with all their groups.
#include "tests/crowd_cases.h"
#include "tests/draw_path.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kSeveralCrowdsInSubsets({Subset::kGpuAssisted},
                                       {"*SeveralCrowds.DrawLikeOneCrowdWithAllGroups/ByShaders"}),
    kSeveralCrowdsNatively({Subset::kNative}, {"*SeveralCrowds.*"});

constexpr uint32_t kSeveralCrowdsCount = 6, kSeveralCrowdsWidth = 200, kSeveralCrowdsHeight = 120;

class SeveralCrowds : public testing::TestWithParam<DrawPath> {
protected:
    void SetUp() override {
        if (const std::string reason = undrawable_reason(GetParam()); !reason.empty()) GTEST_SKIP() << reason;
        renderer_ = Renderer::create(test_device(),
                                     {.width = kSeveralCrowdsWidth, .height = kSeveralCrowdsHeight, .path = GetParam()})
                        .value();
    }

    // Each group stands behind the one before. `first`: the number of the crowd's first group in the whole.
    Crowd crowd_of(const std::vector<const Character*>& characters, size_t first, bool culls = true) const {
        CrowdSettings settings{.keep_model_matrices = true};
        if (culls) settings.culling.emplace();
        for (const Character* character : characters)
            settings.groups.push_back({.character = character, .instance_count = kSeveralCrowdsCount});
        Crowd crowd = create(settings);
        for (uint32_t i = 0; i < crowd.instance_count(); ++i) {
            const Vec3<float> place{static_cast<float>(i % kSeveralCrowdsCount), 0,
                                    -static_cast<float>(first + i / kSeveralCrowdsCount)};
            EXPECT_TRUE(crowd.set_placement(InstanceHandle{i}, to_affine(Trs<float>{.translation = place})));
            EXPECT_TRUE(crowd.set_playback(InstanceHandle{i},
                                           {.first = {.clip = 0, .time_s = 0.1 * (i % kSeveralCrowdsCount)}}));
        }
        return crowd;
    }

    const Character walker_ = creature(40, 10), worm_ = creature(25, 20);
    const Camera camera_{.eye = {2, 1.5f, 5}, .target = {2.5f, 0.5f, 0}};
    Renderer renderer_;
};

TEST_P(SeveralCrowds, DrawLikeOneCrowdWithAllGroups) {
    const bool on_device = GetParam() == DrawPath::kDevice;
    for (const DrawOptions options : {DrawOptions(), DrawOptions{.skeletons = true, .bounds = true},
                                      DrawOptions{.shadows = false, .occlusion = on_device}}) {
        ASSERT_TRUE(renderer_.set_options(options));
        Crowd whole = crowd_of({&walker_, &worm_}, 0), front = crowd_of({&walker_}, 0), back = crowd_of({&worm_}, 1);
        const auto together = std::array{&front, &back};
        for (int frame = 0; frame < 3; ++frame)
            ASSERT_EQ(renderer_.render_frame(whole, 0.1f, camera_).value().picture.rgba,
                      renderer_.render_frame(together, 0.1f, camera_).value().picture.rgba)
                << "frame " << frame;
        const std::vector<uint8_t> one = renderer_.render(front, camera_).value().picture.rgba,
                                   both = renderer_.render(together, camera_).value().picture.rgba;
        EXPECT_NE(one, both);
        EXPECT_EQ(both, renderer_.render(whole, camera_).value().picture.rgba);
    }
}

// One crowd culls and one does not, so each has its own pipelines.
TEST_P(SeveralCrowds, MayHaveDifferentSettings) {
    const bool on_device = GetParam() == DrawPath::kDevice;
    ASSERT_TRUE(renderer_.set_options({.occlusion = on_device, .lod_pixels = 1e-20f}));  // both in full detail
    Crowd front = crowd_of({&walker_}, 0, false), back = crowd_of({&worm_}, 1),
          whole = crowd_of({&walker_, &worm_}, 0, false);
    for (int frame = 0; frame < 2; ++frame)
        ASSERT_EQ(renderer_.render_frame(whole, 0.1f, camera_).value().picture.rgba,
                  renderer_.render_frame(std::array{&front, &back}, 0.1f, camera_).value().picture.rgba);
}

TEST_P(SeveralCrowds, CanBeRecordedTogether) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    const Gpu& gpu = *test_gpu();
    Crowd front = crowd_of({&walker_}, 0), back = crowd_of({&worm_}, 1), whole = crowd_of({&walker_, &worm_}, 0);
    const auto together = std::array{&front, &back};
    Buffer pixels(test_gpu(), "pixels", kSeveralCrowdsWidth * kSeveralCrowdsHeight * 4,
                  VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::kReadback);
    const auto picture = [&](const auto& record) {
        gpu.submit_and_wait([&](VkCommandBuffer commands) {
            record(commands);
            const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                           .imageExtent = {kSeveralCrowdsWidth, kSeveralCrowdsHeight, 1}};
            gpu.vk.vkCmdCopyImageToBuffer(commands, renderer_.picture(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                          pixels.handle(), 1, &region);
            memory_barrier(gpu, commands, kTransferWrite, kHostRead);
        });
        return std::vector(pixels.mapped(), pixels.mapped() + pixels.size_bytes());
    };
    const auto of_whole = picture(
        [&](VkCommandBuffer commands) { ASSERT_TRUE(renderer_.record(commands, whole, 0.1f, camera_)); });
    EXPECT_EQ(of_whole, picture([&](VkCommandBuffer commands) {
                  ASSERT_TRUE(renderer_.record(commands, together, 0.1f, camera_));
              }));
    const auto drawn = [&](auto&&... of) {
        return picture(
            [&](VkCommandBuffer commands) { ASSERT_TRUE(renderer_.record_drawing(commands, of..., camera_)); });
    };
    EXPECT_EQ(drawn(whole), drawn(together));
    ASSERT_TRUE(renderer_.update(whole, 0.1f, camera_));
    ASSERT_TRUE(renderer_.update(together, 0.1f, camera_));
    EXPECT_EQ(drawn(whole), drawn(together));
    EXPECT_NE(of_whole, drawn(together));
}

TEST_P(SeveralCrowds, InvalidListsOfCrowdsAreRefused) {
    Crowd crowd = crowd_of({&walker_}, 0), none;
    const auto message = [&](std::vector<Crowd*> crowds) {
        return refusal(renderer_.render_frame(crowds, 0.1f, camera_)) +
               refusal(renderer_.update(crowds, 0.1f, camera_));
    };
    EXPECT_NE(message({}).find("the list of crowds is empty"), std::string::npos);
    EXPECT_NE(message({&crowd, &crowd}).find("a crowd is listed twice"), std::string::npos);
    EXPECT_NE(message({&crowd, nullptr}).find("a crowd is null"), std::string::npos);
    EXPECT_NE(message({&crowd, &none}).find("the Crowd was not made by Crowd::create()"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Both, SeveralCrowds, kBothDrawPaths, name_of_path);

}  // namespace
}  // namespace throng::test
