// The planner: which scan methods it chooses, its explanations, and the costs behind its choices.
#include "base/failure.h"
#include "bench/scan_fit.h"
#include "bench/skeletons.h"
#include "scan/scan_planner.h"
#include "tests/shared.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

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

// Numbered depth first, as by the compiler.
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

TEST(Planner, UsesTheRequestedMethod) {
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
    refused("subgroup:", ErrorCode::kInvalidArgument, "the colon must be followed by the number");
    refused("subgroup:8x", ErrorCode::kInvalidArgument, "the colon must be followed by the number");
    refused("subgroup:3", ErrorCode::kUnsupported, "1, 2, 4, 8");
    refused("serial_quaternion", ErrorCode::kUnsupported, "scale");
    refused("serial_transposed", ErrorCode::kUnsupported, "transposed");
}

TEST(Planner, ExplainsItsChoiceInOneLine) {
    const std::string reason = choose_scan("auto", random_rig(300, false), 1000, kSoftware, kSoftwareCosts).reason;
    EXPECT_NE(reason.find("1000 x 300 joints"), std::string::npos) << reason;
    EXPECT_NE(reason.find("next "), std::string::npos) << reason;
    EXPECT_EQ(reason.find('\n'), std::string::npos);
}

// With many characters a GPU is bound by memory, however deep the skeletons are. With few it has idle invocations.
TEST(Planner, AGpuStreamsManyCharactersAndSharesFew) {
    for (const uint32_t vendor : {0x10DEu, 0x1002u, 0x8086u, 0u}) {
        const ScanCosts costs = built_in_hardware_costs(vendor);
        for (const uint32_t levels : {15u, 30u, 60u, 120u}) {
            if (kSanitized && levels > 15) break;  // planning uses the same code for all of them
            const ScanRig rig(bench::make_skeleton(bench::SkeletonShape::kRandom, 300, levels, 1), true);
            const ExplainedChoice many = choose_scan("auto", rig, 10'000, kHardware, costs),
                                  few = choose_scan("auto", rig, 1, kHardware, costs);
            EXPECT_EQ(many.choice.method->name, "stream_quaternion") << many.reason;
            EXPECT_EQ(many.choice.threads, 32u) << "an H200 takes longer with fewer";
            EXPECT_GT(plan_scan(*few.choice.method, rig, kHardware, few.choice.threads).workgroup_size, 64u)
                << few.reason;
            const double bytes = 10'000.0 * 300 * (32 + 48);
            EXPECT_NEAR(predict_scans(rig, 10'000, kHardware, costs).front().milliseconds,
                        bytes / costs.bytes_per_ns * 1e-6, 0.05 * bytes / costs.bytes_per_ns * 1e-6);
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

// From times that follow the model exactly, tuning must find constants that predict them.
TEST(ScanTune, FindsTheCostsBehindObservations) {
    for (const auto& [limits, truth, start] : {std::tuple{kSoftware, kSoftwareCosts, kHardwareCosts},
                                               std::tuple{kHardware, kHardwareCosts, kSoftwareCosts}}) {
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
