// The scan benchmark: its skeletons, its statistics, and that it never times a wrong result.
#include "base/failure.h"
#include "bench/scan_cell.h"
#include "bench/scan_crowd.h"
#include "bench/updates.h"
#include "tools/cli/statistics.h"
#include "tests/kernel_runner.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <thread>

namespace throng::bench {
namespace {

using test::test_gpu;

const Progress kBenchQuiet = [](const std::string&) {};

std::vector<uint32_t> subtree_sizes(const std::vector<uint32_t>& parents) {
    std::vector<uint32_t> sizes(parents.size(), 1);
    for (size_t joint = parents.size(); joint-- > 1;) sizes[parents[joint]] += sizes[joint];
    return sizes;
}

// Depth first: a joint's descendants follow it. Among siblings, the one with the largest subtree comes last.
void expect_throngs_order(const std::vector<uint32_t>& parents) {
    const std::vector<uint32_t> sizes = subtree_sizes(parents);
    ASSERT_EQ(parents[0], kNone);
    std::vector<uint32_t> last_child(parents.size(), kNone);
    for (uint32_t joint = 1; joint < parents.size(); ++joint) {
        const uint32_t parent = parents[joint];
        ASSERT_LT(parent, joint);
        const uint32_t elder = last_child[parent];
        ASSERT_EQ(joint, elder == kNone ? parent + 1 : elder + sizes[elder]) << "not depth first";
        ASSERT_LE(elder == kNone ? 0 : sizes[elder], sizes[joint]) << "a larger subtree comes first";
        last_child[parent] = joint;
    }
}

TEST(Bench, SkeletonsHaveTheAskedShape) {
    for (const uint32_t joints : {1u, 2u, 3u, 16u, 100u, 300u, 4096u})
        for (const uint32_t levels : {1u, 2u, 3u, 15u, 30u, 60u, 100u, 300u})
            for (const uint64_t seed : {1u, 2u, 3u}) {
                if (levels > joints || (levels == 1) != (joints == 1)) continue;
                const ScanRig rig(make_skeleton(SkeletonShape::kRandom, joints, levels, seed));
                EXPECT_EQ(rig.joint_count(), joints);
                EXPECT_EQ(rig.level_count, levels) << joints << " joints";
                expect_throngs_order(rig.parents);
            }
    EXPECT_EQ(make_skeleton(SkeletonShape::kRandom, 300, 30, 7), make_skeleton(SkeletonShape::kRandom, 300, 30, 7));
    EXPECT_NE(make_skeleton(SkeletonShape::kRandom, 300, 30, 7), make_skeleton(SkeletonShape::kRandom, 300, 30, 8));
    double mean_depth = 0;
    for (const uint32_t levels : {15u, 30u, 60u, 120u}) {
        const ScanRig rig(make_skeleton(SkeletonShape::kRandom, 300, levels, 1));
        EXPECT_GT(rig.mean_depth, 1.5 * mean_depth) << levels << " levels";
        mean_depth = rig.mean_depth;
    }
    struct Regular {
        SkeletonShape shape;
        uint32_t levels, leaves;
    };
    for (const Regular& regular : {Regular{SkeletonShape::kChain, 127, 1}, Regular{SkeletonShape::kComb, 64, 64},
                                   Regular{SkeletonShape::kBinary, 7, 64}}) {
        const ScanRig rig(make_skeleton(regular.shape, 127, 0, 1));
        EXPECT_EQ(rig.joint_count(), 127u);
        EXPECT_EQ(rig.level_count, regular.levels) << name_of(regular.shape);
        EXPECT_EQ(rig.leaf_count, regular.leaves) << name_of(regular.shape);
        expect_throngs_order(rig.parents);
    }
}

TEST(Bench, ImpossibleSkeletonsAreRefused) {
    for (const auto& [joints, levels] : {std::pair{0u, 1u}, {65'536u, 10u}, {10u, 11u}, {10u, 0u}, {10u, 1u}, {1u, 2u}})
        EXPECT_THROW(make_skeleton(SkeletonShape::kRandom, joints, levels, 1), Failure)
            << joints << " joints, " << levels << " levels";
}

TEST(Bench, SpreadsAreOfTheSortedValues) {
    std::vector<double> values;
    for (int i = 100; i >= 0; --i) values.push_back(i);
    const Spread spread = spread_of(values);
    EXPECT_EQ(spread.p5, 5);
    EXPECT_EQ(spread.median, 50);
    EXPECT_EQ(spread.p95, 95);
    EXPECT_EQ(spread_of({3}).p95, 3);
}

TEST(Bench, SampledInstancesReachTheLastOne) {
    for (const uint32_t count : {1u, 5u, 16u, 17u, 1000u}) {
        std::vector<uint32_t> seen;
        const double largest = largest_error_of_some(count, [&](uint32_t instance) {
            seen.push_back(instance);
            return instance;
        });
        EXPECT_EQ(seen.size(), std::min(16u, count));
        EXPECT_TRUE(std::ranges::is_sorted(seen, std::ranges::less_equal())) << "one twice";
        EXPECT_EQ(largest, count - 1) << "the last";
    }
}

TEST(Bench, RoundsAlternateAndSlowOnesStop) {
    std::string order;
    const auto timed_run = [&](char name, int milliseconds) {
        return TimedRun{std::string(1, name), [&order, name, milliseconds] {
                            order += name;
                            std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
                        }};
    };
    run_rounds(std::vector{timed_run('a', 0), timed_run('b', 30)}, {.samples = 5, .min_samples = 2}, 0.05, kBenchQuiet);
    EXPECT_EQ(order, "ababaaa");
    order.clear();
    run_rounds(std::vector{timed_run('a', 0), timed_run('b', 0)}, {.samples = 3, .min_samples = 2}, 10, kBenchQuiet);
    EXPECT_EQ(order, "ababab");
}

TEST(Bench, TheCheckSeesOneWrongNumberAnywhere) {
    const ScanRig rig(make_skeleton(SkeletonShape::kRandom, 20, 6, 1), true);
    const PoseSet poses(rig, 3, 1);
    for (const ScanLayout layout : {ScanLayout::kCharacterMajor, ScanLayout::kTransposed}) {
        constexpr uint32_t kFirst = 5, kInstances = 7;
        std::vector<Affine> model(kInstances * 20);
        for (uint32_t instance = 0; instance < kInstances; ++instance)
            for (uint32_t joint = 0; joint < 20; ++joint)
                model[layout == ScanLayout::kTransposed ? joint * kInstances + instance : instance * 20 + joint] =
                    poses.wanted[(kFirst + instance) % 3 * 20 + joint].as<float>();
        const auto error = [&] { return max_error(model, poses, kFirst, kInstances, layout); };
        EXPECT_FALSE(is_wrong(error()));
        for (const size_t i : {size_t{0}, size_t{77}, model.size() - 1})
            for (const size_t column : {1u, 3u}) {
                const Affine before = model[i];
                model[i].row[1][column] += static_cast<float>((column == 3 ? poses.extent : 1) * 2e-5);
                EXPECT_TRUE(is_wrong(error())) << i;
                EXPECT_NEAR(error(), 2e-5, 1e-6);
                model[i].row[1][column] = std::numeric_limits<float>::quiet_NaN();
                EXPECT_TRUE(std::isnan(error()));
                model[i] = before;
            }
        EXPECT_FALSE(is_wrong(error()));
    }
}

// Deliberately broken rows of the table: the kernels are correct, but they get wrong skeletons.
ScanPlan plan_with_another_parent(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    ScanRig other = rig;
    other.parents.back() = 0;
    return find_scan_method("gateau2012_walk")->plan(other, limits, threads);
}
ScanPlan plan_without_work(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    ScanPlan plan = find_scan_method("serial")->plan(rig, limits, threads);
    plan.links[0] = 0;  // the first link holds the number of runs
    return plan;
}
ScanMethod broken(std::string_view name, ScanPlan (*plan)(const ScanRig&, const ScanLimits&, uint32_t)) {
    ScanMethod method = *find_scan_method(name);
    method.plan = plan;
    return method;
}
Candidate candidate_of(const std::string& name, const ScanMethod& method) {
    Candidate candidate{name, {}};
    for (const uint32_t threads : method.thread_choices(scan_limits(*test_gpu())))
        candidate.choices.push_back({&method, threads});
    return candidate;
}

const ScanCell kCell{.experiment = "levels", .characters = 150, .joints = 40, .levels = 12, .seed = 1};
const Sampling kSampling{.samples = 3, .min_samples = 1, .budget_s = 60};

TEST(Bench, AWrongMethodIsReportedAndNotTimed) {
    const ScanMethod one_joint = broken("gateau2012_walk", plan_with_another_parent),
                     nothing = broken("serial", plan_without_work);
    const std::vector<Candidate> candidates{candidate_of("one joint", one_joint),
                                            candidate_of("right", *find_scan_method("serial")),
                                            candidate_of("nothing", nothing)};
    const auto records = measure_scans(test_gpu(), kCell, candidates, kSampling, kBenchQuiet);
    ASSERT_EQ(records.size(), 3u);
    for (const size_t wrong : {0u, 2u}) {
        EXPECT_EQ(records[wrong]["method"], candidates[wrong].name);
        EXPECT_EQ(records[wrong]["wrong"], true);
        for (const char* field : {"median_ms", "samples", "times_copy", "ns_per_joint"})
            EXPECT_FALSE(records[wrong].contains(field)) << field;
    }
    EXPECT_GT(records[0]["max_error"], kErrorBound);
    EXPECT_TRUE(std::isnan(records[2]["max_error"].get<double>())) << "what was not written must not pass";
    EXPECT_FALSE(records[1].contains("wrong"));
    EXPECT_LE(records[1]["max_error"], kErrorBound);
    EXPECT_EQ(records[1]["samples"], 3);
    EXPECT_GT(records[1]["median_ms"], 0);

    const auto on_chip = measure_on_chip(test_gpu(), kCell, std::span(candidates).first(1), kSampling, kBenchQuiet);
    EXPECT_EQ(on_chip[0]["wrong"], true);
    EXPECT_FALSE(on_chip[0].contains("on_chip_ns_per_joint"));
}

// Every row of the table, in both measurements, is correct and timed, or gives a reason why not. A method with more
// than two thread counts runs only the first, since each is compiled separately; scan_test runs all of them.
TEST(Bench, EveryMethodIsMeasured) {
    std::vector<Candidate> candidates;
    for (const ScanMethod& method : scan_table()) {
        candidates.push_back(candidate_of(std::string(method.name), method));
        if (candidates.back().choices.size() > 2) candidates.back().choices.resize(1);
    }
    const auto records = measure_scans(test_gpu(), kCell, candidates, kSampling, kBenchQuiet),
               on_chip = measure_on_chip(test_gpu(), kCell, candidates, kSampling, kBenchQuiet);
    ASSERT_EQ(records.size(), candidates.size());
    ASSERT_EQ(on_chip.size(), candidates.size());
    size_t timed = 0, timed_on_chip = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
        for (const auto* list : {&records, &on_chip})
            EXPECT_FALSE((*list)[i].contains("wrong")) << candidates[i].name << ", error " << (*list)[i]["max_error"];
        EXPECT_NE(records[i].contains("median_ms"), records[i].contains("unsupported_reason")) << records[i];
        EXPECT_NE(on_chip[i].contains("on_chip_ns_per_joint"), on_chip[i].contains("unsupported_reason")) << on_chip[i];
        timed += records[i].contains("median_ms") ? 1 : 0;
        timed_on_chip += on_chip[i].contains("on_chip_ns_per_joint") ? 1 : 0;
    }
    std::printf("  %zu methods timed, %zu on-chip\n", timed, timed_on_chip);
    EXPECT_GE(timed, 5u);
    EXPECT_GE(timed_on_chip, 3u);
}

// More characters than one buffer holds: 157 MB of matrices, and lavapipe binds 134 at most. All are checked, also
// those of the last batch.
TEST(Bench, BatchesAreCheckedToo) {
    const ScanCell cell{.experiment = "levels", .characters = 1100, .joints = 3000, .levels = 30, .seed = 1};
    ScanCrowd crowd(test_gpu(), cell.rig(), cell.characters, cell.seed);
    std::printf("  %u batches\n", crowd.batch_count());
    const ScanMethod& serial = *find_scan_method("serial");
    const ScanStage stage(test_gpu(), {&serial, 0}, cell.rig(), scan_limits(*test_gpu()));
    crowd.poison();
    for (uint32_t batch = 0; batch < crowd.batch_count(); ++batch) {
        EXPECT_TRUE(is_wrong(crowd.max_error(serial.layout))) << "batch " << batch << " has not run yet";
        const Bindings bindings = stage.bind(crowd.buffers(batch, serial, stage.links()));
        test::run_on_gpu(
            [&](VkCommandBuffer commands) { stage.record(commands, bindings, crowd.batch(batch).instance_count); });
    }
    EXPECT_FALSE(is_wrong(crowd.max_error(serial.layout)));
}

}  // namespace
}  // namespace throng::bench
