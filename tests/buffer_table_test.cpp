// BufferTable: names of buffers, and the buffers that stand in for absent ones.
#include "gpu/buffer_table.h"

#include <gtest/gtest.h>

#include <set>

namespace throng {
namespace {

TEST(BufferTable, NumbersMatchTheRowsOfTheNames) {
    EXPECT_EQ(name_of_buffer(io::kTimelineBuffer), "timeline");
    EXPECT_EQ(name_of_buffer(io::kPaletteJointsBuffer), "palette joints");
    EXPECT_EQ(name_of_buffer(io::kBufferCount - 1), "coarser depths");
    EXPECT_EQ(name_of_buffer(io::kBufferCount), "unknown");
    std::set<std::string_view> names;
    for (uint32_t number = 0; number < io::kBufferCount; ++number) names.insert(name_of_buffer(number));
    EXPECT_EQ(names.size(), io::kBufferCount) << "two buffers have one name";
}

TEST(BufferTable, PlaceholdersAreUsedOnlyForAbsentBuffers) {
    const auto fake = [](uint64_t bytes) { return BufferRange(reinterpret_cast<VkBuffer>(bytes), 0, bytes); };
    BufferTable table{{io::kTracksBuffer, fake(16)}};
    EXPECT_EQ(table.storage(io::kTracksBuffer).size_bytes, 16u);
    EXPECT_FALSE(table.storage(io::kKeysBuffer).buffer);
    table.set_absent(fake(32), fake(48));
    EXPECT_EQ(table.table(io::kTracksBuffer).size_bytes, 16u);
    EXPECT_EQ(table.storage(io::kKeysBuffer).size_bytes, 32u);
    EXPECT_EQ(table.table(io::kKeysBuffer).size_bytes, 48u);
    EXPECT_EQ(table.with({{io::kKeysBuffer, fake(64)}}).storage(io::kKeysBuffer).size_bytes, 64u);
    EXPECT_EQ(table.storage(io::kKeysBuffer).size_bytes, 32u) << "with() is of a copy";
}

}  // namespace
}  // namespace throng
