// What a crowd refuses, with which error, and that a refusal changes nothing: settings, values, moved-from objects.
#include "scan/scan_table.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"

#include <throng/draw.h>

namespace throng {
namespace {

using namespace test;

TEST(Crowd, AScanThatDoesNotApplyIsRefused) {
    const MixedCrowd scaled(0.1);
    for (const ScanMethod& method : scan_table()) {
        if (method.layout == ScanLayout::kCharacterMajor && method.format == ScanFormat::kAffine) continue;
        CrowdSettings settings = scaled.settings;
        settings.scan = method.name;
        const Result<Crowd> crowd = Crowd::create(test_device(), settings);
        ASSERT_FALSE(crowd) << method.name;
        EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported);
        EXPECT_NE(crowd.error().text().find(method.name), std::string::npos) << crowd.error().text();
    }
}

TEST(Crowd, WrongValuesAreRefusedAndChangeNothing) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 4}}});
    Random random(13);
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), random_playbacks(random, character, 4)));
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<Affine> before = skins_of(crowd);

    const Playback good{.first = {.clip = 1, .time_s = 0.5}};
    const auto refused = [&](uint32_t first, const std::vector<Playback>& playbacks, const std::string& says) {
        const Result<void> result = crowd.set_playback(
            Instances::numbered(first, static_cast<uint32_t>(playbacks.size())), playbacks);
        ASSERT_FALSE(result) << says;
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(result.error().text().find(says), std::string::npos) << result.error().text();
    };
    const auto with = [&](auto&& change) {
        Playback playback = good;
        change(playback);
        return std::vector{good, playback};  // the first alone would be taken
    };
    refused(1, with([](Playback& p) { p.first.clip = 3; }),
            "playback of instance 2: clip 3 is out of range: the character has 3");
    refused(1, with([](Playback& p) { p.second.clip = 77; }), "clip 77");
    refused(1, with([](Playback& p) { p.first.time_s = kNan; }), "finite");
    refused(1, with([](Playback& p) { p.second.time_s = kInfinity; }), "finite");
    refused(1, with([](Playback& p) { p.second.speed = static_cast<float>(kNan); }), "finite");
    refused(1, with([](Playback& p) { p.weight = 1.5f; }), "weight");
    refused(1, with([](Playback& p) { p.weight = -0.01f; }), "weight");
    refused(1, with([](Playback& p) { p.weight = static_cast<float>(kNan); }), "weight");
    refused(3, {good, good}, "instances 3 to 4 are out of range: this crowd's instance numbers are below 4");
    refused(5, {}, "instance 5 is out of range: this crowd's instance numbers are below 4");
    refused(0xFFFFFFFF, {good}, "instance 4294967295 is out of range: this crowd's instance numbers are below 4");
    EXPECT_TRUE(crowd.set_playback(Instances::numbered(4, 0), std::vector<Playback>()));

    std::vector<Affine> placement(2);
    placement[1].row[2][3] = static_cast<float>(kNan);
    const Result<void> placed = crowd.set_placement(Instances::numbered(1, 2), placement);
    ASSERT_FALSE(placed);
    EXPECT_NE(placed.error().text().find("instance 2"), std::string::npos) << placed.error().text();
    EXPECT_FALSE(crowd.set_placement(Instances::numbered(3, 2), Affine()));
    EXPECT_FALSE(crowd.update(static_cast<float>(kNan)));
    EXPECT_FALSE(crowd.update(static_cast<float>(-kInfinity)));
    for (const uint32_t instance : {4u, 0xFFFFFFFFu}) {
        EXPECT_FALSE(crowd.read_skin_matrices({instance}));
        EXPECT_FALSE(crowd.read_positions({instance}));
    }

    ASSERT_TRUE(crowd.update(0));
    EXPECT_TRUE(same_bits(skins_of(crowd), before));
    EXPECT_EQ(output<Affine>(crowd.outputs()[0], &OutputBlock::placement, 4), std::vector<Affine>(4));
}

TEST(Crowd, WrongSettingsAreRefused) {
    const Character character = small_character();
    const auto refused = [](const CrowdSettings& settings, const std::vector<std::string>& says) {
        const Result<Crowd> crowd = Crowd::create(test_device(), settings);
        ASSERT_FALSE(crowd);
        EXPECT_EQ(crowd.error().code, ErrorCode::kInvalidArgument);
        for (const std::string& text : says)
            EXPECT_NE(crowd.error().text().find(text), std::string::npos) << crowd.error().text();
    };
    refused({}, {"no instances"});
    refused({.groups = {{&character, 0}}}, {"no instances"});
    refused({.groups = {{nullptr, 1}}}, {"no character"});
    std::vector<std::string> names{"'fast'", "auto"};
    for (const ScanMethodInfo& method : scan_methods()) names.push_back(method.name);
    refused({.groups = {{&character, 1}}, .scan = "fast"}, names);
    EXPECT_TRUE(Crowd::create(test_device(), {.groups = {{&character, 0}, {&character, 1}, {&character, 0}}}));
}

