// Every scan method against the reference. Rotations by quarter turns and integer translations make every product exact in
// float, so that a method must give the reference's very numbers, whatever its order of association.
#include "scan/scan.h"
#include "scan/scan_reference.h"
#include "tests/kernel_runner.h"
#include "tests/test_rig.h"

#include <cstdio>
#include <map>
#include <string>

namespace throng {
namespace {

using namespace test;

constexpr std::array<uint32_t, 17> kJointCounts{1, 2, 7, 8, 9, 31, 32, 33, 63, 64, 65, 255, 256, 257, 300, 1024, 2000};
constexpr std::array<uint32_t, 3> kInstanceCounts{1, 3, 1000};
constexpr uint32_t kMatrixLimit = 60'000;  // joints x instances, so that the suite stays fast

// Transforms of several instances of one rig, and what the reference makes of them.
struct RigCrowd {
    std::vector<uint32_t> parents;
    std::vector<Affine> local;              // [instance][joint]
    std::vector<AffineT<double>> wanted;    // the same

    template <class Transform>
    RigCrowd(std::vector<uint32_t> parents_in, uint32_t instance_count, const Transform& transform) : parents(std::move(parents_in)) {
        for (uint32_t instance = 0; instance < instance_count; ++instance) {
            std::vector<AffineT<double>> parent_from_joint;
            for (size_t joint = 0; joint < parents.size(); ++joint) {
                local.push_back(transform());
                parent_from_joint.push_back(local.back().as<double>());
            }
            const auto model = scan_reference(parents, parent_from_joint);
            wanted.insert(wanted.end(), model.begin(), model.end());
        }
    }
    uint32_t joint_count() const { return static_cast<uint32_t>(parents.size()); }
};

// What a method gives for the first `instance_count` instances.
std::vector<Affine> run_scan(const ScanStage& stage, const RigCrowd& crowd, uint32_t instance_count) {
    const size_t count = size_t{crowd.joint_count()} * instance_count;
    const std::vector<Affine> input(crowd.local.begin(), crowd.local.begin() + static_cast<ptrdiff_t>(count));
    const Guarded<Affine> local(input), model(poison<Affine>(count)), scratch(poison<Affine>(count));
    const Bindings bindings = stage.bind({.local = local, .links = stage.links(), .model = model, .scratch = scratch});
    run_on_gpu([&](VkCommandBuffer commands) { stage.record(commands, bindings, instance_count); });
    EXPECT_TRUE(same_bits(local.read(), input)) << "the method wrote its input";
    scratch.read();  // for the guard words
    return model.read();
}

// Equal as numbers, so that the two zeros are one; never for a NaN.
size_t count_different(const std::vector<Affine>& got, const std::vector<AffineT<double>>& wanted) {
    size_t different = 0;
    for (size_t i = 0; i < got.size(); ++i) different += got[i].as<double>() == wanted[i] ? 0 : 1;
    return different;
}

std::string place(const ScanMethod& method, RigShape shape, uint32_t joint_count, uint32_t instance_count) {
    return std::string(method.name) + ", " + std::string(name_of(shape)) + " of " + std::to_string(joint_count) + " joints, " + std::to_string(instance_count) + " instances";
}

TEST(Scan, EveryMethodIsExact) {
    std::map<std::string_view, std::pair<size_t, size_t>> compared;  // cases, matrices
    uint64_t seed = 0;
    for (const uint32_t joint_count : kJointCounts) {
        for (const RigShape shape : kRigShapes) {
            Random random(++seed);
            const uint32_t most = std::max(std::min(kInstanceCounts.back(), kMatrixLimit / joint_count), kInstanceCounts[1]);
            const RigCrowd crowd(make_parents(shape, joint_count, seed), most, [&] { return exact_transform(random); });
            for (const ScanMethod& method : scan_table()) {
                const ScanStage stage(test_gpu(), method, crowd.parents);
                for (const uint32_t wanted_count : kInstanceCounts) {
                    const uint32_t instance_count = std::min(wanted_count, most);
                    const std::vector<Affine> model = run_scan(stage, crowd, instance_count);
                    ASSERT_EQ(count_different(model, crowd.wanted), 0u) << place(method, shape, joint_count, instance_count);
                    ++compared[method.name].first;
                    compared[method.name].second += model.size();
                }
            }
        }
    }
    for (const ScanMethod& method : scan_table()) {
        const auto [cases, matrices] = compared[method.name];
        std::printf("  %-22s %zu joint counts x %zu rigs x %zu instance counts = %zu cases, %zu matrices, equal bit for bit\n", std::string(method.name).c_str(),
                    kJointCounts.size(), kRigShapes.size(), kInstanceCounts.size(), cases, matrices);
        EXPECT_EQ(cases, kJointCounts.size() * kRigShapes.size() * kInstanceCounts.size());
    }
}

TEST(Scan, EveryMethodIsExactForTheLargestRigs) {
    struct Case {
        RigShape shape;
        uint32_t joint_count, instance_count;
    };
    for (const Case& c : {Case{RigShape::kChain, 5000, 2}, Case{RigShape::kRandom, 5000, 3}, Case{RigShape::kRandom, 65535, 1}, Case{RigShape::kBushy, 65535, 2}}) {
        Random random(c.joint_count);
        const RigCrowd crowd(make_parents(c.shape, c.joint_count, 7), c.instance_count, [&] { return exact_transform(random); });
        for (const ScanMethod& method : scan_table()) {
            const ScanStage stage(test_gpu(), method, crowd.parents);
            const std::vector<Affine> model = run_scan(stage, crowd, c.instance_count);
            EXPECT_EQ(count_different(model, crowd.wanted), 0u) << place(method, c.shape, c.joint_count, c.instance_count);
            std::printf("  %s: %zu matrices, equal bit for bit\n", place(method, c.shape, c.joint_count, c.instance_count).c_str(), model.size());
        }
    }
}

// Rotation, translation and non-uniform scale near 1: rounding differs between the methods, and stays small.
TEST(Scan, EveryMethodRoundsLittle) {
    constexpr double kBound = 1e-5;  // of the crowd's extent
    for (const uint32_t joint_count : {20u, 64u, 300u, 1024u}) {
        for (const RigShape shape : kRigShapes) {
            Random random(joint_count);
            const RigCrowd crowd(make_parents(shape, joint_count), 5, [&] { return to_affine(random.trs(1, 0.02)).as<float>(); });
            double size = 1;
            for (const auto& m : crowd.wanted) size = std::max({size, std::abs(m.row[0][3]), std::abs(m.row[1][3]), std::abs(m.row[2][3])});
            for (const ScanMethod& method : scan_table()) {
                const std::vector<Affine> model = run_scan(ScanStage(test_gpu(), method, crowd.parents), crowd, 5);
                double worst = 0;
                for (size_t i = 0; i < model.size(); ++i) worst = std::max(worst, matrix_error(model[i], crowd.wanted[i], size));
                EXPECT_LE(worst, kBound) << place(method, shape, joint_count, 5);
            }
        }
    }
}

TEST(Scan, TheTableNamesItsMethods) {
    ASSERT_FALSE(scan_table().empty());
    for (const ScanMethod& method : scan_table()) {
        EXPECT_EQ(find_scan_method(method.name), &method) << "two rows have one name";
        EXPECT_FALSE(method.summary.empty());
        EXPECT_FALSE(method.source.empty());
    }
    EXPECT_EQ(find_scan_method("no such method"), nullptr);
    EXPECT_EQ(scan_methods().size(), scan_table().size());
}

// parent_from_joint of a child stands on the right; two rotations that do not commute tell the sides apart.
TEST(Scan, TheReferenceMultipliesParentFirst) {
    Affine turn_x, turn_z;
    turn_x.row = {{{1, 0, 0, 1}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    turn_z.row = {{{0, -1, 0, 2}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
    const auto model = scan_reference(std::vector<uint32_t>{kNone, 0}, std::vector{turn_x.as<double>(), turn_z.as<double>()});
    const Vec3<double> wanted{1 + 2 - 5, -7, 3};  // (3, 5, 7) turned about z and moved, then about x and moved
    EXPECT_EQ(transform_point(model[1], Vec3<double>{3, 5, 7}), wanted);
}

}  // namespace
}  // namespace throng
