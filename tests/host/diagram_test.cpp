// The simulations behind the diagrams, with lists of joints in place of transforms: each method builds each joint's
// chain in order, with exactly the multiplications that its plan counts. Also, docs/scan contains the current diagrams.
#include "bench/diagrams/diagram.h"
#include "bench/skeletons.h"
#include "tests/files.h"
#include "tests/shared.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace throng::bench {
namespace {

// At most this many, so that a workgroup has an invocation per joint and no thread in a diagram works for two joints.
constexpr uint32_t kMaxJoints = 256;
const ScanLimits kLimits{.shared_memory_bytes = 48 << 10, .workgroup_size = 1024, .subgroup_size = 32, .shuffle = true};

std::vector<ScanRig> rigs() {
    std::vector<ScanRig> out{diagram_rig(), ScanRig(std::vector<uint32_t>{kNone}),
                             ScanRig(std::vector<uint32_t>{kNone, kNone, 0, 1, 1})};
    for (const SkeletonShape shape : kSkeletonShapes)
        for (const uint32_t joints : {9u, 65u, kMaxJoints})
            out.emplace_back(make_skeleton(shape, joints, joints / 3, 7));
    return out;
}

std::vector<ScanMethod> flow_methods() {
    std::vector<ScanMethod> methods(scan_table().begin(), scan_table().end());
    std::erase_if(methods, [](const ScanMethod& method) { return !method.picture.simulate; });
    EXPECT_GE(methods.size(), 9u);
    return methods;
}

TEST(Diagram, EveryMethodMakesEachJointsChain) {
    THRONG_SKIP_WHERE_SANITIZED();  // TheDocumentationIsUpToDate covers the simulation of each method there
    for (const ScanMethod& method : flow_methods())
        for (const ScanRig& rig : rigs())
            for (const FlowSettings& settings : {FlowSettings{}, kDiagramSettings}) {
                const Flow flow = method.picture.simulate(rig, settings);
                SCOPED_TRACE(std::string(method.name) + ", " + std::to_string(rig.joint_count()) + " joints");
                std::vector<Product> chains;
                for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
                    chains.push_back(rig.parents[joint] == kNone ? Product{} : chains[rig.parents[joint]]);
                    chains.back().push_back(joint);
                }
                ASSERT_EQ(flow.model, chains);
                for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) ASSERT_NE(flow.writers[joint], kNone);
            }
}

// A step's left factor ends directly above where the right factor begins, and each joint is stored once.
TEST(Diagram, StepsAreMultiplicationsOfNeighboursInTheTree) {
    THRONG_SKIP_WHERE_SANITIZED();
    for (const ScanMethod& method : flow_methods())
        for (const ScanRig& rig : rigs()) {
            SCOPED_TRACE(method.name);
            const Flow flow = method.picture.simulate(rig, kDiagramSettings);
            std::multiset<uint32_t> stored;
            std::set<std::tuple<uint32_t, uint32_t, uint32_t>> turns;
            for (const FlowStep& step : flow.steps) {
                for (size_t i = 1; i < step.product.size(); ++i)
                    ASSERT_EQ(rig.parents[step.product[i]], step.product[i - 1]);
                ASSERT_EQ(step.source == FlowSource::kIdentity, step.source_joint == kNone);
                if (step.source_joint != kNone) {
                    ASSERT_EQ(step.product[step.source_length - 1], step.source_joint);
                }
                ASSERT_TRUE(turns.emplace(step.phase, step.thread, step.row).second)
                    << "a thread does one thing at a time";
                if (step.stored) stored.insert(step.joint);
            }
            for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) ASSERT_LE(stored.count(joint), 1u) << joint;
        }
}

TEST(Diagram, CountsAreThePlans) {
    THRONG_SKIP_WHERE_SANITIZED();
    for (const ScanMethod& method : flow_methods())
        for (const ScanRig& rig : rigs())
            for (const uint32_t threads : {16u, 32u}) {
                const bool has_threads = method.thread_choices(kLimits).front() != 0;
                const ScanPlan plan = plan_scan(method, rig, kLimits, has_threads ? threads : 0);
                ASSERT_EQ(plan.unsupported_reason, "");
                // Diagrams show one character
                if (has_threads && plan.instances_per_workgroup * threads > plan.workgroup_size) continue;
                const Flow flow = method.picture.simulate(rig, {.threads = threads});
                SCOPED_TRACE(std::string(method.name) + ", " + std::to_string(rig.joint_count()) + " joints, " +
                             std::to_string(rig.level_count) + " levels");
                EXPECT_EQ(flow.steps.size(), plan.counts.multiplications);
                EXPECT_EQ(flow.longest_thread(), plan.counts.longest_thread);
                EXPECT_EQ(flow.barriers(), plan.counts.barriers);
            }
}

// Methods that are throng's own may lack a diagram.
TEST(Diagram, EveryMethodOfThePaperHasAPicture) {
    std::set<std::string> pictures;
    for (const Diagram& diagram : scan_diagrams()) EXPECT_TRUE(pictures.insert(diagram.name).second) << diagram.name;
    for (const ScanMethod& method : scan_table())
        EXPECT_TRUE(method.origin != ScanOrigin::kPaper || pictures.contains(std::string(method.name))) << method.name;
}

TEST(Diagram, TheDocumentationIsUpToDate) {
    for (const Diagram& diagram : scan_diagrams()) {
        const std::string text = test::read_file(std::string(THRONG_SOURCE_DIR) + "/docs/scan/" + diagram.name +
                                                 ".svg");
        EXPECT_TRUE(text == diagram.svg) << diagram.name << ": run throng bench diagrams --out docs/scan";
    }
}

}  // namespace
}  // namespace throng::bench
