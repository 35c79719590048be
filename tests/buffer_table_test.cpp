// The table of buffers: what it says is what docs/architecture.md says.
#include "gpu/buffer_table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

namespace throng {
namespace {

std::string row_of(const BufferInfo& info) {
    std::string row = "| `" + std::string(info.name) + "` |";
    for (const std::string_view cell : {info.shape, info.element, info.content, info.writer, info.reader})
        row += " " + std::string(cell) + " |";
    return row + "\n";
}

TEST(BufferTable, TheDocumentationHasItsRows) {
    std::ifstream file(std::string(THRONG_SOURCE_DIR) + "/docs/architecture.md");
    std::stringstream text;
    text << file.rdbuf();
    std::string rows;
    for (const BufferInfo& info : buffer_infos()) rows += row_of(info);
    EXPECT_NE(text.str().find(rows), std::string::npos) << "docs/architecture.md should have these rows:\n" << rows;
}

TEST(BufferTable, NamesAreTheirOwn) {
    std::set<std::string_view> names;
    for (const BufferInfo& info : buffer_infos()) {
        EXPECT_FALSE(info.name.empty() || info.shape.empty() || info.element.empty() || info.content.empty());
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
    }
    EXPECT_EQ(names.size(), io::kBufferCount);
}

TEST(BufferTable, WhatIsThereComesBeforeWhatStandsForIt) {
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
