// While a recorded update has neither run nor been discarded, calls that depend on it return an error.
#include "tests/crowd_cases.h"
#include "tests/recorder.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <string>

namespace throng::test {
namespace {

TEST(PendingUpdates, AreNotRead) {
    const Character character = creature(20, 8);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 4}}});
    Recorder recorder;
    EXPECT_NE(refusal(crowd.read_skin_matrices(InstanceHandle{0})).find("read-back: no update has written results of "),
              std::string::npos);
    for (const bool runs : {true, false}) {
        const VkCommandBuffer commands = recorder.record(
            [&](VkCommandBuffer into) { EXPECT_TRUE(crowd.record(into, 0.1f)); });
        const std::string why =
            "the commands of the last record() have not run: submit them, or call "
            "discard_last_record()";
        EXPECT_EQ(refusal(crowd.read_skin_matrices(InstanceHandle{0})), "read-back: " + why);
        EXPECT_EQ(refusal(crowd.read_positions(InstanceHandle{0})), "read-back: " + why);
        EXPECT_EQ(refusal(crowd.save_state()), "crowd state: " + why);
        EXPECT_EQ(refusal(crowd.restore_state({})), "crowd state: " + why);
        if (runs) {
            recorder.submit(commands);
        } else {
            EXPECT_EQ(refusal(crowd.discard_last_record()), "");
        }
        EXPECT_EQ(refusal(crowd.save_state()), "");
        EXPECT_EQ(refusal(crowd.read_skin_matrices(InstanceHandle{0})), "");
        EXPECT_EQ(refusal(crowd.discard_last_record()),
                  runs ? "discard: the commands of the last record() have run"
                       : "discard: there is no record() to discard, or it has been discarded, or an update() has run "
                         "or groups have changed since");
    }
}

// Adding and removing groups in between does not make a pending update count as run.
TEST(PendingUpdates, AreNotSavedAfterAddingGroups) {
    const Character character = creature(20, 8);
    const CrowdSettings settings{.groups = {{.character = &character, .instance_count = 1}},
                                 .path = UpdatePath::kDevice};
    Crowd crowd = create(settings);
    ASSERT_TRUE(crowd.update(0.1f));
    Recorder recorder;
    const VkCommandBuffer commands = recorder.record(
        [&](VkCommandBuffer into) { EXPECT_TRUE(crowd.record(into, 0.1f)); });
    const std::string why =
        "crowd state: the commands of the last record() have not run: submit them, or record and submit an update "
        "after it";
    const auto added = crowd.add_groups(create(settings));
    ASSERT_TRUE(added) << refusal(added);
    EXPECT_EQ(refusal(crowd.save_state()), why);
    ASSERT_TRUE(crowd.remove_group(added->front()));
    EXPECT_EQ(refusal(crowd.save_state()), why);
    recorder.submit(commands);
    EXPECT_EQ(refusal(crowd.save_state()), "");
}

// Discarding one update does not hide that the one before it is pending.
TEST(PendingUpdates, AreNotSavedAfterADiscard) {
    const Character character = creature(20, 8);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1}}, .path = UpdatePath::kDevice});
    ASSERT_TRUE(crowd.update(0.1f));
    Recorder recorder;
    const auto record = [&](VkCommandBuffer into) { EXPECT_TRUE(crowd.record(into, 0.1f)); };
    const VkCommandBuffer commands = recorder.record(record);
    recorder.record(record);
    ASSERT_TRUE(crowd.discard_last_record());
    EXPECT_NE(refusal(crowd.save_state()).find("have not run"), std::string::npos);
    recorder.submit(commands);
    EXPECT_EQ(refusal(crowd.save_state()), "");
}

// A pending update is not drawn either. Once it has been submitted, it can be drawn at once.
TEST(PendingUpdates, AreNotDrawn) {
    const Character character = creature(20, 8);
    const Camera camera{.eye = {0, 0, 3 * character.size}, .target = {0, 0, 0}};
    for (const DrawPath path : {DrawPath::kAuto, DrawPath::kDevice}) {
        const RendererSettings settings{.width = 64, .height = 64, .path = path};
        Result<Renderer> first = Renderer::create(test_device(), settings);
        if (!first) GTEST_SKIP() << first.error().text();
        Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1}}, .path = UpdatePath::kDevice});
        Recorder recorder;
        const VkCommandBuffer commands = recorder.record(
            [&](VkCommandBuffer into) { EXPECT_TRUE(crowd.record(into, 0.1f)); });
        EXPECT_EQ(refusal(first->render(crowd, camera)),
                  "render: the commands of the last record() have not run: submit them, or call discard_last_record()");
        recorder.submit(commands);
        const Result<RenderResult> picture = first->render(crowd, camera);
        ASSERT_TRUE(picture) << picture.error().text();
        Renderer later = Renderer::create(test_device(), settings).value();
        EXPECT_EQ(picture->picture.rgba, later.render(crowd, camera)->picture.rgba);
        Crowd moved = create({.groups = {{.character = &character, .instance_count = 1}}, .path = UpdatePath::kDevice});
        EXPECT_TRUE(
            moved.set_placement(InstanceHandle{0}, to_affine(Trs<double>{.translation = {0, 1e6, 0}}).as<float>()));
        EXPECT_TRUE(moved.update(0.1f));
        EXPECT_NE(picture->picture.rgba, later.render(moved, camera)->picture.rgba) << "something is seen";
    }
}

// More pending updates than the crowd keeps track of. The crowd has no feedback, which would refuse the fifth.
TEST(PendingUpdates, TheLastOfManyIsNotRead) {
    const Character character = creature(20, 8);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2}}});
    ASSERT_TRUE(crowd.update(0.1f));
    Recorder recorder;
    for (int frame = 0; frame < 100; ++frame)
        recorder.record([&](VkCommandBuffer commands) { EXPECT_EQ(refusal(crowd.record(commands, 0.1f)), ""); });
    EXPECT_FALSE(crowd.read_skin_matrices(InstanceHandle{0}));
    EXPECT_EQ(refusal(crowd.discard_last_record()), "");
    EXPECT_FALSE(crowd.read_skin_matrices(InstanceHandle{0})) << "those before it have not run either";
    recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 0.1f)); });
    EXPECT_EQ(refusal(crowd.update(0.1f)), "") << "which takes it for dropped";
    EXPECT_EQ(refusal(crowd.read_skin_matrices(InstanceHandle{0})), "");
}

}  // namespace
}  // namespace throng::test
