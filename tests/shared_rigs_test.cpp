// Tables computed from characters: shared by all crowds of a device, and computed anew if anything in the character
// differs.
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <chrono>

namespace throng::test {
namespace {

const InSubset kSharedRigsNatively({Subset::kNative}, {"SharedRigs.*"});

class SharedRigs : public testing::Test {
protected:
    struct Made {
        const void *native, *rows;
        bool operator==(const Made&) const = default;
    };
    static CrowdSettings settings_of(const Character& character, std::vector<uint32_t> sockets = {}) {
        const bool is_native = test_gpu()->is_native();
        return {.groups = {{.character = &character, .instance_count = 2, .sockets = std::move(sockets)}},
                .path = is_native ? UpdatePath::kAuto : UpdatePath::kFused,
                .scan = is_native ? "auto" : "stream"};
    }
    static Crowd crowd_of(const Character& character, std::vector<uint32_t> sockets = {}) {
        return create(settings_of(character, std::move(sockets)));
    }
    static Made made(const Crowd& crowd) {
        const Group& group = crowd.state().groups[0];
        return {group.fused[0].native.get(), group.rows.get()};
    }

    const Character character_ = creature();
};

TEST_F(SharedRigs, CrowdsOfADeviceShareEqualRigs) {
    const Crowd first = crowd_of(character_);
    ASSERT_TRUE(made(first).native || made(first).rows);
    const Character same = character_;
    EXPECT_EQ(made(first), made(crowd_of(character_)));
    EXPECT_EQ(made(first), made(crowd_of(same)));
    CrowdSettings of_two = settings_of(same);
    of_two.groups.push_back(settings_of(character_).groups[0]);
    const Crowd two = create(of_two);
    EXPECT_EQ(made(first), made(two));
    EXPECT_EQ(two.state().groups[0].rows, two.state().groups[1].rows);
}

TEST_F(SharedRigs, DifferentRigsAreNotShared) {
    const Crowd first = crowd_of(character_);
    const auto differs = [&](const auto& change) {
        Character other = character_;
        change(other);
        return !(made(crowd_of(other)) == made(first));
    };
    EXPECT_FALSE(differs([](Character& of) { of.name = "another name"; }));
    EXPECT_TRUE(differs([](Character& of) { of.rig.rest[3].translation.x += 0.1f; }));
    EXPECT_TRUE(differs([](Character& of) { of.palette[2].joint_from_bind.row[0][3] += 0.1f; }));
    EXPECT_TRUE(differs([](Character& of) { of.words[of.words.size() / 2] ^= 1; }));
    EXPECT_TRUE(differs([](Character& of) { of.keys.back()[0] += 0.001f; }));
    EXPECT_TRUE(differs([](Character& of) { of.times_s[1] *= 1.01f; }));
    EXPECT_TRUE(differs([](Character& of) { of.vertices[0].position.x += 100; }));
    EXPECT_TRUE(differs([](Character& of) { of.size *= 2; }));
    if (made(first).native) {
        EXPECT_NE(made(crowd_of(character_, {3})).native, made(first).native);
    }
}

// A crowd must not use tables that another crowd has not uploaded yet.
TEST_F(SharedRigs, WorkBeforeTheFirstUpdateOfTheirFirstCrowd) {
    const Crowd first = crowd_of(character_);  // never updated
    Crowd second = crowd_of(character_);
    const Device device = another_device();
    Crowd alone = Crowd::create(device, settings_of(character_)).expect();
    for (Crowd* const crowd : {&second, &alone}) {
        ASSERT_TRUE(crowd->set_playback(InstanceHandle{1}, {.first = {.clip = 0, .time_s = 0.3}}));
        ASSERT_TRUE(crowd->update(0.1f));
    }
    for (const uint32_t instance : {0u, 1u})
        EXPECT_EQ(second.read_skin_matrices({instance}).value(), alone.read_skin_matrices({instance}).value());
}

// Nothing is kept after the last crowd is destroyed, and the tables can be made again.
TEST_F(SharedRigs, GoWithTheirLastCrowd) {
    std::weak_ptr<const NativeRig> native;
    std::weak_ptr<const GroupRows> rows;
    {
        const Crowd crowd = crowd_of(character_);
        native = crowd.state().groups[0].fused[0].native;
        rows = crowd.state().groups[0].rows;
    }
    EXPECT_TRUE(native.expired());
    EXPECT_TRUE(rows.expired());
    EXPECT_TRUE(crowd_of(character_).update(0.1f));
}

// Groups with a skin pool use theirs only during creation.
TEST_F(SharedRigs, AreKeptUntilAllGroupsAreCreated) {
    throng::SharedRigs rigs(test_gpu());
    const std::weak_ptr<const NativeRig> first = rigs.native(character_, {});
    EXPECT_FALSE(first.expired());
    EXPECT_EQ(rigs.native(character_, {}), first.lock());
}

// A server of many matches. Prints the figures of docs/performance.md, "Making a crowd".
TEST_F(SharedRigs, AThousandCrowdsOfOneCharacter) {
    if (!test_gpu()->is_native()) GTEST_SKIP() << "for servers, which have no other device";
    const Asset asset = make_creature(creature_settings(CreatureKind::kDragon)).expect();
    const Character dragon = compile_character(asset, {.lods = false}).expect();
    std::vector<Crowd> crowds;
    const auto make_ms = [&](uint32_t count) {
        const auto start = std::chrono::steady_clock::now();
        for (uint32_t i = 0; i < count; ++i) crowds.push_back(crowd_of(dragon));
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    };
    const double first_ms = make_ms(1);
    std::printf("  the first crowd: %.1f ms; 999 more: %.2f ms each\n", first_ms, make_ms(999) / 999);
    for (const Crowd& crowd : crowds) ASSERT_EQ(made(crowd), made(crowds[0]));
    for (Crowd* const crowd : {&crowds.front(), &crowds.back()}) ASSERT_TRUE(crowd->update(0.1f));
    EXPECT_EQ(crowds.front().read_skin_matrices({1}).value(), crowds.back().read_skin_matrices({1}).value());
}

}  // namespace
}  // namespace throng::test
