// The initial contents of a crowd's buffers and when they are uploaded: creating a crowd submits nothing.
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/recorder.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace throng::test {
namespace {

// Groups that differ in what they upload.
class Cast {
public:
    Crowd make(UpdatePath path = UpdatePath::kDevice) const {
        Crowd crowd = create({.groups = {{.character = &character_, .instance_count = 5, .pose_capacity = 2},
                                         {.character = &character_,
                                          .instance_count = 3,
                                          .controller = &controller_,
                                          .sockets = {3},
                                          .steering = Steering{},
                                          .capacity = 6},
                                         {.character = &other_, .instance_count = 4, .procedural = &rules_}},
                              .path = path,
                              .culling = Culling{}});
        EXPECT_TRUE(crowd.set_playback(Instances::numbered(0, 5), Playback{.first = {.clip = 0, .time_s = 0.3f}}));
        EXPECT_TRUE(crowd.set_placement(Instances::numbered(1, 2), to_affine(Trs<float>{.translation = {1, 0, 2}})));
        EXPECT_TRUE(crowd.set_wind({.velocity = {3, 0, 1}}));
        return crowd;
    }
    // Whatever calls came before, the result equals that of a crowd after `updates` updates.
    void expect_as_updated(Crowd& crowd, int updates = 1) const {
        Crowd updated = make();
        for (int i = 0; i < updates; ++i) EXPECT_TRUE(updated.update(kStep_s));
        EXPECT_TRUE(same_bits(skins_of(crowd), skins_of(updated)));
        EXPECT_EQ(drawn_of(crowd).size(), drawn_of(updated).size());
    }

    static constexpr float kStep_s = 0.1f;

private:
    Character character_ = creature(30, 10), other_ = creature(25, 6);
    Controller controller_ = example("dragon");
    ProceduralRules rules_{.rules = {WindRule{.joint = other_.rig.names[1]}}};
};

uint64_t submissions() { return test_gpu()->counts.submissions; }

TEST(FirstUploads, AreSubmittedWithTheFirstUpdate) {
    const Cast cast;
    for (const UpdatePath path : {UpdatePath::kDevice, UpdatePath::kAuto}) {
        const uint64_t before = submissions();
        Crowd crowd = cast.make(path);
        EXPECT_EQ(submissions(), before);
        ASSERT_TRUE(crowd.update(Cast::kStep_s));
        EXPECT_LE(submissions(), before + 1);
    }
    Crowd crowd = cast.make();
    ASSERT_TRUE(crowd.update(Cast::kStep_s));
    cast.expect_as_updated(crowd);
}

TEST(FirstUploads, CanBeRecordedBeforeTheFirstUpdate) {
    const Cast cast;
    Recorder recorder;
    for (const bool together : {false, true}) {
        Crowd crowd = cast.make();
        VkCommandBuffer first = recorder.record([&](VkCommandBuffer commands) {
            EXPECT_TRUE(crowd.record_uploads(commands));
            EXPECT_TRUE(crowd.record_uploads(commands)) << "again, and nothing happens";
            if (!together) return;
            EXPECT_TRUE(crowd.record(commands, Cast::kStep_s));
        });
        recorder.submit(first);
        if (!together)
            recorder.submit(
                recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, Cast::kStep_s)); }));
        cast.expect_as_updated(crowd);
    }
    Crowd crowd = cast.make();
    EXPECT_FALSE(crowd.record_uploads(VK_NULL_HANDLE));
}

TEST(FirstUploads, OfADiscardedUpdateAreRepeatedByTheNext) {
    const Cast cast;
    Recorder recorder;
    for (const bool recorded_before : {false, true}) {
        Crowd crowd = cast.make();
        if (recorded_before)
            recorder.submit(
                recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record_uploads(commands)); }));
        for (int i = 0; i < 3; ++i) {
            recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, Cast::kStep_s)); });
            EXPECT_TRUE(crowd.discard_last_record());
        }
        // The second update must not upload the initial contents again.
        for (int i = 0; i < 2; ++i)
            recorder.submit(
                recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, Cast::kStep_s)); }));
        recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, Cast::kStep_s)); });
        EXPECT_TRUE(crowd.discard_last_record());
        ASSERT_TRUE(crowd.update(Cast::kStep_s));
        cast.expect_as_updated(crowd, 3);
    }
}

// As when a window is closed before its commands are submitted. Neither this crowd nor a later one, which shares its
// tables, may treat the dropped uploads as done.
TEST(FirstUploads, OfDroppedCommandsAreRepeatedByTheNextUpdate) {
    const Cast cast;
    const auto skins_after_one = [&] {  // this crowd shares no tables: it is destroyed before the next one is created
        Crowd crowd = cast.make();
        EXPECT_TRUE(crowd.update(Cast::kStep_s));
        return skins_of(crowd);
    };
    const auto expected = skins_after_one();
    Recorder recorder;
    for (const bool with_update : {true, false}) {
        Crowd crowd = cast.make();
        recorder.record([&](VkCommandBuffer commands) {
            EXPECT_TRUE(crowd.record_uploads(commands));
            EXPECT_TRUE(!with_update || crowd.record(commands, Cast::kStep_s));
        });
        if (with_update)
            EXPECT_TRUE(crowd.discard_last_record());
        else
            recorder.submit(
                recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record_uploads(commands)); }));
        ASSERT_TRUE(crowd.update(Cast::kStep_s));
        EXPECT_TRUE(same_bits(skins_of(crowd), expected));
        EXPECT_TRUE(same_bits(skins_after_one(), expected));
    }
}

