// Forged crowd states: refused or accepted, but never a crash. On the native device, so that sanitizers check it.
#include "base/crc64.h"
#include "control/controller_io.h"
#include "tests/test_rig.h"

#include <throng/crowd.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace throng::test {
namespace {

Controller controller_of(const Character& character) {
    const auto name = [&](size_t clip) { return character.clips[clip].name; };
    const std::string json = R"({"parameters": {"speed": 0}, "layers": [
        {"name": "a", "states": {"a": {"clip": ")" +
                             name(0) + R"("}, "b": {"clip": ")" + name(1) + R"("}},
         "transitions": [
            {"from": "a", "to": "b", "when": {"speed": {"above": 1}}, "fade_s": 0.3},
            {"from": "b", "to": "a", "when": {"speed": {"below": 1}}, "fade_s": 0.2, "fade": "inertial"}]},
        {"name": "b", "mode": "additive", "weight": 0.5}]})";
    Result<Controller> controller = parse_controller(json, "test");
    EXPECT_TRUE(controller) << controller.error().text();
    return std::move(*controller);
}

void fix_checksum(std::vector<std::byte>& forged) {
    const size_t end = forged.size() - sizeof(uint64_t);
    const uint64_t checksum = crc64(std::span(forged).first(end));
    std::memcpy(forged.data() + end, &checksum, sizeof checksum);
}

// The state with the pending command `waiting` replaced by `other`.
std::vector<std::byte> with_command(std::vector<std::byte> state, const io::ControlCommand& waiting,
                                    const io::ControlCommand& other) {
    const auto found = std::ranges::search(state, std::as_bytes(std::span(&waiting, 1)));
    EXPECT_EQ(found.size(), sizeof waiting);
    std::ranges::copy(std::as_bytes(std::span(&other, 1)), found.begin());
    fix_checksum(state);
    return state;
}

TEST(ForgedState, NeverCrashes) {
    constexpr size_t kHead_bytes = 72;
    const Device device = Device::create({.select = "native"}).value();
    const Character character = make_character({.name = "some", .joint_count = 20});
    const Controller controller = controller_of(character);
    const CrowdSettings settings{
        .groups =
            {{.character = &character, .instance_count = 3, .pose_capacity = 2, .capacity = 5},
             {.character = &character, .instance_count = 3, .controller = &controller, .sockets = {3}, .capacity = 4},
             {.character = &character, .instance_count = 3, .sockets = {2}, .is_carried = true}},
        .culling = Culling{.skips_updates = true}};
    Crowd crowd = Crowd::create(device, settings).value();
    for (int update = 0; update < 4; ++update) {
        ASSERT_TRUE(
            crowd.set_playback(InstanceHandle{1}, {.first = {.clip = 0}, .second = {.clip = 1}, .weight = 0.5f}));
        ASSERT_TRUE(crowd.set_pose(InstanceHandle{2}, std::vector<Trs<float>>(character.rig.rest), 0.3f));
        ASSERT_TRUE(crowd.set_parameter(InstanceHandle{6}, 0, update < 2 ? 2.0f : 0.0f));
        ASSERT_TRUE(crowd.watch(InstanceHandle{6}));
        ASSERT_TRUE(crowd.update(0.1f));
    }
    ASSERT_TRUE(crowd.set_parameter(InstanceHandle{7}, 0, 1.0f));
    ASSERT_TRUE(crowd.attach(InstanceHandle{9}, Attachment{.carrier = {6}}));
    ASSERT_TRUE(crowd.attach(InstanceHandle{10}, Attachment{.carrier = {9}}));
    const std::vector<std::byte> saved = crowd.save_state().value();
    Random random(1);
    uint32_t refused = 0, taken = 0;
    for (int forgery = 0; forgery < 2000; ++forgery) {
        std::vector<std::byte> forged = saved;
        for (uint32_t words = 1 + random.below(24); words > 0; --words) {
            const uint32_t value = random.chance(0.5) ? random.below(300) : static_cast<uint32_t>(random.next());
            // The header is checked separately. Most of the rest is skin matrices, on which nothing depends.
            const auto words_of_all = static_cast<uint32_t>((forged.size() - kHead_bytes - sizeof(uint64_t)) / 4);
            const uint32_t from_end = random.below(random.chance(0.5) ? words_of_all : std::min(words_of_all, 800u));
            const size_t at = kHead_bytes + 4 * size_t{words_of_all - 1 - from_end};
            std::memcpy(forged.data() + at, &value, sizeof value);
        }
        fix_checksum(forged);
        const Result<void> restored = crowd.restore_state(forged);
        ++(restored ? taken : refused);
        EXPECT_TRUE(restored || restored.error().code == ErrorCode::kInvalidFile);
        ASSERT_TRUE(crowd.update(0.1f));
        ASSERT_TRUE(crowd.feedback());
        for (uint32_t instance = 0; instance < crowd.instance_count(); ++instance)
            static_cast<void>(crowd.read_skin_matrices({instance}));
        ASSERT_TRUE(crowd.restore_state(saved));
    }
    EXPECT_GT(refused, 100u);
    EXPECT_GT(taken, 100u);
    EXPECT_TRUE(crowd.save_state().value() == saved);
}

// A group has the data for births and inertial plays only if its settings allow them.
TEST(ForgedState, CommandsThatAGroupDoesNotSupportAreRefused) {
    const Device device = Device::create({.select = "native"}).value();
    const Character character = make_character({.name = "some", .joint_count = 20});
    const Controller controller = controller_of(character);
    constexpr float kValue = 0.8125f;
    const auto restored = [&](uint32_t capacity, const io::ControlCommand& waiting, uint32_t kind) {
        Crowd crowd = Crowd::create(device, {.groups = {{.character = &character,
                                                         .instance_count = 3,
                                                         .controller = &controller,
                                                         .capacity = capacity}}})
                          .value();
        EXPECT_TRUE(crowd.set_parameter(InstanceHandle{1}, 0, kValue));
        EXPECT_TRUE(crowd.play(InstanceHandle{2}, 1, {.clip = {.clip = 0, .speed = kValue}, .fade_s = 0.5f}));
        io::ControlCommand other = waiting;
        other.kind = kind;
        const Result<void> done = crowd.restore_state(with_command(crowd.save_state().value(), waiting, other));
        return done ? std::string() : done.error().text();
    };
    const io::ControlCommand set{.instance = 1, .kind = io::kCommandParameter, .target = 0, .value = kValue};
    const io::ControlCommand played{.instance = 2,
                                    .kind = io::kCommandPlay,
                                    .target = 1,
                                    .motion = 0,
                                    .phase = 0,
                                    .loop = 1,
                                    .value = kValue,
                                    .fade_rate = 2};
    EXPECT_EQ(restored(0, set, io::kCommandBegin),
              "crowd state: an instance is spawned in a group without CrowdGroup::capacity");
    EXPECT_EQ(restored(4, set, io::kCommandBegin), "");
    EXPECT_EQ(restored(0, played, io::kCommandPlayInertial),
              "crowd state: a command is for a layer that does not exist or does not take it");
    EXPECT_EQ(restored(0, played, io::kCommandPlay), "");
}

}  // namespace
}  // namespace throng::test
