// Cutting a skeleton into pieces, one per invocation.
#include "scan/pieces.h"
#include "scan/pieces_io.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>

namespace throng {
namespace {

using namespace test;

std::string place(RigShape shape, uint32_t joint_count, uint32_t pieces) {
    return std::string(name_of(shape)) + " of " + std::to_string(joint_count) + " joints in " + std::to_string(pieces) +
           " pieces";
}

TEST(Pieces, EachJointIsInOneConnectedPiece) {
    for (const RigShape shape :
         {RigShape::kChain, RigShape::kStar, RigShape::kComb, RigShape::kBinary, RigShape::kRandom, RigShape::kBushy}) {
        for (const uint32_t joint_count : {1u, 2u, 9u, 64u, 300u, 2000u}) {
            const ScanRig rig(make_parents(shape, joint_count));
            for (const uint32_t most : {1u, 2u, 8u, 32u, 256u}) {
                const PieceCut cut = cut_into_pieces(rig, most);
                ASSERT_LE(cut.pieces.size(), most) << place(shape, joint_count, most);
                std::vector<uint32_t> seen(joint_count);
                for (uint32_t p = 0; p < cut.pieces.size(); ++p) {
                    ASSERT_FALSE(cut.pieces[p].joints.empty());
                    std::set<uint32_t> before;
                    for (const uint32_t joint : cut.pieces[p].joints) {
                        ++seen[joint];
                        EXPECT_EQ(cut.piece_of_joint[joint], p);
                        const uint32_t parent = rig.parents[joint];
                        EXPECT_TRUE(parent == cut.pieces[p].attachment || before.count(parent))
                            << place(shape, joint_count, most) << ", joint " << joint;
                        before.insert(joint);
                    }
                    EXPECT_FALSE(before.count(cut.pieces[p].attachment));
                }
                EXPECT_EQ(std::count(seen.begin(), seen.end(), 1u), joint_count) << place(shape, joint_count, most);
            }
        }
    }
}

TEST(Pieces, AreOfNearlyEqualSize) {
    for (const RigShape shape :
         {RigShape::kChain, RigShape::kStar, RigShape::kComb, RigShape::kBinary, RigShape::kRandom, RigShape::kBushy}) {
        for (const uint32_t most : {8u, 32u}) {
            const PieceCut cut = cut_into_pieces(ScanRig(make_parents(shape, 1000)), most);
            size_t largest = 0;
            for (const Piece& piece : cut.pieces) largest = std::max(largest, piece.joints.size());
            // Subtrees cannot always be cut evenly
            EXPECT_LE(largest, 2 * 1000 / most + 1) << place(shape, 1000, most);
        }
    }
}

TEST(Pieces, AChainIsCutEvenlyAndAStarToo) {
    for (const RigShape shape : {RigShape::kChain, RigShape::kStar}) {
        const PieceCut cut = cut_into_pieces(ScanRig(make_parents(shape, 64)), 8);
        ASSERT_EQ(cut.pieces.size(), 8u) << name_of(shape);
        for (const Piece& piece : cut.pieces) EXPECT_EQ(piece.joints.size(), 8u) << name_of(shape);
    }
}

// Walks the table with a stack, as the shader does: each joint's parent must be where its word says.
TEST(Pieces, TheTableLinksEachJointToItsParent) {
    for (const RigShape shape :
         {RigShape::kChain, RigShape::kStar, RigShape::kComb, RigShape::kBinary, RigShape::kRandom, RigShape::kBushy}) {
        constexpr uint32_t kThreads = 16;
        const ScanRig rig(make_parents(shape, 500));
        const PieceTable table = piece_table(rig, kThreads, kRowsOfAffine);
        ASSERT_EQ(table.links.size(),
                  io::kFirstRow + (table.path_row_count + table.round_count + table.walk_row_count) * kThreads);
        std::vector<uint32_t> seen(rig.joint_count());
        for (uint32_t thread = 0; thread < kThreads; ++thread) {
            std::vector<uint32_t> slots(table.slot_count, kNone);
            uint32_t last = kNone, attachment = kNone;
            for (uint32_t row = 0; row < table.walk_row_count; ++row) {
                const uint32_t word =
                    table.links[io::kFirstRow + (table.path_row_count + table.round_count + row) * kThreads + thread];
                if (word == io::kIdle) break;
                const uint32_t joint = word & io::kWalkJointMask,
                               source = word >> io::kWalkParentShift & io::kWalkFieldMask,
                               keep = word >> io::kWalkKeepShift & io::kWalkFieldMask;
                if (row == 0) attachment = rig.parents[joint];
                const uint32_t parent = source == io::kParentIsLast     ? last
                                        : source == io::kParentIsPrefix ? attachment
                                                                        : slots.at(source - io::kParentInSlot);
                EXPECT_EQ(parent, rig.parents[joint]) << name_of(shape) << ", joint " << joint;
                if (keep > 0) slots.at(keep - 1) = joint;
                last = joint;
                ++seen[joint];
            }
        }
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 1u), rig.joint_count()) << name_of(shape);
    }
}

// ../shared/design/gpu.md found with a prototype: 376 to 508 multiplications for 300 joints in 32 pieces, 18 to 27 on
// the longest lane.
TEST(Pieces, NeedLittleMoreThanOneMultiplicationPerJoint) {
    for (const RigShape shape : {RigShape::kRandom, RigShape::kBushy, RigShape::kComb, RigShape::kChain}) {
        const ScanRig rig(make_parents(shape, 300));
        const PieceTable table = piece_table(rig, 32, kRowsOfAffine);
        std::printf("  %-7s %3u levels: %llu multiplications, %u on the longest lane, %u slots\n",
                    std::string(name_of(shape)).c_str(), rig.level_count,
                    static_cast<unsigned long long>(table.multiplications), table.longest_thread, table.slot_count);
        EXPECT_GE(table.multiplications, 300u);
        EXPECT_LE(table.multiplications, 750u);
        EXPECT_LE(table.longest_thread, 40u);
    }
    EXPECT_EQ(piece_table(ScanRig(make_parents(RigShape::kRandom, 300)), 1, kRowsOfAffine).multiplications, 300u)
        << "a single piece has no path and no rounds";
}

}  // namespace
}  // namespace throng