// The initial contents must not overwrite a restored state: neither by their own commands that are recorded again, nor
// with the next update after a discarded one.
TEST(FirstUploads, DoNotOverwriteARestoredState) {
    const Cast cast;
    Crowd updated = cast.make();
    ASSERT_TRUE(updated.update(Cast::kStep_s));
    const std::vector<std::byte> saved = *updated.save_state();
    ASSERT_TRUE(updated.update(Cast::kStep_s));
    Recorder recorder;
    for (const bool discards : {false, true}) {
        Crowd crowd = cast.make();
        recorder.submit(
            recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record_uploads(commands)); }));
        ASSERT_TRUE(crowd.restore_state(saved));
        if (discards) {
            recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, Cast::kStep_s)); });
            EXPECT_TRUE(crowd.discard_last_record());
        } else {
            recorder.submit(
                recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record_uploads(commands)); }));
        }
        ASSERT_TRUE(crowd.update(Cast::kStep_s));
        EXPECT_TRUE(same_bits(skins_of(crowd), skins_of(updated)));
    }
}

// Before its first update a crowd can be drawn, which shows no instances, and saved. There are no matrices to read.
TEST(FirstUploads, AllowDrawingAndSavingBeforeTheFirstUpdate) {
    const Cast cast;
    Crowd listed = cast.make();
    EXPECT_TRUE(drawn_of(listed).empty());
    Crowd read = cast.make();
    EXPECT_FALSE(read.read_positions(InstanceHandle{0}));
    EXPECT_TRUE(read.save_state());
    ASSERT_TRUE(read.update(Cast::kStep_s));
    cast.expect_as_updated(read);
    for (const auto path : {DrawPath::kDevice, DrawPath::kAuto}) {
        Crowd drawn = cast.make();
        Renderer renderer = Renderer::create(test_device(), {.width = 64, .height = 36, .path = path}).value();
        const Result<RenderResult> picture = renderer.render(drawn, {.eye = {0, 2, 9}, .target = {}});
        EXPECT_TRUE(picture) << picture.error().text();
        ASSERT_TRUE(drawn.update(Cast::kStep_s));
        cast.expect_as_updated(drawn);
    }
}

VkBuffer tracks_of(Crowd& crowd, uint32_t group = 0) { return crowd.state().groups[group][io::kTracksBuffer].handle(); }

TEST(FirstUploads, OfOneCharactersTablesAreMadeOnce) {
    const Cast cast;
    std::optional<Crowd> first(cast.make());
    EXPECT_EQ(tracks_of(*first, 0), tracks_of(*first, 1)) << "groups of one character";
    EXPECT_NE(tracks_of(*first, 0), tracks_of(*first, 2));
    Crowd early = cast.make();
    EXPECT_NE(tracks_of(*first), tracks_of(early)) << "which may run before the first has brought its tables";
    ASSERT_TRUE(first->update(Cast::kStep_s));
    Crowd late = cast.make();
    EXPECT_EQ(tracks_of(*first), tracks_of(late));
    EXPECT_NE(late.state().groups[0][io::kTracksBuffer].handle(), VkBuffer{VK_NULL_HANDLE});
    for (size_t batch = 0; batch < late.state().batches.size(); ++batch)
        EXPECT_NE(late.state().batches[batch][io::kPlacementsBuffer].handle(),
                  first->state().batches[batch][io::kPlacementsBuffer].handle());
    first.reset();
    ASSERT_TRUE(late.update(Cast::kStep_s));
    cast.expect_as_updated(late);
    cast.expect_as_updated(late);  // its twin shares the tables of a destroyed crowd
    ASSERT_TRUE(early.update(Cast::kStep_s));
    cast.expect_as_updated(early);
}

TEST(FirstUploads, OfAnEditedCharacterAreNotShared) {
    Character character = creature(30, 10);
    const auto make = [&] { return create({.groups = {{&character, 1}}, .path = UpdatePath::kDevice}); };
    Crowd before = make();
    ASSERT_TRUE(before.update(0));
    for (Trs<float>& rest : character.rig.rest) rest.translation.x += 1;
    for (float& time_s : character.times_s) time_s *= 0.5f;
    Crowd after = make();
    ASSERT_TRUE(after.update(0.05f));
    ASSERT_TRUE(before.update(0.1f));
    EXPECT_NE(before.state().groups[0][io::kTimesBuffer].handle(), after.state().groups[0][io::kTimesBuffer].handle());
}

// As in a game that loads while it draws, without locking.
TEST(FirstUploads, CrowdsAreMadeWhileOthersAreUpdated) {
    const Cast cast;
    Crowd crowd = cast.make();
    std::vector<Crowd> made;
    std::atomic<bool> done = false;
    std::thread maker([&] {
        for (int i = 0; i < 6; ++i) made.push_back(cast.make());
        done = true;
    });
    int updates = 0;
    for (; !done || updates < 3; ++updates) EXPECT_TRUE(crowd.update(Cast::kStep_s));
    maker.join();
    cast.expect_as_updated(crowd, updates);
    for (Crowd& other : made) {
        ASSERT_TRUE(other.update(Cast::kStep_s));
        cast.expect_as_updated(other);
    }
}

}  // namespace
}  // namespace throng::test