// Such as a number from a file that was cast to an enumeration.
TEST(Crowd, UnknownValuesOfEnumerationsAreRefused) {
    const Character character = small_character();
    for (const int value : {-1, 5, 77}) {
        const auto create_with = [&](const auto& change) {
            CrowdSettings settings{.groups = {{.character = &character, .instance_count = 2, .sockets = {0}}}};
            change(settings);
            return refusal(Crowd::create(test_device(), settings));
        };
        const std::string says = ": " + std::to_string(value) + " is none of its values, which are 0 to ";
        EXPECT_EQ(create_with([&](CrowdSettings& s) { s.skin_format = static_cast<SkinFormat>(value); }),
                  "skin format" + says + "2");
        EXPECT_EQ(create_with([&](CrowdSettings& s) { s.skin_blend = static_cast<SkinBlend>(value); }),
                  "skin blend" + says + "1");
        EXPECT_EQ(create_with([&](CrowdSettings& s) { s.path = static_cast<UpdatePath>(value); }),
                  "update path" + says + "4");
        EXPECT_EQ(create_with([&](CrowdSettings& s) { s.groups[0].socket_space = static_cast<SocketSpace>(value); }),
                  character.name + ": socket space" + says + "1");
        EXPECT_EQ(refusal(Renderer::create(test_device(), {.path = static_cast<DrawPath>(value)})),
                  "renderer: path" + says + "2");
        EXPECT_EQ(refusal(Device::create({.validation = static_cast<Validation>(value)})),
                  "device: validation" + says + "3");

        const Controller controller = direct_layers(1);
        Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1, .controller = &controller}}});
        EXPECT_EQ(refusal(crowd.play(InstanceHandle{0}, 0, LayerPlayback{.fade = static_cast<FadeKind>(value)})),
                  "play of instance 0: the fade is neither of FadeKind");
        EXPECT_EQ(refusal(crowd.set_layer(InstanceHandle{0}, 0, LayerBlend{.mode = static_cast<LayerMode>(value)})),
                  "layer of instance 0: the mode is neither of LayerMode");
    }
}

TEST(Crowd, CharactersWithoutANameAreNamedInErrors) {
    Character character = small_character();
    character.name.clear();
    Crowd crowd = create({.groups = {{&character, 1}}});
    EXPECT_EQ(refusal(crowd.spawn(0, Affine())), "(no name): spawn: CrowdGroup::capacity is not set");
    EXPECT_EQ(refusal(crowd.set_parameter(InstanceHandle{0}, 0, 1.0f)),
              "parameter of instance 0: (no name) has no controller");
    EXPECT_EQ(refusal(crowd.set_target(InstanceHandle{0}, 0, TargetPlace{})),
              "target of instance 0: (no name) has no procedural rules");
}

TEST(Crowd, MoreThanTheDevicesMemoryIsRefused) {
    const Character character = small_character();
    const CrowdSettings fits{.groups = {{.character = &character, .instance_count = 2, .sockets = {0}}}};
    const auto refused = [](const CrowdSettings& settings, const std::string& says) {
        const Result<Crowd> crowd = Crowd::create(test_device(), settings);
        ASSERT_FALSE(crowd);
        EXPECT_EQ(crowd.error().code, ErrorCode::kLimit);
        EXPECT_NE(crowd.error().text().find(says), std::string::npos) << crowd.error().text();
    };
    ASSERT_TRUE(Crowd::create(test_device(), fits));
    CrowdSettings settings = fits;
    settings.groups[0].instance_count = UINT32_MAX;
    refused(settings, "matrices");
    for (uint32_t CrowdSettings::*capacity : {&CrowdSettings::event_capacity, &CrowdSettings::watch_capacity}) {
        settings = fits;
        settings.*capacity = UINT32_MAX;
        refused(settings, "_capacity");
    }
}

// Also if only both together do not fit: the device's buffers, and the data that the host keeps for each instance.
TEST(Crowd, MoreThanTheHostsMemoryIsRefused) {
    if (!test_gpu()->is_native() && !test_gpu()->is_cpu()) GTEST_SKIP() << "the device has memory of its own";
    if (test_gpu()->largest_heap_bytes() >> 40 > 0) GTEST_SKIP() << "more memory than instances can be numbered for";
    const Character character = small_character();
    const auto size_of = [&](uint32_t count) {
        return Crowd::create(test_device(), {.groups = {{&character, count}}}).expect().size_bytes();
    };
    const uint64_t instance_bytes = (size_of(3000) - size_of(1000)) / 2000;
    const auto fit = static_cast<uint32_t>(0.95 * double(test_gpu()->largest_heap_bytes()) / double(instance_bytes));
    const Result<Crowd> crowd = Crowd::create(test_device(), {.groups = {{&character, fit}}});
    ASSERT_FALSE(crowd);
    EXPECT_EQ(crowd.error().code, ErrorCode::kLimit);
}

