// The rounding mode and trapped floating-point exceptions of an application's thread change no sample, no update and
// no compiled character.
#include "compile/file/character_file.h"
#include "tests/host/native_cases.h"
#include "tools/creatures/creature.h"

#include <throng/joint_sampler.h>
#include <throng/reference.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <optional>

namespace throng {
namespace {

using namespace test;

// During its lifetime, this thread rounds upwards, and where the processor can trap, divisions by zero end the program.
class UnusualFloats {
public:
    UnusualFloats() {
        std::fegetenv(&before_);
        std::feclearexcept(FE_ALL_EXCEPT);
        std::fesetround(FE_UPWARD);
        feenableexcept(FE_DIVBYZERO | FE_INVALID);
    }
    ~UnusualFloats() { std::fesetenv(&before_); }
    UnusualFloats(const UnusualFloats&) = delete;
    UnusualFloats& operator=(const UnusualFloats&) = delete;

private:
    std::fenv_t before_;
};

constexpr uint32_t kPlaybacks = 21;  // whatever the number of lanes, some have no instance

std::vector<Playback> playbacks_of(const Character& character) {
    Random random(1);
    std::vector<Playback> playbacks;
    for (uint32_t i = 0; i < kPlaybacks; ++i) playbacks.push_back(random_playback(character, random));
    return playbacks;
}

TEST(DefaultFloats, HoldInAJointSampler) {
    const Character character = make_character({.joint_count = 70});
    const std::vector<uint32_t> joints{69, 12};
    const JointSampler sampler = *JointSampler::create(character, joints);
    const std::vector<Playback> playbacks = playbacks_of(character);
    std::vector<Affine> wanted(kPlaybacks * joints.size()), got = wanted;
    const auto sample_all = [&](std::span<Affine> to) {
        for (const Playback& playback : playbacks) {
            EXPECT_TRUE(sampler.sample(playback, to.first(joints.size())));
            to = to.subspan(joints.size());
        }
    };
    sample_all(wanted);
    {
        const UnusualFloats unusual;
        sample_all(got);
    }
    EXPECT_EQ(got, wanted);
}

TEST(DefaultFloats, HoldWhileACharacterIsCompiled) {
    const Asset asset = *make_creature({.joint_count = 30, .level_count = 10, .face_count = 600});
    const Character wanted = *compile_character(asset);
    Character got;
    {
        const UnusualFloats unusual;
        got = *compile_character(asset);
    }
    EXPECT_EQ(write_character(got), write_character(wanted));
}

// Also outside of jobs, where the shared poses of a skin pool are computed.
TEST(DefaultFloats, HoldInNativeUpdates) {
    const Character character = make_character({.joint_count = 20});
    const NativeRig rig(character);
    std::vector<io::InstanceCursor> cursors;
    for (const Playback& playback : playbacks_of(character)) cursors.push_back(cursor_of(character, playback));
    for (const NativeIsa isa : native_isas()) {
        const size_t size_bytes = kPlaybacks * character.palette.size() * sizeof(Affine);
        GuardedBytes wanted(size_bytes), got(size_bytes);
        update(rig, {.cursors = cursors.data(), .skin = wanted.data()}, 0, kPlaybacks, isa);
        {
            const UnusualFloats unusual;
            update(rig, {.cursors = cursors.data(), .skin = got.data()}, 0, kPlaybacks, isa);
        }
        EXPECT_TRUE(std::ranges::equal(got.content(), wanted.content())) << name_of(isa);
    }
}

TEST(DefaultFloats, HoldInReferenceCharacters) {
    const Character character = make_character({.joint_count = 4});
    const Controller controller{.name = "direct", .layers = {{.name = "base"}}};
    const auto play = [&](bool is_unusual) {
        ReferenceCharacter played = ReferenceCharacter::create(character, controller).expect();
        played.play(0, {.clip = {.clip = 0}}).expect();
        played.update(0.1f).expect();
        played.play(0, {.clip = {.clip = 1, .speed = 0.7f}, .fade_s = 3}).expect();
        for (int i = 0; i < 40; ++i) {
            std::optional<UnusualFloats> unusual;
            if (is_unusual) unusual.emplace();
            EXPECT_TRUE(played.update(0.0123f));
        }
        return played.layers();
    };
    const std::vector<std::vector<PlayedMotion>> wanted = play(false);
    ASSERT_EQ(wanted.at(0).size(), 2u) << "the fade is under way";
    EXPECT_EQ(play(true), wanted);
}

}  // namespace
}  // namespace throng
