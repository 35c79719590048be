// The order in which `stream` processes joints, simulated as in the shader. No device is involved.
#include "scan/stream_io.h"
#include "scan/stream_plan.h"
#include "tests/test_rig.h"

#include <throng/character.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace throng {
namespace {

using namespace test;

using Path = std::vector<uint32_t>;  // a product, as the joints from the root down

// What the lanes of one team store, keyed by (character, joint).
std::map<std::pair<uint32_t, uint32_t>, Path> walked(const StreamPlan& plan, std::span<const uint32_t> parents) {
    const std::vector<uint32_t> links = stream_links(plan, parents);
    std::map<std::pair<uint32_t, uint32_t>, Path> stored;
    std::vector<Path> slots(plan.slots + 1);
    const uint32_t chunk_count = links[io::kChunkCount];
    size_t word = io::kFirstChunk + chunk_count;
    for (uint32_t chunk = 0; chunk < chunk_count; ++chunk) {
        struct Lane {
            uint32_t joint, keep, character, ancestor;
            Path path, above;
        };
        std::vector<Lane> lanes;
        for (uint32_t lane = 0; lane < plan.lanes; ++lane, word += 2) {
            const uint32_t a = links[word], b = links[word + 1];
            Lane& of = lanes.emplace_back(Lane{a & io::kStreamJointMask,
                                               a >> io::kStreamKeepShift,
                                               b >> io::kStreamCharacterShift & io::kStreamCharacterMask,
                                               b & io::kStreamLaneMask,
                                               {},
                                               {}});
            if (of.joint == io::kStreamIdle) continue;
            of.path = {of.joint};
            of.above = slots[b >> io::kStreamSlotShift];
        }
        for (uint32_t round = 0; round < links[io::kFirstChunk + chunk]; ++round) {
            const std::vector<Lane> before = lanes;
            for (uint32_t lane = 0; lane < plan.lanes; ++lane) {
                const Lane& above = before[before[lane].ancestor];
                if (before[lane].ancestor == lane) continue;
                lanes[lane].ancestor = above.ancestor == before[lane].ancestor ? lane : above.ancestor;
                lanes[lane].path = above.path;
                lanes[lane].path.insert(lanes[lane].path.end(), before[lane].path.begin(), before[lane].path.end());
            }
        }
        for (Lane& lane : lanes) {
            if (lane.joint == io::kStreamIdle) continue;
            lane.path.insert(lane.path.begin(), lane.above.begin(), lane.above.end());
            if (lane.keep > 0) slots.at(lane.keep) = lane.path;
            EXPECT_TRUE(stored.emplace(std::pair(lane.character, lane.joint), lane.path).second) << "stored once";
        }
    }
    EXPECT_EQ(word, links.size());
    return stored;
}

TEST(StreamPlan, EachJointIsTheProductOfItsAncestors) {
    for (const uint32_t lanes : {4u, 8u, 32u, 64u})
        for (const uint32_t joint_count : {1u, 2u, 7u, 9u, 31u, 33u, 64u, 300u, 1024u})
            for (const RigShape shape : kRigShapes) {
                const ScanRig rig(make_parents(shape, joint_count, joint_count));
                const StreamPlan plan = plan_stream(rig, {.lanes = lanes});
                SCOPED_TRACE(std::string(name_of(shape)) + " of " + std::to_string(joint_count) + ", " +
                             std::to_string(lanes) + " lanes");
                const auto stored = walked(plan, rig.parents);
                ASSERT_EQ(stored.size(), size_t{plan.characters} * joint_count);
                for (const auto& [of, path] : stored) ASSERT_EQ(path, rig.chain(of.second));
            }
}

// A subgroup's stores then fill whole cache lines.
TEST(StreamPlan, JointsOfAChunkAreConsecutive) {
    for (const RigShape shape : kRigShapes)
        for (const uint32_t joint_count : {160u, 300u, 1024u}) {
            const StreamPlan plan = plan_stream(ScanRig(make_parents(shape, joint_count, 7)), {.lanes = 32});
            ASSERT_EQ(plan.characters, 1u);
            for (const std::vector<uint32_t>& chunk : plan.chunks)
                EXPECT_EQ(chunk.back() - chunk.front() + 1, chunk.size()) << name_of(shape) << " of " << joint_count;
        }
}

// A character's bits then do not depend on which others share its subgroup.
TEST(StreamPlan, CharactersThatShareChunksArePlannedAlike) {
    uint32_t shared = 0;
    for (const RigShape shape : kRigShapes)
        for (const uint32_t joint_count : {2u, 7u, 12u, 19u, 41u}) {
            const StreamPlan plan = plan_stream(ScanRig(make_parents(shape, joint_count, 7)), {.lanes = 32});
            shared += plan.characters > 1;
            for (const std::vector<uint32_t>& chunk : plan.chunks) {
                ASSERT_EQ(chunk.size() % plan.characters, 0u);
                const size_t of_each = chunk.size() / plan.characters;
                for (size_t i = 0; i < chunk.size(); ++i) {
                    EXPECT_EQ(chunk[i] / joint_count, i / of_each);
                    EXPECT_EQ(chunk[i] % joint_count, chunk[i % of_each] % joint_count);
                }
            }
        }
    EXPECT_GT(shared, 4u);
}

}  // namespace
}  // namespace throng
