// The planner: what it chooses, what it says, and the costs that it chooses by.
#include "base/failure.h"
#include "bench/scan_fit.h"
#include "bench/skeletons.h"
#include "scan/scan_planner.h"
#include "tests/shared.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace throng {
namespace {

using namespace test;

constexpr ScanLimits kSoftware{
    .shared_memory_bytes = 32768, .workgroup_size = 1024, .subgroup_size = 8, .shuffle = true, .is_cpu = true};
constexpr ScanLimits kHardware{
    .shared_memory_bytes = 49152, .workgroup_size = 1024, .subgroup_size = 32, .shuffle = true, .is_cpu = false};
const ScanCosts kSoftwareCosts{.launch_ms = 0.1,
                               .row_ns = 40,
                               .multiplication_ns = 20,
                               .barrier_ns = 500,
                               .workgroup_ns = 300,
                               .latency_ns = 1e-3,
                               .units = 2,
                               .resident_subgroups = 1e9,
                               .bytes_per_ns = 20,
                               .origin = "test"};
const ScanCosts kHardwareCosts{.launch_ms = 0.003,
                               .row_ns = 2.4,
                               .multiplication_ns = 5.3,
                               .barrier_ns = 20,
                               .workgroup_ns = 50,
                               .latency_ns = 130,
                               .units = 80,
                               .resident_subgroups = 2560,
                               .bytes_per_ns = 800,
                               .origin = "test"};

// Numbered depth first, as the compiler does.
ScanRig random_rig(uint32_t joint_count, bool uniform_scale) {
    return ScanRig(bench::make_skeleton(bench::SkeletonShape::kRandom, joint_count, joint_count / 5, 1), uniform_scale);
}

template <class Body>
Error error_from(Body&& body) {
    try {
        body();
    } catch (const Failure& failure) {
        return failure.error;
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

TEST(Planner, ASoftwareDeviceWalksCharactersOneByOne) {
    EXPECT_EQ(name_of(choose_scan("auto", random_rig(300, true), 10'000, kSoftware, kSoftwareCosts).choice),
              "serial_quaternion");
    EXPECT_EQ(name_of(choose_scan("auto", random_rig(300, false), 10'000, kSoftware, kSoftwareCosts).choice), "serial");
}

TEST(Planner, OneLargeCharacterIsSharedByManyInvocations) {
    for (const auto& [limits, costs] : {std::pair{kSoftware, kSoftwareCosts}, {kHardware, kHardwareCosts}}) {
        const ExplainedChoice chosen = choose_scan("auto", random_rig(1000, false), 1, limits, costs);
        EXPECT_NE(chosen.choice.method->name, "serial") << chosen.reason;
        EXPECT_NE(chosen.choice.method->name, "gateau2012_walk") << chosen.reason;
    }
}

TEST(Planner, AGpuDoesNotWalkDeepSkeletonsJointByJoint) {
    const ExplainedChoice chosen = choose_scan("auto", ScanRig(make_parents(RigShape::kChain, 300)), 10'000, kHardware,
                                               kHardwareCosts);
    EXPECT_EQ(chosen.choice.method->origin, ScanOrigin::kOurs) << name_of(chosen.choice) << ": " << chosen.reason;
}

TEST(Planner, SortsItsPredictionsAndLeavesOutWhatDoesNotApply) {
    const std::vector<ScanPrediction> all = predict_scans(random_rig(300, false), 1000, kSoftware, kSoftwareCosts);
    ASSERT_GT(all.size(), 5u);
    for (size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(all[i].choice.method->format, ScanFormat::kAffine);
        EXPECT_EQ(all[i].choice.method->layout, ScanLayout::kCharacterMajor);
        EXPECT_GT(all[i].milliseconds, 0);
        if (i > 0) {
            EXPECT_LE(all[i - 1].milliseconds, all[i].milliseconds);
        }
    }
}

TEST(Planner, TakesWhatIsAskedFor) {
    const ScanRig rig = random_rig(100, false);
    EXPECT_EQ(name_of(choose_scan("compressed", rig, 10, kSoftware, kSoftwareCosts).choice), "compressed");
    EXPECT_EQ(name_of(choose_scan("subgroup:4", rig, 10, kSoftware, kSoftwareCosts).choice), "subgroup:4");
    EXPECT_EQ(choose_scan("subgroup", rig, 100'000, kSoftware, kSoftwareCosts).choice.threads, 1u)
        << "without lanes, the fastest ones";
    EXPECT_EQ(choose_scan("subgroup", rig, 1, kSoftware, kSoftwareCosts).choice.threads, 8u);
}

TEST(Planner, RefusesWhatDoesNotExistOrApply) {
    const auto refused = [](const std::string& wanted, ErrorCode code, const std::string& part) {
        const Error error = error_from(
            [&] { choose_scan(wanted, random_rig(100, false), 10, kSoftware, kSoftwareCosts); });
        EXPECT_EQ(error.code, code) << wanted;
        EXPECT_NE(error.text().find(part), std::string::npos) << error.text();
        EXPECT_NE(error.text().find(wanted), std::string::npos) << error.text();
    };
    refused("quick", ErrorCode::kInvalidArgument, "gateau2012_walk");
    refused("subgroup:", ErrorCode::kInvalidArgument, "behind the colon");
    refused("subgroup:8x", ErrorCode::kInvalidArgument, "behind the colon");
    refused("subgroup:3", ErrorCode::kUnsupported, "1, 2, 4, 8");
    refused("serial_quaternion", ErrorCode::kUnsupported, "scale");
    refused("serial_transposed", ErrorCode::kUnsupported, "transposed");
}

TEST(Planner, SaysWhyInOneLine) {
    const std::string reason = choose_scan("auto", random_rig(300, false), 1000, kSoftware, kSoftwareCosts).reason;
    EXPECT_NE(reason.find("1000 x 300 joints"), std::string::npos) << reason;
    EXPECT_NE(reason.find("next "), std::string::npos) << reason;
    EXPECT_EQ(reason.find('\n'), std::string::npos);
}

// What can be chosen for a rig. It does not depend on the costs, and takes longer than to choose by them.
class Plans {
public:
    Plans(const ScanRig& rig, const ScanLimits& limits) : rig_(rig), limits_(limits) {
        for (const ScanMethod& method : scan_table()) {
            if (method.layout != ScanLayout::kCharacterMajor) continue;
            for (const uint32_t threads : planned_choices(method, limits))
                plans_.push_back({{&method, threads}, plan_scan(method, rig, limits, threads)});
        }
        std::erase_if(plans_, [](const Planned& planned) { return !planned.plan.unsupported_reason.empty(); });
    }

    struct Planned {
        ScanChoice choice;
        ScanPlan plan;
    };
    struct Fastest {
        const Planned& planned;
        double milliseconds;
    };
    // As choose_scan("auto") has it.
    Fastest fastest(uint32_t instance_count, const ScanCosts& costs) const {
        const auto predicted_ms = [&](const Planned& planned) {
            return predict_ms(planned.plan, rig_, *planned.choice.method, instance_count, limits_, costs);
        };
        const Planned& least = *std::ranges::min_element(plans_, {}, predicted_ms);
        return {least, predicted_ms(least)};
    }

private:
    ScanRig rig_;
    ScanLimits limits_;
    std::vector<Planned> plans_;
};

// A GPU with many characters waits for memory, however deep they are; one with few has invocations to spare.
TEST(Planner, AGpuStreamsManyAndSharesFew) {
    for (const uint32_t levels : {15u, 30u, 60u, 120u}) {
        const ScanRig rig(bench::make_skeleton(bench::SkeletonShape::kRandom, 300, levels, 1), true);
        const Plans plans(rig, kHardware);
        for (const uint32_t vendor : {0x10DEu, 0x1002u, 0x8086u, 0u}) {
            SCOPED_TRACE(testing::Message() << levels << " levels, vendor " << vendor);
            const ScanCosts costs = built_in_hardware_costs(vendor);
            const Plans::Fastest many = plans.fastest(10'000, costs), few = plans.fastest(1, costs);
            EXPECT_EQ(name_of(many.planned.choice), "stream_quaternion:32") << "an H200 takes longer with fewer";
            EXPECT_GT(few.planned.plan.workgroup_size, 64u) << name_of(few.planned.choice);
            const double bytes = 10'000.0 * 300 * (32 + 48);
            EXPECT_NEAR(many.milliseconds, bytes / costs.bytes_per_ns * 1e-6, 0.05 * bytes / costs.bytes_per_ns * 1e-6);
            if (vendor != 0 || levels != 15) continue;
            for (const uint32_t instance_count : {1u, 10'000u})
                EXPECT_EQ(name_of(choose_scan("auto", rig, instance_count, kHardware, costs).choice),
                          name_of(plans.fastest(instance_count, costs).planned.choice));
        }
    }
}

TEST(ScanCosts, AreReadAsTheyAreWritten) {
    const ScanCosts read = scan_costs_from_json(to_json(kHardwareCosts), "test");
    EXPECT_EQ(to_json(read), to_json(kHardwareCosts));
    std::string text = to_json(kHardwareCosts);
    for (const std::string& damaged :
         {std::string(text).replace(text.find("\"test\""), 6, "7"), text.substr(0, 40), std::string("[]"),
          std::string("nonsense"), std::string(text).replace(text.find("2.4"), 3, "-24"),
          std::string(text).replace(text.find("2.4"), 3, "\"2\"")}) {
        const Error error = error_from([&] { scan_costs_from_json(damaged, "costs.json"); });
        EXPECT_EQ(error.code, ErrorCode::kInvalidFile);
        EXPECT_NE(error.text().find("costs.json"), std::string::npos);
    }
}

// Times that follow the model exactly lead back to constants that predict them.
TEST(ScanTune, FindsTheCostsBehindObservations) {
    for (const auto& [limits, truth, start] : {std::tuple{kSoftware, kSoftwareCosts, kHardwareCosts},
                                               std::tuple{kHardware, kHardwareCosts, kSoftwareCosts}}) {
        if (kSanitized && limits.is_cpu) continue;  // the other one fits more constants
        ScanCosts from = start;
        if (limits.is_cpu)
            from.units = truth.units, from.resident_subgroups = truth.resident_subgroups,
            from.latency_ns = truth.latency_ns, from.bytes_per_ns = truth.bytes_per_ns;
        std::vector<bench::ScanObservation> observations;
        for (const uint32_t joints : {32u, 300u})
            for (const uint32_t characters : {1u, 100u, 10'000u})
                for (const ScanPrediction& p : predict_scans(random_rig(joints, true), characters, limits, truth))
                    observations.push_back({p.choice, random_rig(joints, true), characters, p.milliseconds});
        EXPECT_GT(bench::typical_factor(observations, limits, from), 1.5)
            << "the start is far off, or this test shows nothing";
        const ScanCosts fitted = bench::fit_scan_costs(observations, limits, from);
        EXPECT_LT(bench::typical_factor(observations, limits, fitted), 1.1) << to_json(fitted);
    }
}

}  // namespace
}  // namespace throng
