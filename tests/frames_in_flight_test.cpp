// Frames in flight: each frame slot keeps the outputs of its update until the slot is used again.
#include "tests/ball.h"
#include "tests/contents.h"
#include "tests/lively_crowd.h"
#include "tests/picture_copy.h"
#include "tests/recorder.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <deque>
#include <list>
#include <set>

namespace throng::test {
namespace {

class FramesInFlight : public testing::Test {
protected:
    CrowdSettings settings(bool culls) const {
        CrowdSettings made{.path = UpdatePath::kDevice,
                           .keep_model_matrices = !culls,
                           .keep_previous_matrices = true,
                           .culling = culls ? std::optional(Culling{.skips_updates = true}) : std::nullopt};
        made.skins_once = true;
        made.groups = {{.character = &character_, .instance_count = 9, .pose_capacity = 4},
                       {.character = &walker_, .instance_count = 7, .controller = &controller_, .sockets = {3, 7}},
                       {.character = &character_, .instance_count = 5, .procedural = &rules_}};
        return made;
    }
    // Features that the crowds of settings() lack: skin pools, morphs, outfits, root motion, targets, agents.
    CrowdSettings other_settings() const {
        CrowdSettings made{.path = UpdatePath::kDevice, .culling = Culling{}};
        made.groups = {{.character = &morphing_,
                        .instance_count = 9,
                        .skin_pool = SkinPool{.capacity = 4},
                        .morph_limit = 2,
                        .outfits = {{}, {}}},
                       {.character = &walking_, .instance_count = 4, .controller = &walking_controller_},
                       {.character = &character_, .instance_count = 5, .procedural = &looking_},
                       {.character = &character_, .instance_count = 3, .steering = Steering{.speed = 3}}};
        return made;
    }
    // For a crowd with other_settings().
    void change(Crowd& crowd, int frame) const {
        const auto number = static_cast<uint32_t>(frame);
        const auto x = static_cast<float>(frame);
        EXPECT_TRUE(crowd.set_playback(InstanceHandle{number % 9}, {.first = {.clip = number % 3, .time_s = 0.1 * x}}));
        EXPECT_TRUE(crowd.set_look(Instances::numbered(0, 9), {.tint = {x, 1, 1}, .outfit = number % 2}));
        EXPECT_TRUE(crowd.set_parameter(Instances::numbered(9, 4), 0, x));
        EXPECT_TRUE(crowd.set_target(Instances::numbered(13, 5), 0, {.world_place = {x, 2, 0}}));
        EXPECT_TRUE(crowd.set_destination(Instances::numbered(18, 3), {9 * x, 0, 0}));
    }
    void set(Crowd& crowd) const {
        std::vector<Affine> places;
        for (uint32_t i = 0; i < crowd.instance_count(); ++i)
            places.push_back(to_affine(
                Trs<float>{.translation = Vec3<float>{float(i % 6), 0, float(i / 6)} * (2 * character_.size)}));
        EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
        EXPECT_TRUE(crowd.set_playback(Instances::numbered(0, 9), Playback{.first = {.clip = 0, .time_s = 0.2}}));
        EXPECT_TRUE(crowd.set_wind({.velocity = {3, 0, 1}}));
    }
    CrowdView view(int frame) const {
        const float size = character_.size, around = 0.7f * static_cast<float>(frame);
        return *view_of({.eye = Vec3<float>{6 + 9 * std::cos(around), 3, 3 + 9 * std::sin(around)} * size,
                         .target = Vec3<float>{6, 1, 3} * size},
                        320, 200, {}, {.full_rate_pixels = 100});
    }

