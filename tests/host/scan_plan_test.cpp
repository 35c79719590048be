// Plans of scan methods for a skeleton: their counts, and what they refuse. No device is involved.
#include "scan/scan_table.h"
#include "tests/test_rig.h"

#include <throng/crowd.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <map>
#include <string>

namespace throng {
namespace {

using namespace test;

constexpr ScanLimits kSmallGpu{
    .shared_memory_bytes = 32768, .workgroup_size = 1024, .subgroup_size = 8, .shuffle = true, .is_cpu = true};

ScanCounts counts_of(std::string_view name, const ScanRig& rig, uint32_t threads = 0) {
    const ScanPlan plan = plan_scan(*find_scan_method(name), rig, kSmallGpu, threads);
    EXPECT_EQ(plan.unsupported_reason, "") << name;
    return plan.counts;
}

TEST(ScanPlan, CountsOfSmallRigsAreThoseByHand) {
    struct Wanted {
        const char* name;
        uint64_t multiplications;
        uint32_t longest_thread, barriers, shared_bytes;
        double issue_steps;
    };
    const auto compare = [](const char* rig_name, const ScanRig& rig, std::initializer_list<Wanted> table) {
        for (const Wanted& wanted : table) {
            const ScanCounts counts = counts_of(wanted.name, rig);
            EXPECT_EQ(counts.multiplications, wanted.multiplications) << wanted.name << ", " << rig_name;
            EXPECT_EQ(counts.longest_thread, wanted.longest_thread) << wanted.name << ", " << rig_name;
            EXPECT_EQ(counts.barriers, wanted.barriers) << wanted.name << ", " << rig_name;
            EXPECT_EQ(counts.shared_bytes, wanted.shared_bytes) << wanted.name << ", " << rig_name;
            EXPECT_DOUBLE_EQ(counts.issue_steps, wanted.issue_steps) << wanted.name << ", " << rig_name;
        }
    };
    compare("a chain of 5", ScanRig(make_parents(RigShape::kChain, 5)),
            {{"gateau2012_walk", 0 + 1 + 2 + 3 + 4, 4, 0, 0, 4},
             {"kandar2024_leaves", 4, 4, 0, 0, 4 / 8.0},  // 8 characters per subgroup, each with one leaf
             {"doubling", 4 + 3 + 1, 3, 2, 5 * 96, 3},
             {"blocks64", 4 + 3 + 1, 3, 3, 5 * 96, 3},
             {"compressed", 0 + 1 + 2 + 3 + 4, 4, 2, 5 * 96, 4},
             {"levels", 4, 4, 4, 96, 4},
             {"serial", 4, 4, 0, 0, 5 / 8.0}});
    compare("a star of 9", ScanRig(make_parents(RigShape::kStar, 9)),
            {{"gateau2012_walk", 8, 1, 0, 0, 2},  // 9 joints need two subgroups
             {"kandar2024_leaves", 8, 1, 0, 0, 1},
             {"doubling", 8, 1, 0, 96, 2},  // one element of the array, which it does not need here
             {"blocks64", 8, 1, 1, 9 * 96, 2},
             {"compressed", 8, 1, 2, 9 * 96, 2},
             {"levels", 8, 1, 1, 96, 1},
             {"serial", 8, 8, 0, 0, 9 / 8.0}});
    // Two blocks. The second has 6 joints, and its first joint's parent is in the first block.
    compare("a chain of 70", ScanRig(make_parents(RigShape::kChain, 70)),
            {{"doubling", 69 + 68 + 66 + 62 + 54 + 38 + 6, 7, 6, 70 * 96, 9 + 9 + 9 + 8 + 7 + 5 + 1},
             {"blocks64", 63 + 62 + 60 + 56 + 48 + 32 + 5 + 4 + 2 + 6, 7, 6, 70 * 96, 9 + 9 + 9 + 7 + 6 + 4 + 1}});
}

// The longest chain inside a block and the hops between blocks, counted joint by joint.
TEST(ScanPlan, MultiplicationsMatchTheDefinitions) {
    for (const RigShape shape :
         {RigShape::kChain, RigShape::kStar, RigShape::kComb, RigShape::kBinary, RigShape::kRandom, RigShape::kBushy}) {
        const ScanRig rig(make_parents(shape, 300, 3));
        std::map<std::string_view, uint64_t> wanted;
        std::vector<uint32_t> child_count(rig.joint_count());
        for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
            uint32_t inside = 0, hops = 0, ancestor = joint;
            for (; ancestor != kNone && ancestor / 64 == joint / 64; ancestor = rig.parents[ancestor]) ++inside;
            while (ancestor != kNone) {
                const uint32_t block = ancestor / 64;
                for (++hops; ancestor != kNone && ancestor / 64 == block;) ancestor = rig.parents[ancestor];
            }
            const auto rounds = [](uint32_t length) { return static_cast<uint32_t>(std::bit_width(length - 1)); };
            wanted["gateau2012_walk"] += rig.depths[joint] - 1;
            wanted["doubling"] += rounds(rig.depths[joint]);
            wanted["blocks64"] += rounds(inside) + hops;
            wanted["compressed"] += std::min(inside - 1, 7u) + (inside - 1) / 8 + hops;
            wanted["levels"] += rig.depths[joint] > 1 ? 1 : 0;
            wanted["serial"] += rig.depths[joint] > 1 ? 1 : 0;
            if (rig.parents[joint] != kNone) ++child_count[rig.parents[joint]];
        }
        for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
            wanted["kandar2024_leaves"] += child_count[joint] == 0 ? rig.depths[joint] - 1 : 0;
        for (const auto& [name, multiplications] : wanted)
            EXPECT_EQ(counts_of(name, rig).multiplications, multiplications) << name << ", " << name_of(shape);
    }
}

// Every method needs at least one multiplication per joint that has a parent, and its longest thread at least its
// share.
TEST(ScanPlan, CountsArePlausible) {
    for (const RigShape shape :
         {RigShape::kChain, RigShape::kStar, RigShape::kComb, RigShape::kBinary, RigShape::kRandom, RigShape::kBushy}) {
        const ScanRig rig(make_parents(shape, 300, 3), true);
        const auto least = static_cast<uint64_t>(
            std::count_if(rig.parents.begin(), rig.parents.end(), [](uint32_t parent) { return parent != kNone; }));
        for (const ScanMethod& method : scan_table()) {
            for (const uint32_t threads : method.thread_choices(kSmallGpu)) {
                const ScanPlan plan = plan_scan(method, rig, kSmallGpu, threads);
                if (!plan.unsupported_reason.empty()) continue;
                const ScanCounts& counts = plan.counts;
                const std::string where = std::string(method.name) + ":" + std::to_string(threads) + ", " +
                                          std::string(name_of(shape));
                EXPECT_GE(counts.multiplications, least) << where;
                EXPECT_LE(counts.multiplications, rig.joint_count() * uint64_t{rig.level_count}) << where;
                EXPECT_GE(uint64_t{counts.longest_thread} * plan.workgroup_size, counts.multiplications) << where;
                EXPECT_GE(counts.longest_thread, std::bit_width(rig.level_count - 1)) << where;
                EXPECT_GE(counts.issue_steps * kSmallGpu.subgroup_size, static_cast<double>(counts.multiplications))
                    << where;
                EXPECT_GT(counts.issue_rows, counts.issue_steps) << where;
            }
        }
    }
}

TEST(ScanPlan, PlansNameWhyTheyDoNotApply) {
    const ScanRig uniform(make_parents(RigShape::kBinary, 30), true),
        stretched(make_parents(RigShape::kBinary, 30), false);
    for (const ScanMethod& method : scan_table()) {
        const std::vector<uint32_t> choices = method.thread_choices(kSmallGpu);
        ASSERT_FALSE(choices.empty()) << method.name;
        EXPECT_EQ(plan_scan(method, uniform, kSmallGpu, choices[0]).unsupported_reason, "") << method.name;
        const std::string scale = plan_scan(method, stretched, kSmallGpu, choices[0]).unsupported_reason;
        EXPECT_EQ(scale.find("scale") != std::string::npos, method.format == ScanFormat::kSimilarity)
            << method.name << ": " << scale;
        EXPECT_NE(plan_scan(method, uniform, kSmallGpu, 7).unsupported_reason.find("7 invocations"), std::string::npos)
            << method.name;
        EXPECT_EQ(threads_unsupported_reason(method, kSmallGpu, choices[0]), "") << method.name;
        EXPECT_NE(threads_unsupported_reason(method, kSmallGpu, 7).find("7 invocations"), std::string::npos)
            << method.name;
    }
}

// A shared array has at least one element, even if the rig needs none.
TEST(ScanPlan, DeclaredSharedMemoryIsCounted) {
    const ScanRig single(make_parents(RigShape::kChain, 1)), star(make_parents(RigShape::kStar, 9)),
        chain(make_parents(RigShape::kChain, 5));
    ScanLimits limits = kSmallGpu;
    for (const auto& [name, rig] :
         {std::pair{"doubling", single}, {"levels", single}, {"levels", star}, {"levels", chain}}) {
        const ScanPlan plan = plan_scan(*find_scan_method(name), rig, kSmallGpu, 0);
        EXPECT_EQ(plan.counts.shared_bytes, 96u) << name;
        EXPECT_EQ(plan.constants[0], 1u) << name;
        limits.shared_memory_bytes = 96;
        EXPECT_TRUE(plan_scan(*find_scan_method(name), rig, limits, 0).on_chip) << name;
        limits.shared_memory_bytes = 95;
        EXPECT_FALSE(plan_scan(*find_scan_method(name), rig, limits, 0).on_chip) << name;
    }
}

TEST(ScanPlan, TooManyLoopIterationsAreAnObstacle) {
    ScanLimits limits = kSmallGpu;
    limits.loop_iterations = 65535;
    const ScanRig chain(make_parents(RigShape::kChain, 65535));
    const std::string unsupported_reason = plan_scan(*find_scan_method("serial"), chain, limits, 0).unsupported_reason;
    EXPECT_EQ(unsupported_reason, "65538 loop iterations of an invocation exceed the device's 65535");
    EXPECT_EQ(plan_scan(*find_scan_method("doubling"), chain, limits, 0).unsupported_reason, "");
    EXPECT_EQ(counts_of("gateau2012_walk", ScanRig(make_parents(RigShape::kChain, 33))).loop_iterations, 32u + 2 + 1);
    // With 256 invocations, the sixth subgroup has joints 40 to 47, then 296 to 299.
    EXPECT_EQ(counts_of("gateau2012_walk", ScanRig(make_parents(RigShape::kChain, 300))).loop_iterations,
              47u + 2 + 299 + 2 + 1);
}

TEST(ScanPlan, TheTableNamesItsMethods) {
    ASSERT_FALSE(scan_table().empty());
    for (const ScanMethod& method : scan_table()) {
        EXPECT_EQ(find_scan_method(method.name), &method) << "two rows have one name";
        EXPECT_FALSE(method.summary.empty());
        EXPECT_FALSE(method.source.empty());
    }
    EXPECT_EQ(find_scan_method("no such method"), nullptr);
}

TEST(ScanPlan, FusedFormsAreTriedInAnOrderOfTheirOwn) {
    for (const bool is_cpu : {true, false}) {
        const ScanLimits limits{.workgroup_size = 1024, .subgroup_size = 32, .shuffle = true, .is_cpu = is_cpu};
        std::map<uint32_t, std::string> tried;
        for (const ScanMethod& method : scan_table())
            if (const FusedPlace place = method.fused_place(limits, {.joint_count = 1, .subgroups = 0});
                place.order > 0) {
                EXPECT_TRUE(tried.emplace(place.order, method.name).second) << method.name;
                EXPECT_EQ(threads_unsupported_reason(method, limits, place.threads), "") << method.name;
            }
        std::string order;
        for (const auto& [number, name] : tried) order += name + " ";
        EXPECT_EQ(order, is_cpu ? "serial " : "stream stream_quaternion subgroup_quaternion subgroup fragments ");
    }
}

}  // namespace
}  // namespace throng