template <class Value>
void expect_moved_from(const Result<Value>& result) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(result.error().text().find("moved from"), std::string::npos) << result.error().text();
}

TEST(Crowd, CallsOnAMovedFromCrowdFail) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}});
    Device device = test_device();
    const Crowd kept = std::move(crowd);
    const Device kept_device = std::move(device);
    expect_moved_from(crowd.update(0));
    expect_moved_from(crowd.record(VK_NULL_HANDLE, 0));
    expect_moved_from(crowd.discard_last_record());
    expect_moved_from(crowd.set_placement(crowd.instances(), Affine()));
    expect_moved_from(crowd.path(0));
    expect_moved_from(crowd.feedback());
    expect_moved_from(crowd.read_skin_matrices({0}));
    expect_moved_from(crowd.stage_times());
    EXPECT_EQ(crowd.instance_count(), 0u);
    EXPECT_TRUE(crowd.outputs().empty());
    EXPECT_EQ(crowd.size_bytes(), 0u);
    EXPECT_EQ(world_bounds(crowd).max.x, world_bounds(crowd).min.x);
    expect_moved_from(Crowd::create(device, {.groups = {{&character, 1}}}));
    expect_moved_from(Renderer::create(device));
    expect_moved_from(advise_scan(device, character.rig, 1));
    Crowd none;
    EXPECT_NE(refusal(none.update(0)).find("was not made by Crowd::create()"), std::string::npos);
    EXPECT_EQ(none.instances().size(), 0u);
    none = create({.groups = {{&character, 2}}});
    EXPECT_TRUE(none.update(0));
    EXPECT_EQ(device.info().name, "");
    EXPECT_EQ(device.validation_message_count(), 0u);
}

TEST(Crowd, CallsOnAMovedFromRendererFail) {
    const Character character = small_character();
    Crowd crowd = create({.groups = {{&character, 2}}});
    Renderer renderer = *Renderer::create(test_device(), {.width = 16, .height = 16});
    Renderer kept = std::move(renderer);
    expect_moved_from(renderer.render(crowd, {}));
    expect_moved_from(renderer.resize(1, 1));
    EXPECT_EQ(renderer.draw_ms(), 0);
    EXPECT_EQ(renderer.picture(), VkImage{VK_NULL_HANDLE});
    EXPECT_EQ(renderer.options().exposure, DrawOptions().exposure);
    const Crowd kept_crowd = std::move(crowd);
    expect_moved_from(kept.render(crowd, {}));
}

TEST(Crowd, AnUnknownGroupIsRefused) {
    const Character character = small_character();
    const Crowd crowd = create({.groups = {{&character, 1}}});
    for (const uint32_t group : {1u, 99u, kNone}) {
        const Result<GroupPath> path = crowd.path(group);
        ASSERT_FALSE(path);
        EXPECT_EQ(path.error().text(),
                  "crowd: group " + std::to_string(group) + " is out of range: this crowd's group numbers are below 1");
    }
}

TEST(Crowd, ACharacterWithoutJointsIsRefused) {
    const Character nothing;
    const Controller controller = example("walker");
    const auto expect_refused = [](const auto& result) {
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(result.error().text().find("joints"), std::string::npos) << result.error().text();
    };
    expect_refused(Crowd::create(test_device(), {.groups = {{&nothing, 1}}}));
    expect_refused(reference_pose(nothing, {}));
    expect_refused(ReferenceCharacter::create(nothing, controller));
    expect_refused(advise_scan(test_device(), nothing.rig, 1));
}

TEST(Crowd, AViewOfAPictureWithoutPixelsIsRefused) {
    for (const auto& [width, height] : {std::pair(0u, 0u), std::pair(0u, 9u), std::pair(9u, 0u)}) {
        const Result<CrowdView> view = view_of({.eye = {0, 1, 5}, .target = {}}, width, height, {});
        ASSERT_FALSE(view);
        EXPECT_EQ(view.error().text(),
                  "view: the picture is empty: " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    }
}

TEST(Crowd, TheReferenceRefusesWhatTheCrowdRefuses) {
    const Character character = small_character();
    EXPECT_FALSE(reference_pose(character, Playback{.first = {.clip = 3}}));
    EXPECT_FALSE(reference_pose(character, Playback{.weight = 2}));
    EXPECT_TRUE(reference_pose(character, Playback{.first = {.clip = 2}}));
}

}  // namespace
}  // namespace throng
