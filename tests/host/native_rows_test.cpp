// How many rows of keys the native engine and GPUs make from clips, and when that is refused.
#include "base/failure.h"
#include "native/gpu_rows.h"
#include "native/native_rig.h"
#include "native/row_cursors.h"
#include "tests/test_rig.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace throng {
namespace {

using namespace test;

// The error from creating a rig of all joints. Empty if it can be created.
std::optional<Error> error_of_rig(const Character& character) {
    try {
        NativeRig(character, {.keeps_model = true});
    } catch (const Failure& failure) {
        return failure.error;
    }
    return std::nullopt;
}

void expect_too_many_rows(const Character& character) {
    const std::optional<Error> error = error_of_rig(character);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(error->message, "more than the limit of 1024 MiB of rows")) << error->text();
}

// Two joints, 1,000 times the character's size apart. The first alternates between two rotations from key to key.
Character swinging(uint32_t row_count, uint32_t row_stride) {
    Character character{.name = "swinging",
                        .clips = {{.row_count = row_count, .row_stride = row_stride}},
                        .keys = {{0, 0, 0, 1}, {1000, 0, 0, 0}, {1, 1, 1, 0}}};
    character.size = 1;
    character.rig.parents = {kNone, 0};
    character.rig.rest = {{}, {.translation = {1000, 0, 0}}};
    const JointTracks rest{.rotation = 0, .translation = 1, .scale = 2};
    const JointTracks turns{.rotation = 3 | kTrackAnimated, .translation = 1, .scale = 2};
    character.tracks = {turns, rest, rest, rest};
    const float s = std::sin(1.4f), c = std::cos(1.4f);
    for (uint32_t row = 0; row < std::max(row_stride * row_count, 1u); ++row)
        character.keys.push_back(row % 2 == 0 ? std::array{0.0f, 0.0f, 0.0f, 1.0f} : std::array{0.0f, 0.0f, s, c});
    return character;
}

// A hand-made character can claim that billions of rows are all the same one. None may be read.
TEST(NativeRows, AreRefusedWhereThereAreTooManyRowsOfKeys) {
    Character character = swinging(4'000'000'000, 0);
    for (JointTracks& tracks : character.tracks) tracks.scale |= kTrackAnimated;
    expect_too_many_rows(character);
}

// A turn between two keys becomes up to 256 rows if the rotated parts are long.
TEST(NativeRows, AreRefusedWhereArcsNeedTooMany) {
    EXPECT_FALSE(error_of_rig(swinging(100, 1)));
    expect_too_many_rows(swinging(40'000, 1));
}

TEST(NativeRows, AreCountedBeforeTheyAreListed) {
    const Character character = make_character({.joint_count = 9, .scale_spread = 0});
    const native::RowSpaces spaces(character, false);
    ASSERT_TRUE(spaces.uniform_scale);
    const auto rows_within = [&](uint64_t max_rows) {
        return native::row_cursors(character, spaces.of_joints, max_rows);
    };
    const auto all = rows_within(UINT64_MAX);
    ASSERT_TRUE(all);
    uint64_t row_count = 0, key_rows = 1;
    for (const native::ClipRowCursors& clip : *all) row_count += clip.rows.size();
    for (const Clip& clip : character.clips) key_rows += clip.row_count;
    EXPECT_GT(row_count, key_rows) << "arcs are cut into pieces";
    EXPECT_TRUE(rows_within(row_count));
    EXPECT_FALSE(rows_within(row_count - 1));
    const uint64_t min_bytes = row_count * spaces.of_joints.size() * sizeof(GpuRows::rows[0]);
    EXPECT_FALSE(make_gpu_rows(character, spaces.of_joints, min_bytes - 1));
    const std::optional<GpuRows> on_gpu = make_gpu_rows(character, spaces.of_joints, UINT64_MAX);
    ASSERT_TRUE(on_gpu);
    EXPECT_EQ(on_gpu->rows.size(), row_count * on_gpu->column_count);
}

}  // namespace
}  // namespace throng
