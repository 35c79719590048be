// Progress and cancellation while several threads pack clips.
#include "tests/files.h"
#include "tests/load_listener.h"
#include "tools/creatures/creature.h"

#include <throng/throng.h>

#include <gtest/gtest.h>

#include <stdexcept>

namespace throng::test {
namespace {

// A character with enough clips for all threads, and a mesh with levels of detail.
const Asset& walker() {
    static const Asset asset = [] {
        Asset made = make_creature(
                         {.joint_count = 12, .level_count = 6, .face_count = 300, .kind = CreatureKind::kWalker})
                         .expect();
        for (size_t i = 0; i < 4; ++i) made.clips.push_back(made.clips[i]);
        return made;
    }();
    return asset;
}
std::string saved(const Character& character) {
    const TemporaryFolder folder;
    save_character(character, folder.path() / "saved").expect();
    return read_file(folder.path() / "saved");
}

// Cancels at different polls. The threads that pack clips must end each time.
TEST(CompileHooks, PackingMayBeCancelled) {
    const std::string wanted = saved(compile_character(walker()).expect());
    Listener whole;
    EXPECT_EQ(saved(compile_character(walker(), {}, whole.hooks()).expect()), wanted) << "hooks change nothing";
    EXPECT_EQ(whole.parts.front(), 0);
    EXPECT_EQ(whole.parts.back(), 1);
    EXPECT_GT(whole.parts.size(), 20u) << "clips, and poses of levels of detail";
    constexpr uint64_t kTries = 20;
    for (uint64_t i = 0; i < kTries; ++i) {
        Listener listener{.yes_at = whole.polls * i / kTries};
        const Result<Character> result = compile_character(walker(), {}, listener.hooks());
        ASSERT_EQ(result.ok(), !listener.said_yes) << "other threads may have had more of the clips than before";
        if (result) continue;
        EXPECT_EQ(result.error().code, ErrorCode::kCancelled) << result.error().text();
        EXPECT_EQ(result.error().place, walker().name);
    }
    EXPECT_EQ(saved(compile_character(walker()).expect()), wanted);
}

TEST(CompileHooks, AThrowingHookEndsPackingToo) {
    for (const double from : {0.2, 0.4, 0.6, 0.8}) {
        const LoadHooks hooks{.progress = [from](double part_done) {
            if (part_done >= from) throw std::runtime_error("enough");
        }};
        const Result<Character> result = compile_character(walker(), {}, hooks);
        ASSERT_FALSE(result.ok());
        EXPECT_EQ(result.error().message, "progress threw: enough");
    }
}

}  // namespace
}  // namespace throng::test
