// Parsing machine code: loops, and instructions by class.
#include "bench/isa/machine_code.h"

#include <gtest/gtest.h>

namespace throng::bench {
namespace {

using enum InstructionClass;

TEST(MachineCode, NestedLoopsAndInstructionClassesAreFound) {
    const MachineCode code = read_machine_code(
        "BB0:\n"
        "\ts_mov_b32 s0, 0                   ; be800380\n"
        "\ts_cbranch_scc1 BB9                ; a branch ahead is no loop\n"
        "BB1:\n"
        "\ts_load_dwordx4 s[8:11], s[4:5], null ; f4080202\n"
        "\ts_waitcnt lgkmcnt(0)              ; bf8cc07f\n"
        "BB2:\n"
        "\tbuffer_load_dword v5, v5, s[8:11], 0 offen ; e0301000\n"
        "\ts_waitcnt vmcnt(0)                ; bf8c3f70\n"
        "\tv_rsq_f32_e32 v1, v1              ; 7e005d01\n"
        "\ts_cbranch_scc1 BB2                ; continue\n"
        "\tv_fmac_f32_e32 v4, v16, v11       ; 56081710\n"
        "\tds_write_b128 v1, v[2:5]          ; db7c0000\n"
        "\ts_branch BB2                      ; bf82ffb0\n"
        "BB5:\n"
        "\ts_cbranch_scc0 BB1                ; bf84ff00\n"
        "BB9:\n"
        "\tbuffer_store_dwordx4 v[0:3], v4, s[0:3], 0 offen ; e0781000\n"
        "\ts_nop 0                           ; bf800000\n"
        "\ts_endpgm                          ; bf810000\n");
    ASSERT_EQ(code.loops.size(), 2u);
    EXPECT_EQ(code.loops[0].depth, 0u);
    EXPECT_EQ(code.loops[0].own.total(), 3);
    EXPECT_EQ(code.loops[0].own[kLoad], 1);
    EXPECT_EQ(code.loops[0].own[kSharedWait], 1);
    EXPECT_EQ(code.loops[0].own[kScalar], 1);

    const InstructionCounts& inner = code.loops[1].own;
    EXPECT_EQ(code.loops[1].depth, 1u);
    EXPECT_EQ(inner.total(), 7);
    EXPECT_EQ(inner[kLoad], 1);
    EXPECT_EQ(inner[kMemoryWait], 1);
    EXPECT_EQ(inner[kTranscendental], 1);
    EXPECT_EQ(inner[kVector], 1);
    EXPECT_EQ(inner[kShared], 1);
    EXPECT_EQ(inner[kScalar], 2);

    EXPECT_EQ(code.outside.total(), 5);
    EXPECT_EQ(code.outside[kStore], 1);
    EXPECT_EQ(code.outside[kHint], 1);
    EXPECT_EQ(code.outside[kScalar], 3);
    EXPECT_EQ(code.all().total(), 15);
}

TEST(MachineCode, WaitsForPartsOfTheSameLoadsTakeTimeOnce) {
    const MachineCode code = read_machine_code(
        "BB0:\n"
        "\tbuffer_load_dwordx4 v[0:3], v9, s[0:3], 0 offen\n"
        "\tbuffer_load_dwordx4 v[4:7], v9, s[0:3], 0 offen offset:16\n"
        "\ts_load_dwordx4 s[4:7], s[0:1], null\n"
        "\ts_waitcnt lgkmcnt(0)\n"
        "\ts_waitcnt vmcnt(1)\n"
        "\ts_waitcnt vmcnt(0)\n"
        "\ts_waitcnt_vscnt null, 0x0\n"
        "\tds_read_b32 v0, v1\n"
        "\ts_waitcnt vmcnt(0) lgkmcnt(0)\n");
    EXPECT_EQ(code.outside[kMemoryWait], 1);
    EXPECT_EQ(code.outside[kSharedWait], 2);
    EXPECT_EQ(code.outside[kHint], 2);
}

TEST(MachineCode, LoopsOverLanes) {
    const MachineCode code = read_machine_code(
        "BB0:\n\tv_readfirstlane_b32 s0, v0\n"
        "BB1:\n\tv_readfirstlane_b32 s1, v0\n\tv_readlane_b32 s2, v1, s1\n\ts_cbranch_execnz BB1\n"
        "\ts_branch BB0\n");
    ASSERT_EQ(code.loops.size(), 2u);
    EXPECT_FALSE(code.loops[0].over_lanes);
    EXPECT_TRUE(code.loops[1].over_lanes);
}

TEST(MachineCode, LoopsSideBySide) {
    const MachineCode code = read_machine_code(
        "BB0:\n\tv_mov_b32 v0, 0\n\ts_branch BB0\nBB1:\n\tv_mov_b32 v1, 0\n\ts_branch BB1\n\ts_endpgm\n");
    ASSERT_EQ(code.loops.size(), 2u);
    for (const MachineLoop& loop : code.loops) {
        EXPECT_EQ(loop.depth, 0u);
        EXPECT_EQ(loop.own.total(), 2);
    }
    EXPECT_EQ(code.outside.total(), 1);
}

}  // namespace
}  // namespace throng::bench
