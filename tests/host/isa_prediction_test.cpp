// Occupancy: how many subgroups a SIMD holds and what limits them, and the predicted times.
#include "bench/isa/prediction.h"

#include <gtest/gtest.h>

namespace throng::bench {
namespace {

// A SIMD has 1024 registers of 32 lanes and 16 subgroup slots; four SIMDs share 128 KiB of shared memory.
TEST(IsaMachines, OccupancyIsLimitedBySlotsRegistersAndSharedMemory) {
    const Simd& simd = *find_family("navi21");
    const auto expect = [&](const KernelNeeds& kernel, double subgroups, const char* limit) {
        const Occupancy occupancy = occupancy_of(kernel, simd);
        EXPECT_DOUBLE_EQ(occupancy.subgroups, subgroups);
        EXPECT_EQ(occupancy.limit, limit);
    };
    expect({.subgroup_size = 32, .workgroup_size = 64, .vgprs = 24}, 16, "places");
    expect({.subgroup_size = 32, .workgroup_size = 64, .vgprs = 128}, 8, "registers");
    expect({.subgroup_size = 64, .workgroup_size = 64, .vgprs = 128}, 4, "registers");
    // Registers are allocated in steps of 16
    expect({.subgroup_size = 32, .workgroup_size = 64, .vgprs = 65}, 12, "registers");
    // Three workgroups of two subgroups each on four SIMDs
    expect({.subgroup_size = 32, .workgroup_size = 64, .vgprs = 80, .shared_bytes = 38'400}, 1.5, "shared memory");
    // Shared memory is allocated in steps of 1,024 bytes
    expect({.subgroup_size = 32, .workgroup_size = 64, .vgprs = 64, .shared_bytes = 4'608}, 12.5, "shared memory");
    expect({.subgroup_size = 64, .workgroup_size = 64, .vgprs = 80, .shared_bytes = 38'400}, 0.75, "shared memory");
}

// Ten vector instructions and a load outside, four vector instructions in a loop.
MachineCode small_code() {
    MachineCode code;
    code.outside[InstructionClass::kVector] = 10;
    code.outside[InstructionClass::kLoad] = code.outside[InstructionClass::kMemoryWait] = 1;
    code.loops.resize(1);
    code.loops[0].own[InstructionClass::kVector] = 4;
    return code;
}

TEST(IsaPrediction, LoopsCountAsOftenAsTheyRun) {
    const MachineCode code = small_code();
    const std::vector<LoopTrips> known{{"joints", 5}};
    const auto trips = trips_of(code, known, 32);
    ASSERT_TRUE(trips);
    const InstructionCounts issued = issued_by_subgroup(code, *trips);
    EXPECT_EQ(issued[InstructionClass::kVector], 30);
    EXPECT_EQ(issued[InstructionClass::kLoad], 1);
    EXPECT_FALSE(trips_of(code, {}, 32)) << "a loop that nobody knows";
    EXPECT_FALSE(trips_of(code, std::vector<LoopTrips>{{"a", 1}, {"b", 1}}, 32));
}

TEST(IsaPrediction, LoopsOverLanesRunOnceForEachLane) {
    MachineCode code;
    code.loops = {{.depth = 0}, {.depth = 1, .over_lanes = true}, {.depth = 0}, {.depth = 0, .over_lanes = true}};
    const auto trips = trips_of(code, std::vector<LoopTrips>{{"rounds", 5}, {"walk", 7}}, 32);
    ASSERT_TRUE(trips);
    EXPECT_EQ((*trips)[1].trips, 5u * 32);
    EXPECT_EQ((*trips)[2].loop, "walk");
    EXPECT_EQ((*trips)[3].trips, 32u);
}

// Ten SIMDs at one gigahertz, and one gigabyte per second.
TEST(IsaPrediction, TheLongestOfIssueWaitsAndMemory) {
    const Machine machine{
        .name = "test", .simd = find_family("navi21"), .simd_count = 10, .clock_ghz = 1, .bytes_per_ns = 1};
    KernelWork work{.needs = {.subgroup_size = 32, .workgroup_size = 32, .vgprs = 32}, .subgroups = 1600};
    work.issued[InstructionClass::kVector] = 100;
    // 160 subgroups on each SIMD, 100 clocks each
    EXPECT_DOUBLE_EQ(predict(work, machine).issue_ms, 0.016);
    EXPECT_EQ(predict(work, machine).limit(), "instructions");
    // 16 at a time, each waiting 10 x 300 clocks
    work.issued[InstructionClass::kMemoryWait] = 10;
    EXPECT_DOUBLE_EQ(predict(work, machine).latency_ms, 160 / 16 * 3100e-6);
    EXPECT_EQ(predict(work, machine).limit(), "waiting for loads");
    work.bytes = 1e6;
    EXPECT_DOUBLE_EQ(predict(work, machine).ms(), 1);
    EXPECT_EQ(predict(work, machine).limit(), "memory");
    // Too few to fill a SIMD: as long as one of them takes
    work.bytes = 0, work.subgroups = 1;
    EXPECT_DOUBLE_EQ(predict(work, machine).ms(), 3100e-6);
    // Subgroups of 64 take two passes, transcendental instructions four times as long
    work.needs.subgroup_size = work.needs.workgroup_size = 64;
    work.issued = {};
    work.issued[InstructionClass::kTranscendental] = 10;
    EXPECT_DOUBLE_EQ(predict(work, machine).issue_ms, 80e-6);
}

TEST(IsaMachines, EachHasACompiledFamily) {
    EXPECT_EQ(machines().size(), 6u);
    for (const Machine& machine : machines()) EXPECT_TRUE(find_family(machine.code)) << machine.name;
    EXPECT_EQ(find_family("navi"), nullptr);
}

}  // namespace
}  // namespace throng::bench
