// Textures of the same image are made once, and images that are decoded ahead are not decoded again.
#include "crowd/shared_images.h"
#include "draw/native_group.h"
#include "tests/ball.h"
#include "tests/crowd_cases.h"
#include "tests/draw_path.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kSharedTexturesNatively({Subset::kNative}, {"*SharedTextures.*", "SharedImages.*"});

Character ball_of(const Asset& asset) { return compile_character(asset, kExact).expect(); }

class SharedTextures : public testing::TestWithParam<DrawPath> {
protected:
    void SetUp() override {
        if (const std::string reason = undrawable_reason(GetParam()); !reason.empty()) GTEST_SKIP() << reason;
        add_maps(asset_);
        ball_ = ball_of(asset_);
    }
    static bool is_native() { return GetParam() == DrawPath::kNative; }
    static Crowd crowd_of(const Character& ball) {
        Crowd crowd = create({.groups = {{.character = &ball, .instance_count = 1}}});
        EXPECT_TRUE(crowd.update(0));
        return crowd;
    }
    static Renderer renderer() {
        return Renderer::create(test_device(), {.width = 64, .height = 48, .path = GetParam()}).expect();
    }
    static RenderResult drawn(Renderer& renderer, const Crowd& crowd) {
        return renderer.render(crowd, {.eye = {0, 0.5f, 2}, .target = {0, 0.5f, 0}}).expect();
    }
    // Whether the texture, or the picture, of the ball's first image is in use.
    bool has_texture() const {
        SharedValues::Key key = image_key(SharedValue::kNativeTexture, asset_.images[0]);
        key.push_back(1);
        return test_gpu()->values.find<raster::OwnedTexture>(key) != nullptr;
    }
    bool has_picture() const {
        return test_gpu()->values.find<Picture>(image_key(SharedValue::kPicture, asset_.images[0])) != nullptr;
    }
    // Whichever of them the renderer needs.
    bool is_decoded() const { return is_native() ? has_texture() : has_picture(); }

    Asset asset_ = make_ball();
    Character ball_;
};

TEST_P(SharedTextures, GroupsWithTheSameImagesShareTextures) {
    std::vector<std::string> warnings;
    uint64_t room_bytes = kTexturesLimit_bytes;
    const Crowd crowd = create({.groups = {{.character = &ball_, .instance_count = 1}}});
    const Group& group = crowd.state().groups[0];
    if (is_native()) {
        const auto one = native_materials(*test_gpu(), group, warnings, room_bytes);
        const uint64_t taken_bytes = kTexturesLimit_bytes - room_bytes;
        const auto same = native_materials(*test_gpu(), group, warnings, room_bytes);
        EXPECT_EQ(one.all()[0].textures, same.all()[0].textures);
        EXPECT_EQ(kTexturesLimit_bytes - room_bytes, 2 * taken_bytes) << "which textures are white would depend on it";
        TextureAccount account{warnings, room_bytes, test_gpu()->values};
        EXPECT_NE(make_native_texture(*test_gpu(), asset_.images[0], true, account),
                  make_native_texture(*test_gpu(), asset_.images[0], false, account));
    } else {
        SharedValues textures;
        TextureAccount account{warnings, room_bytes, textures};
        Uploads uploads(test_gpu());
        const auto make = [&](size_t image, bool is_color) {
            return make_texture(uploads, asset_.images[image], is_color, account);
        };
        const auto one = make(0, true), same = make(0, true), of_numbers = make(0, false), of_another = make(1, true);
        uploads.finish();
        EXPECT_EQ(one, same);
        EXPECT_NE(one, of_numbers);
        EXPECT_NE(one, of_another);
    }
    EXPECT_TRUE(warnings.empty());
}

TEST_P(SharedTextures, TwoGroupsDrawLikeOne) {
    Renderer one = renderer(), both = renderer();
    const Crowd alone = crowd_of(ball_);
    const Picture wanted = drawn(one, alone).picture;
    Crowd crowd = create(
        {.groups = {{.character = &ball_, .instance_count = 1}, {.character = &ball_, .instance_count = 1}}});
    ASSERT_TRUE(crowd.update(0));
    EXPECT_EQ(drawn(both, crowd).picture.rgba, wanted.rgba);
    EXPECT_EQ(drawn(both, alone).picture.rgba, wanted.rgba);
}