    Character character_ = creature(30, 10), walker_ = creature(40, 8), walking_ = walking_creature(),
              morphing_ = make_character({.scale_spread = 0, .morph_count = 3});
    Controller controller_ = example("dragon"), walking_controller_ = example("walker");
    ProceduralRules rules_{.rules = {WindRule{.joint = character_.rig.names[1]}}},
        looking_{.targets = {"there"}, .rules = {LookAtRule{.joint = character_.rig.names.back(), .target = "there"}}};
};

// Until it is written again, every slot holds what a crowd without frames in flight has after the same update. A
// discarded record changes no slot.
TEST_F(FramesInFlight, EachSlotKeepsItsOutputs) {
    std::set<std::string> differed;
    enum class Kind { kAnimatesAll, kCulls, kOther };
    for (const auto& [kind, in_flight] :
         {std::pair{Kind::kAnimatesAll, 2u}, {Kind::kCulls, 1u}, {Kind::kCulls, 4u}, {Kind::kOther, 3u}}) {
        CrowdSettings of = kind == Kind::kOther ? other_settings() : settings(kind == Kind::kCulls);
        std::list<Character> without_levels;  // crowds that do not cull leave the levels' skinned vertices unwritten
        if (!of.culling)
            for (CrowdGroup& group : of.groups) {
                Character& character = without_levels.emplace_back(*group.character);
                if (character.sections.size() != 1) continue;
                MeshSection& section = character.sections[0];
                section.vertex_count -= std::exchange(section.lod_vertex_count, 0);
                character.vertices.resize(section.vertex_count);
                character.influences.resize(size_t{section.vertex_count} * section.influence_sets);
                character.lods.clear(), character.lod_ranges.clear(), character.lod_indices.clear();
                character.joint_lods.clear();
                group.character = &character;
            }
        Crowd one = create(of);
        of.frames_in_flight = in_flight;
        Crowd crowd = create(of);
        const uint32_t more = of.keep_previous_matrices ? 1 : 0;  // one slot for the update before the oldest
        ASSERT_EQ(crowd.frame_slot_count(), in_flight + more);
        EXPECT_TRUE(crowd.outputs(crowd.frame_slot_count()).empty());
        set(one);
        set(crowd);
        std::deque<std::pair<uint32_t, Contents>> expected;  // per slot, the newest last
        for (int frame = 0; frame < 10; ++frame) {
            SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + ", in flight " + std::to_string(in_flight) +
                         ", frame " + std::to_string(frame));
            if (kind == Kind::kOther)
                for (Crowd* const each : {&one, &crowd}) change(*each, frame);
            const CrowdView view_of_frame = view(frame), *const seen = of.culling ? &view_of_frame : nullptr;
            ASSERT_TRUE(one.update(0.05f, seen));
            if (test_gpu()->is_native() || frame % 3 != 1) {
                ASSERT_TRUE(crowd.update(0.05f, seen));
            } else {
                Recorder recorder;
                recorder.record([&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 0.3f)); });
                EXPECT_TRUE(crowd.discard_last_record());
                recorder.submit(recorder.record(
                    [&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record(commands, 0.05f, seen)); }));
            }
            EXPECT_EQ(crowd.outputs().data(), crowd.outputs(crowd.frame_slot()).data());
            expect_same(contents_of(one.outputs()), contents_of(crowd.outputs()), "the newest");
            expected.emplace_back(crowd.frame_slot(), contents_of(one.outputs(), false));
            if (expected.size() > in_flight) expected.pop_front();
            for (const auto& [slot, contents] : expected)
                expect_same(contents, contents_of(crowd.outputs(slot), false), "slot " + std::to_string(slot));
            for (const auto& [name, bytes] : expected.front().second) {
                const auto newest = expected.back().second.find(name);
                if (newest != expected.back().second.end() && newest->second != bytes)
                    differed.insert(name.substr(name.find(' ') + 1));
            }
        }
    }
    std::set<std::string> all{"list", "skin row"};
    if (!test_gpu()->is_native()) all.insert("draw");
    for (const Output& output : kOutputs)
        if (output.is_in_slots) all.insert(output.name);
    EXPECT_EQ(differed, all) << "what is not the same in two slots, in one of the crowds";
}

TEST_F(FramesInFlight, BufferViewsGiveTheOffsetsOfTheirEntries) {
    CrowdSettings of = settings(true);
    of.frames_in_flight = 2;
    Crowd crowd = create(of);
    const OutputBlock& block = crowd.outputs(1)[1];
    if (test_gpu()->is_native()) {
        EXPECT_FALSE(block.skin);
        EXPECT_EQ(block.host.skin.size(), block.instance_count * block.palette_count * sizeof(Affine));
        EXPECT_NE(block.host.skin.data(), crowd.outputs(0)[1].host.skin.data());
        EXPECT_NE(block.host.placement.data(), crowd.outputs(0)[1].host.placement.data());
        EXPECT_EQ(block.host.parameter.data(), crowd.outputs(0)[1].host.parameter.data());
        return;
    }
    EXPECT_EQ(block.skin.stride_bytes, block.palette_count * sizeof(Affine));
    EXPECT_EQ(block.skin.size_bytes, block.instance_count * block.skin.stride_bytes);
    EXPECT_EQ(block.skin.buffer, crowd.outputs(2)[1].previous_skin.buffer);
    EXPECT_EQ(block.socket.stride_bytes, 2 * sizeof(Affine));
    EXPECT_EQ(block.list.size_bytes, (5 + block.instance_count) * sizeof(uint32_t));
    EXPECT_EQ(block.draw.size_bytes, walker_.sections.size() * 4 * sizeof(VkDrawIndexedIndirectCommand));
    EXPECT_EQ(block.parameter.buffer, crowd.outputs(0)[1].parameter.buffer);
    EXPECT_NE(block.placement.buffer, crowd.outputs(0)[1].placement.buffer);
    EXPECT_FALSE(block.target);
    EXPECT_FALSE(block.model);
}

TEST_F(FramesInFlight, InvalidCountsAreRefused) {
    for (const uint32_t wrong : {0u, 5u, ~0u}) {
        CrowdSettings of = settings(false);
        of.frames_in_flight = wrong;
        const Result<Crowd> refused = Crowd::create(test_device(), of);
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().text().find(std::to_string(wrong) + " is not within 1..4"), std::string::npos);
    }
    EXPECT_TRUE(Crowd().outputs(0).empty());
    EXPECT_EQ(Crowd().frame_slot_count(), 0u);
}

