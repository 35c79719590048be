// Which node of one file moves which of another.
#include "compile/transfer/node_names.h"

#include <gtest/gtest.h>

#include <vector>

namespace throng::test {
namespace {

// Nodes of one name, all of them joints.
Asset nodes_below(const std::vector<uint32_t>& parents) {
    Asset asset;
    for (const uint32_t parent : parents) asset.nodes.push_back({.name = "hips", .parent = parent});
    return asset;
}

std::vector<uint32_t> sources_of(const std::vector<uint32_t>& parents) {
    return find_sources(nodes_below({kNone}), {true}, nodes_below(parents), std::vector<bool>(parents.size(), true));
}

TEST(NodeNames, OneNodeMovesAllJointsOfItsNameButNoneTwice) {
    using Sources = std::vector<uint32_t>;
    EXPECT_EQ(sources_of({kNone, kNone}), (Sources{0, 0}));
    EXPECT_EQ(sources_of({kNone, 0}), (Sources{0, kNone}));
    EXPECT_EQ(sources_of({kNone, 0, kNone}), (Sources{0, kNone, 0}));
    EXPECT_EQ(sources_of({kNone, kNone, 1}), (Sources{0, 0, kNone}));
}

}  // namespace
}  // namespace throng::test