TEST_P(SharedTextures, ImagesMayBeDecodedAhead) {
    const Picture wanted = [&] {
        Renderer other = renderer();
        return drawn(other, crowd_of(ball_)).picture;
    }();
    ASSERT_FALSE(is_decoded()) << "nobody has it any more";
    Crowd crowd = create({.groups = {{.character = &ball_, .instance_count = 1}}});
    ASSERT_TRUE(decode_images(crowd));
    EXPECT_TRUE(is_decoded());
    // Decoded images move along with the group.
    const Character plain = ball_of(make_ball());
    Crowd running = crowd_of(plain);
    const auto added = running.add_groups(std::move(crowd));
    ASSERT_TRUE(added) << refusal(added);
    ASSERT_TRUE(running.remove_group(0));
    ASSERT_TRUE(running.update(0));
    EXPECT_TRUE(is_decoded());
    Renderer drawer = renderer();
    EXPECT_EQ(drawn(drawer, running).picture.rgba, wanted.rgba);
    EXPECT_FALSE(has_picture()) << "it was kept for longer than it was needed";
    EXPECT_EQ(has_texture(), is_native());
}

TEST_P(SharedTextures, AreReusedAfterTheirCrowdIsDestroyed) {
    if (!is_native()) GTEST_SKIP() << "the device's renderers do not tell";
    SharedValues::Key key = image_key(SharedValue::kNativeTexture, asset_.images[0]);
    key.push_back(1);
    Renderer drawer = renderer();
    const auto drawn_with = [&] {
        drawn(drawer, crowd_of(ball_));
        return test_gpu()->values.find<raster::OwnedTexture>(key).get();
    };
    const raster::OwnedTexture* const first = drawn_with();
    ASSERT_TRUE(first);
    EXPECT_EQ(drawn_with(), first);
}

// Nothing is kept for groups that the renderer already has, either.
TEST_P(SharedTextures, ImagesDecodedTooLateAreFreedAtTheNextPicture) {
    Renderer drawer = renderer();
    const Crowd crowd = crowd_of(ball_);
    drawn(drawer, crowd);
    ASSERT_TRUE(decode_images(crowd));
    EXPECT_EQ(has_picture(), !test_gpu()->is_native());
    drawn(drawer, crowd);
    EXPECT_FALSE(has_picture());
}

TEST_P(SharedTextures, UndecodableImagesGiveWarningsWhenDrawn) {
    Asset broken = asset_;
    for (AssetImage& image : broken.images) image.encoded.resize(40);
    const Character ball = ball_of(broken);
    const Crowd crowd = crowd_of(ball);
    ASSERT_TRUE(decode_images(crowd));
    Renderer drawer = renderer();
    EXPECT_EQ(drawn(drawer, crowd).warnings.size(), broken.images.size());
}

TEST(SharedImages, AreKeptOnceForAllGroups) {
    Asset asset = make_ball();
    add_maps(asset);
    const Character ball = ball_of(asset);
    Character renamed = ball, other = ball;
    renamed.images[0].name = "of another name";
    std::swap(other.images[0], other.images[1]);
    const Crowd crowd = create({.groups = {{.character = &ball, .instance_count = 1},
                                           {.character = &renamed, .instance_count = 1},
                                           {.character = &other, .instance_count = 1}}});
    const Crowd again = create({.groups = {{.character = &ball, .instance_count = 1}}});
    const auto& groups = crowd.state().groups;
    EXPECT_EQ(again.state().groups[0].images, groups[0].images);
    ASSERT_EQ(groups[0].images.size(), ball.images.size());
    for (size_t image = 0; image < ball.images.size(); ++image)
        EXPECT_EQ(groups[0].images[image]->encoded, ball.images[image].encoded);
    EXPECT_EQ(groups[1].images[1], groups[0].images[1]);
    EXPECT_EQ(groups[1].images[0]->name, "of another name");
    EXPECT_EQ(groups[2].images[0], groups[0].images[1]);
    EXPECT_EQ(groups[2].images[1], groups[0].images[0]);
}

INSTANTIATE_TEST_SUITE_P(OnPaths, SharedTextures, kBothDrawPaths, name_of_path);

}  // namespace
}  // namespace throng::test