// Several frames' pictures in one command buffer equal those without frames in flight. Synchronization validation
// checks that drawing does not read what the next update writes.
TEST_F(FramesInFlight, AreDrawnFromTheirSlots) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    for (const bool culls : {false, true}) {
        std::vector<std::vector<uint8_t>> pictures;
        for (const uint32_t in_flight : {1u, 2u}) {
            CrowdSettings of = settings(culls);
            of.frames_in_flight = in_flight;
            of.keep_previous_matrices = false;  // else updates write those of new instances beside the drawn ones
            Crowd crowd = create(of);
            set(crowd);
            Renderer renderer =
                Renderer::create(test_device(), {.width = 160, .height = 100, .path = DrawPath::kDevice}).value();
            const Vec3<float> eye{6, 4, 14}, target{6, 1, 3};
            const Camera camera{.eye = eye * character_.size, .target = target * character_.size};
            for (int submission = 0; submission < 2; ++submission) {
                Recorder recorder;
                recorder.submit(recorder.record([&](VkCommandBuffer commands) {
                    for (int frame = 0; frame < 3; ++frame) {
                        const Result<void> recorded = renderer.record(commands, crowd, 0.05f, camera);
                        EXPECT_TRUE(recorded) << recorded.error().text();
                    }
                }));
            }
            pictures.push_back(renderer.render(crowd, camera)->picture.rgba);
        }
        EXPECT_EQ(pictures[0], pictures[1]);
        EXPECT_GT(std::set<uint8_t>(pictures[0].begin(), pictures[0].end()).size(), 20u) << "something is drawn";
    }
}

// prepare() makes all that drawing a crowd needs. The first picture then creates no pipeline and submits nothing.
TEST_F(FramesInFlight, APreparedRendererIsReadyToDraw) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    Crowd crowd = create(settings(true));
    set(crowd);
    Renderer renderer =
        Renderer::create(test_device(), {.width = 160, .height = 100, .path = DrawPath::kDevice}).value();
    ASSERT_TRUE(renderer.prepare(crowd));
    ASSERT_TRUE(test_device().warm_up());  // for a software device: the kernels of the recorded update
    const auto& counts = test_gpu()->counts;
    const uint64_t submissions = counts.submissions, pipelines = counts.pipelines;
    Recorder recorder;
    recorder.submit(recorder.record([&](VkCommandBuffer commands) {
        EXPECT_TRUE(renderer.record(commands, crowd, 0.05f, {.eye = {6, 4, 14}}));
    }));
    EXPECT_EQ(counts.submissions, submissions);
    EXPECT_EQ(counts.pipelines, pipelines);
    EXPECT_FALSE(renderer.prepare(Crowd()));
}

// Textures are uploaded by the frames that draw them, however many of those are dropped, and by several crowds' frames
// in flight; nothing submits but the application.
TEST_F(FramesInFlight, RecordedFramesUploadTexturesEvenIfSomeAreDropped) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    Asset ball = make_ball();
    ball.images.push_back({.name = "gradient", .encoded = png_bytes(gradient(64, 64))});
    ball.materials[0].image = 0;
    const Character character = compile_character(ball, {.lods = false}).value();
    const Camera camera{.eye = {0, 1, 4}, .target = {0, 0.5f, 0}};
    const RendererSettings pixels{.width = 96, .height = 64, .path = DrawPath::kDevice};
    const auto crowd_of_one = [&] { return create({.groups = {{.character = &character, .instance_count = 1}}}); };
    Renderer other = Renderer::create(test_device(), pixels).value();
    Crowd alone = crowd_of_one();
    const Picture wanted = other.render_frame(alone, 0, camera).value().picture;
    for (const bool prepared : {false, true}) {
        SCOPED_TRACE(prepared);
        Renderer renderer = Renderer::create(test_device(), pixels).value();
        Recorder recorder;
        const uint64_t submissions = test_gpu()->counts.submissions;
        {
            Crowd gone = crowd_of_one();
            ASSERT_TRUE(!prepared || renderer.prepare(gone));
            recorder.record([&](VkCommandBuffer into) { EXPECT_TRUE(renderer.record(into, gone, 0, camera)); });
        }
        Crowd crowd = crowd_of_one();
        ASSERT_TRUE(!prepared || renderer.prepare(crowd));
        std::vector<PictureCopy> shown;
        for (int frame = 0; frame < 12; ++frame) {
            const bool is_submitted = frame % 3 == 1;
            const VkCommandBuffer commands = recorder.record([&](VkCommandBuffer into) {
                EXPECT_TRUE(renderer.record(into, crowd, 0, camera));
                if (is_submitted) shown.emplace_back(pixels.width, pixels.height).record(into, renderer);
            });
            if (is_submitted)
                recorder.submit(commands);
            else
                EXPECT_TRUE(crowd.discard_last_record());
        }
        EXPECT_EQ(test_gpu()->counts.submissions, submissions);
        test_gpu()->wait_idle();
        for (const PictureCopy& one : shown) EXPECT_EQ(one.picture().rgba, wanted.rgba);
    }
}

}  // namespace
}  // namespace throng::test
