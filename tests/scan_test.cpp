// Every scan method against the reference. Quarter turns, Hurwitz quaternions and integer translations make every
// product exact in float, so a method must match the reference exactly, whatever its order of association.
#include "bench/on_chip_shaders.h"
#include "base/failure.h"
#include "scan/scan.h"
#include "scan/scan_reference.h"
#include "scan/scan_shaders.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <bit>
#include <cstdio>
#include <functional>
#include <map>
#include <ranges>
#include <set>
#include <string>
#include <utility>

namespace throng {
namespace {

// Tests that cover each method, not the whole grid: GPU-assisted validation instruments every pipeline, and scans
// create one per skeleton.
const test::InSubset kScanUnderValidation({test::Subset::kGpuAssisted},
                                          {"Scan/OnChip.*/random", "Scan.EveryMethodIsExactWithout64BitWords"});
const test::InSubset kScanWithOtherSubgroups({test::Subset::kSubgroups}, {"Scan.EveryNumberOfThreadsIsExact"});
const test::InSubset kScanInBoth({test::Subset::kSubgroups, test::Subset::kWideSubgroups},
                                 {"Scan.EveryMethodRoundsLittle"});
const test::InSubset kScanNatively({test::Subset::kNative},
                                   {"Scan.EveryMethodIsExact", "Scan.EveryMethodIsExactForTheLargestRigs",
                                    "Scan.EveryMethodRoundsLittle"});

using namespace test;

constexpr std::array<uint32_t, 17> kScanJointCounts{1,  2,  7,   8,   9,   31,  32,   33,  63,
                                                    64, 65, 255, 256, 257, 300, 1024, 2000};
constexpr std::array<uint32_t, 3> kInstanceCounts{1, 3, 1000};
constexpr uint32_t kMatrixLimit = 20'000;  // joints x instances, so that the suite stays fast

// A local transform as a method's format has it: three rows of a matrix, or rotation, then translation and scale.
struct Local {
    std::vector<std::array<float, 4>> rows;
    AffineT<double> affine;
};

Local as_local(const Affine& m) { return {{m.row.begin(), m.row.end()}, m.as<double>()}; }

Local as_local(const Trs<double>& similarity) {
    const auto q = similarity.rotation.as<float>();
    const auto t = similarity.translation.as<float>();
    const auto s = static_cast<float>(similarity.scale.x);
    const Trs<double> rounded{q.as<double>(), t.as<double>(), {s, s, s}};
    return {{{q.x, q.y, q.z, q.w}, {t.x, t.y, t.z, s}}, to_affine(rounded)};
}

// The rotation is one of the 24 Hurwitz units, which are closed under multiplication; the scale is 1 or -1.
Local exact_similarity(Random& random) {
    const auto sign = [&](double value) { return random.chance(0.5) ? value : -value; };
    std::array<double, 4> q{};
    if (const uint32_t kind = random.below(6); kind < 4)
        for (double& component : q) component = sign(0.5);
    else
        q[random.below(4)] = sign(1);
    const auto integer = [&] { return static_cast<double>(random.below(9)) - 4; };
    const double scale = sign(1), x = integer(), y = integer(), z = integer();
    return as_local(Trs<double>{{q[0], q[1], q[2], q[3]}, {x, y, z}, {scale, scale, scale}});
}

Local exact_local(Random& random, ScanFormat format) {
    return format == ScanFormat::kAffine ? as_local(exact_transform(random)) : exact_similarity(random);
}

// Transforms of several instances of one rig, and the reference's results.
struct RigCrowd {
    ScanRig rig;
    uint32_t instance_count;
    size_t rows_per_joint = 0;
    std::vector<std::array<float, 4>> rows;  // [instance][joint][rows_per_joint]
    std::vector<AffineT<double>> wanted;     // [instance][joint]

    RigCrowd(const std::vector<uint32_t>& parents, uint32_t instance_count_in, const std::function<Local()>& make_local)
        : rig(parents, true), instance_count(instance_count_in) {
        for (uint32_t instance = 0; instance < instance_count; ++instance) {
            std::vector<AffineT<double>> parent_from_joint;
            for (size_t joint = 0; joint < parents.size(); ++joint) {
                const Local local = make_local();
                rows_per_joint = local.rows.size();
                rows.insert(rows.end(), local.rows.begin(), local.rows.end());
                parent_from_joint.push_back(local.affine);
            }
            const auto model = scan_reference(parents, parent_from_joint);
            wanted.insert(wanted.end(), model.begin(), model.end());
        }
    }
};

// One for each format, so that every method finds its own.
struct ExactCrowds {
    RigCrowd affine, similarity;

    ExactCrowds(const std::vector<uint32_t>& parents, uint32_t instance_count, Random& random)
        : affine(parents, instance_count, [&] { return exact_local(random, ScanFormat::kAffine); }),
          similarity(parents, instance_count, [&] { return exact_local(random, ScanFormat::kSimilarity); }) {}
    const RigCrowd& of(const ScanMethod& method) const {
        return method.format == ScanFormat::kAffine ? affine : similarity;
    }
};

// [rows][columns][size] to [columns][rows][size]
template <class T>
std::vector<T> transposed(const std::vector<T>& in, size_t rows, size_t columns, size_t size) {
    std::vector<T> out;
    out.reserve(in.size());
    for (size_t column = 0; column < columns; ++column)
        for (size_t row = 0; row < rows; ++row) {
            const auto first = in.begin() + static_cast<ptrdiff_t>((row * columns + column) * size);
            out.insert(out.end(), first, first + static_cast<ptrdiff_t>(size));
        }
    return out;
}

// The buffers for the first `instance_count` instances, in the method's layout.
struct ScanRun {
    const RigCrowd& crowd;
    uint32_t instance_count;
    bool transpose;
    std::vector<std::array<float, 4>> input;
    Guarded<std::array<float, 4>> local;
    Guarded<Affine> model, scratch;
    Guarded<uint32_t> births;  // of crowds in which instances come and go: not these

    ScanRun(const RigCrowd& crowd_in, const ScanMethod& method, uint32_t instance_count_in)
        : crowd(crowd_in),
          instance_count(instance_count_in),
          transpose(method.layout == ScanLayout::kTransposed),
          input(make_input()),
          local(input),
          model(poison<Affine>(matrix_count())),
          scratch(poison<Affine>(matrix_count())),
          births(std::vector<uint32_t>()) {}
    size_t matrix_count() const { return size_t{crowd.rig.joint_count()} * instance_count; }
    BufferTable buffers(const Buffer& links) const {
        return {{io::kLocalBuffer, local},
                {io::kScanLinksBuffer, links},
                {io::kModelBuffer, model},
                {io::kScratchBuffer, scratch},
                {io::kBirthsBuffer, births}};
    }

    // [instance][joint]. Also checks the guard words and that the input is unchanged.
    std::vector<Affine> result() const {
        EXPECT_TRUE(same_bits(local.read(), input)) << "the method wrote its input";
        scratch.read();
        return transpose ? transposed(model.read(), crowd.rig.joint_count(), instance_count, 1) : model.read();
    }

private:
    std::vector<std::array<float, 4>> make_input() const {
        const auto end = crowd.rows.begin() + static_cast<ptrdiff_t>(matrix_count() * crowd.rows_per_joint);
        const std::vector<std::array<float, 4>> rows(crowd.rows.begin(), end);
        return transpose ? transposed(rows, instance_count, crowd.rig.joint_count(), crowd.rows_per_joint) : rows;
    }
};

std::vector<Affine> run_scan(const ScanStage& stage, const RigCrowd& crowd, uint32_t instance_count) {
    const ScanRun run(crowd, *stage.choice().method, instance_count);
    const Bindings bindings = stage.bind(run.buffers(stage.links()));
    run_on_gpu([&](VkCommandBuffer commands) { stage.record(commands, bindings, instance_count); });
    return run.result();
}

// Compares as numbers, so that the two zeros are equal and a NaN equals nothing.
size_t count_different(const std::vector<Affine>& got, const std::vector<AffineT<double>>& wanted) {
    size_t different = 0;
    for (size_t i = 0; i < got.size(); ++i) different += got[i].as<double>() == wanted[i] ? 0 : 1;
    return different;
}

ScanLimits device_limits() { return scan_limits(*test_gpu()); }

std::string place(const ScanChoice& choice, RigShape shape, uint32_t joint_count, uint32_t instance_count) {
    return std::string(choice.method->name) + ", " + std::to_string(choice.threads) + " lanes, " +
           std::string(name_of(shape)) + " of " + std::to_string(joint_count) + " joints, " +
           std::to_string(instance_count) + " instances";
}

// The methods that the device supports.
auto methods() {
    return scan_table() | std::views::filter([](const ScanMethod& method) { return has_scan(method.name); });
}

// Counts comparisons per method, and the cases that were skipped because the method does not apply.
class Tally {
public:
    void compared(const ScanMethod& method, size_t matrices) {
        ++rows_[method.name].cases;
        rows_[method.name].matrices += matrices;
    }
    void skipped(const ScanMethod& method, const std::string& unsupported_reason) {
        ++rows_[method.name].skips;
        rows_[method.name].unsupported_reason = unsupported_reason;
    }
    size_t cases(const ScanMethod& method) { return rows_[method.name].cases; }
    void print() {
        for (const ScanMethod& method : methods()) {
            const Row& row = rows_[method.name];
            std::printf("  %-22s %5zu cases, %9zu matrices, equal bit for bit", std::string(method.name).c_str(),
                        row.cases, row.matrices);
            if (row.skips > 0) std::printf("; %zu do not apply: %s", row.skips, row.unsupported_reason.c_str());
            std::printf("\n");
        }
    }

private:
    struct Row {
        size_t cases = 0, matrices = 0, skips = 0;
        std::string unsupported_reason;
    };
    std::map<std::string_view, Row> rows_;
};

// With many thousand joints, a method may refuse a rig for its loop iterations or its leaves' paths, and a thread count
// for too little shared memory. No other reason is accepted.
void expect_excusable(const std::string& unsupported_reason, const ScanChoice& choice, const ScanRig& rig,
                      const ScanLimits& limits, const std::string& where) {
    if (unsupported_reason.find("loop iterations") != std::string::npos) {
        EXPECT_GT(uint64_t{rig.joint_count()} * rig.level_count, limits.loop_iterations)
            << where << ": " << unsupported_reason;
        EXPECT_GT(rig.joint_count(), 2000u) << where << ": " << unsupported_reason;
        return;
    }
    uint64_t path_words = 0;
    std::vector<bool> has_child(rig.joint_count());
    for (const uint32_t parent : rig.parents)
        if (parent != kNone) has_child[parent] = true;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) path_words += has_child[joint] ? 0 : rig.depths[joint];
    if (choice.method->name == "kandar2024_leaves") {
        EXPECT_GT(path_words + 3 * rig.leaf_count + 1, uint64_t{16} << 20) << where << ": " << unsupported_reason;
    } else {
        EXPECT_GT(choice.threads, 0u) << where << ": " << unsupported_reason;
        EXPECT_NE(unsupported_reason.find("shared memory"), std::string::npos) << where << ": " << unsupported_reason;
    }
}

// Checks one choice on one rig. False if any number differs.
bool is_exact(Tally& tally, const ScanChoice& choice, const RigCrowd& crowd, const ScanLimits& limits,
              std::span<const uint32_t> instance_counts, const std::string& where) {
    const ScanPlan plan = plan_scan(*choice.method, crowd.rig, limits, choice.threads);
    if (!plan.unsupported_reason.empty()) {
        expect_excusable(plan.unsupported_reason, choice, crowd.rig, limits, where);
        tally.skipped(*choice.method, plan.unsupported_reason);
        return true;
    }
    EXPECT_LE(uint64_t{plan.counts.shared_bytes} * plan.instances_per_workgroup, limits.shared_memory_bytes) << where;
    EXPECT_LE(plan.workgroup_size, limits.workgroup_size) << where;
    const ScanStage stage(test_gpu(), choice, crowd.rig, limits);
    for (const uint32_t instance_count : instance_counts) {
        const std::vector<Affine> model = run_scan(stage, crowd, std::min(instance_count, crowd.instance_count));
        const size_t different = count_different(model, crowd.wanted);
        EXPECT_EQ(different, 0u) << where << ", " << instance_count << " instances";
        if (different > 0) return false;
        tally.compared(*choice.method, model.size());
    }
    return true;
}

TEST(Scan, EveryMethodIsExact) {
    Tally tally;
    uint64_t seed = 0;
    const ScanLimits limits = device_limits();
    for (const uint32_t joint_count : kScanJointCounts) {
        for (const RigShape shape : kRigShapes) {
            Random random(++seed);
            const uint32_t most = std::max(std::min(kInstanceCounts.back(), kMatrixLimit / joint_count),
                                           kInstanceCounts[1]);
            const ExactCrowds crowds(make_parents(shape, joint_count, seed), most, random);
            for (const ScanMethod& method : methods()) {
                const ScanChoice choice{&method, method.thread_choices(limits).at(0)};
                ASSERT_TRUE(is_exact(tally, choice, crowds.of(method), limits, kInstanceCounts,
                                     place(choice, shape, joint_count, most)));
            }
        }
    }
    tally.print();
    for (const ScanMethod& method : methods())
        EXPECT_EQ(tally.cases(method), kScanJointCounts.size() * kRigShapes.size() * kInstanceCounts.size())
            << method.name;
}

TEST(Scan, EveryNumberOfThreadsIsExact) {
    Tally tally;
    uint64_t seed = 1000;
    const ScanLimits limits = device_limits();
    for (const uint32_t joint_count : {1u, 7u, 33u, 65u, 300u, 1024u}) {
        for (const RigShape shape : kRigShapes) {
            Random random(++seed);
            const ExactCrowds crowds(make_parents(shape, joint_count, seed), 37, random);
            for (const ScanMethod& method : methods()) {
                for (const uint32_t threads : method.thread_choices(limits)) {
                    if (threads == method.thread_choices(limits)[0]) continue;
                    const ScanChoice choice{&method, threads};
                    ASSERT_TRUE(is_exact(tally, choice, crowds.of(method), limits, std::array{1u, 37u},
                                         place(choice, shape, joint_count, 37)));
                }
            }
        }
    }
    tally.print();
}

TEST(Scan, EveryMethodIsExactForTheLargestRigs) {
    struct Case {
        RigShape shape;
        uint32_t joint_count, instance_count;
    };
    Tally tally;
    const ScanLimits limits = device_limits();
    for (const Case& c :
         {Case{RigShape::kChain, 5000, 2}, Case{RigShape::kRandom, 5000, 3}, Case{RigShape::kComb, 65535, 1},
          Case{RigShape::kRandom, 65535, 1}, Case{RigShape::kBushy, 65535, 2}, Case{RigShape::kStar, 65535, 1}}) {
        Random random(c.joint_count);
        const ExactCrowds crowds(make_parents(c.shape, c.joint_count, 7), c.instance_count, random);
        for (const ScanMethod& method : methods()) {
            const std::vector<uint32_t> choices = method.thread_choices(limits);
            for (const uint32_t threads : std::set{choices.front(), choices.back()}) {
                const ScanChoice choice{&method, threads};
                is_exact(tally, choice, crowds.of(method), limits, std::array{c.instance_count},
                         place(choice, c.shape, c.joint_count, c.instance_count));
            }
        }
    }
    tally.print();
}

// With limits lower than the device's: covers every fallback that methods have for such devices.
TEST(Scan, EveryMethodIsExactWithLowerDeviceLimits) {
    const ScanLimits device = device_limits();
    std::map<std::string, ScanLimits> lowered;
    const auto lower = [&](const std::string& name) -> ScanLimits& {
        return lowered.emplace(name, device).first->second;
    };
    lower("no shared memory").shared_memory_bytes = 0;
    lower("1,000 bytes of shared memory").shared_memory_bytes = 1000;
    lower("no shuffles").shuffle = false;
    lower("half the subgroup").subgroup_size = std::max(device.subgroup_size / 2, 1u);
    lower("subgroups of 1").subgroup_size = 1;
    lower("workgroups of 32").workgroup_size = 32;
    lower("the other kind of device").is_cpu = !device.is_cpu;
    for (const auto& [name, limits] : lowered) {
        Tally tally;
        for (const uint32_t joint_count : {9u, 65u, 300u}) {
            for (const RigShape shape : {RigShape::kChain, RigShape::kComb, RigShape::kRandom}) {
                Random random(joint_count);
                const ExactCrowds crowds(make_parents(shape, joint_count, joint_count), 19, random);
                for (const ScanMethod& method : methods()) {
                    const std::vector<uint32_t> choices = method.thread_choices(limits);
                    if (choices.empty()) {
                        tally.skipped(method, plan_scan(method, crowds.of(method).rig, limits, 0).unsupported_reason);
                        continue;
                    }
                    const ScanChoice choice{&method, choices[0]};
                    const std::string where = name + ": " + place(choice, shape, joint_count, 19);
                    ASSERT_TRUE(is_exact(tally, choice, crowds.of(method), limits, std::array{19u}, where));
                }
            }
        }
        std::printf("  %s:\n", name.c_str());
        tally.print();
        // Methods that exchange values through shared memory have another fallback, too
        for (const ScanMethod& method : methods())
            if (method.origin != ScanOrigin::kOurs) {
                EXPECT_EQ(tally.cases(method), 9u) << name << ", " << method.name;
            }
    }
}

// Without 64-bit words, as on GPUs.
TEST(Scan, EveryMethodIsExactWithout64BitWords) {
    struct WithoutInt64 {
        bool had = std::exchange(test_gpu()->has_int64, false);
        ~WithoutInt64() { test_gpu()->has_int64 = had; }
    } without_int64;
    ASSERT_FALSE(test_gpu()->uses_software_kernels());
    Tally tally;
    const ScanLimits limits = device_limits();
    for (const uint32_t joint_count : {9u, 300u}) {
        for (const RigShape shape : kRigShapes) {
            Random random(joint_count);
            const ExactCrowds crowds(make_parents(shape, joint_count, 5), 19, random);
            for (const ScanMethod& method : methods()) {
                const ScanChoice choice{&method, method.thread_choices(limits).at(0)};
                ASSERT_TRUE(is_exact(tally, choice, crowds.of(method), limits, std::array{19u},
                                     place(choice, shape, joint_count, 19)));
            }
        }
    }
    tally.print();
}

// The benchmark's variants: the same transforms for every character, several repeats, barriers doubled; the last
// repeat's results.
class OnChip : public testing::TestWithParam<RigShape> {};

TEST_P(OnChip, EveryVariantIsExact) {
    constexpr uint32_t kJoints = 100, kInstances = 5, kRepeats = 3;
    Tally tally;
    const ScanLimits limits = device_limits();
    Random random(11);
    const ExactCrowds one(make_parents(GetParam(), kJoints, 3), 1, random);
    for (const ScanMethod& method : methods()) {
        for (const uint32_t threads : method.thread_choices(limits)) {
            RigCrowd crowd = one.of(method);
            ScanPlan plan = plan_scan(method, crowd.rig, limits, threads);
            const uint64_t shared_bytes = uint64_t{plan.counts.shared_bytes} * plan.instances_per_workgroup +
                                          plan.instances_per_workgroup * kJoints * crowd.rows_per_joint * 16;
            if (!plan.on_chip || shared_bytes > limits.shared_memory_bytes) {
                tally.skipped(method, "not on chip, or too large for it");
                continue;
            }
            crowd.instance_count = kInstances;
            for (uint32_t instance = 1; instance < kInstances; ++instance) {
                crowd.rows.insert(crowd.rows.end(), crowd.rows.begin(),
                                  crowd.rows.begin() + static_cast<ptrdiff_t>(kJoints * crowd.rows_per_joint));
                crowd.wanted.insert(crowd.wanted.end(), crowd.wanted.begin(), crowd.wanted.begin() + kJoints);
            }
            const ScanRun run(crowd, method, kInstances);
            const Buffer links = upload(test_gpu(), "scan links", plan.links);
            plan.constants.resize(7);
            plan.constants.insert(plan.constants.end(),
                                  {1, plan.instances_per_workgroup, plan.instances_per_workgroup * kJoints});
            const bench::OnChipShaders& shaders = bench::on_chip_shaders(method.name);
            for (const auto& spirv : {shaders.plain, shaders.software}) {
                if (spirv.data() == shaders.software.data() && !test_gpu()->has_int64) continue;
                const Kernel kernel(test_gpu(), {.name = method.name,
                                                 .spirv = spirv,
                                                 .workgroup_size = plan.workgroup_size,
                                                 .constants = plan.constants});
                const uint32_t workgroups = (kInstances + plan.instances_per_workgroup - 1) /
                                            plan.instances_per_workgroup;
                run_workgroups(kernel, run.buffers(links), io::ScanPush{kJoints, kInstances, kRepeats}, workgroups);
                const std::vector<Affine> model = run.result();
                ASSERT_EQ(count_different(model, crowd.wanted), 0u)
                    << place({&method, threads}, GetParam(), kJoints, kInstances);
                tally.compared(method, model.size());
            }
        }
    }
    tally.print();
}

INSTANTIATE_TEST_SUITE_P(Scan, OnChip, testing::Values(RigShape::kChain, RigShape::kRandom),
                         [](const auto& of) { return std::string(name_of(of.param)); });

// Rotation, translation and scale near 1, non-uniform if the method supports it. Rounding differs between the methods,
// but stays small.
TEST(Scan, EveryMethodRoundsLittle) {
    constexpr double kBound = 1e-5;  // of the crowd's extent
    const ScanLimits limits = device_limits();
    std::map<std::string_view, double> worst;
    for (const uint32_t joint_count : {20u, 64u, 300u, 1024u}) {
        for (const RigShape shape : kRigShapes) {
            Random random(joint_count);
            const std::vector<uint32_t> parents = make_parents(shape, joint_count);
            const RigCrowd affine(parents, 5, [&] { return as_local(to_affine(random.trs(1, 0.02)).as<float>()); });
            const RigCrowd similarity(parents, 5, [&] {
                Trs<double> trs = random.trs(1, 0.02);
                trs.scale = {trs.scale.x, trs.scale.x, trs.scale.x};
                return as_local(trs);
            });
            for (const ScanMethod& method : methods()) {
                const RigCrowd& crowd = method.format == ScanFormat::kAffine ? affine : similarity;
                double size = 1;
                for (const auto& m : crowd.wanted)
                    size = std::max({size, std::abs(m.row[0][3]), std::abs(m.row[1][3]), std::abs(m.row[2][3])});
                const ScanChoice choice{&method, method.thread_choices(limits).at(0)};
                const std::vector<Affine> model = run_scan(ScanStage(test_gpu(), choice, crowd.rig, limits), crowd, 5);
                double error = 0;
                for (size_t i = 0; i < model.size(); ++i)
                    error = std::max(error, matrix_error(model[i], crowd.wanted[i], size));
                EXPECT_LE(error, kBound) << place(choice, shape, joint_count, 5);
                worst[method.name] = std::max(worst[method.name], error);
            }
        }
    }
    for (const auto& [name, error] : worst) std::printf("  %-22s %.1e\n", std::string(name).c_str(), error);
}

TEST(Scan, AMethodThatDoesNotApplyIsRefused) {
    const ScanRig uniform(make_parents(RigShape::kBinary, 30), true);
    const ScanMethod& walk = *find_scan_method("gateau2012_walk");
    const Result<void> refused = as_result([&] { ScanStage(test_gpu(), {&walk, 7}, uniform, device_limits()); });
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(refused.error().text().find("gateau2012_walk"), std::string::npos) << refused.error().text();
    EXPECT_NE(refused.error().text().find("7 invocations"), std::string::npos) << refused.error().text();
}

// A child's parent_from_joint is the right factor. Two rotations that do not commute tell the sides apart.
TEST(Scan, TheReferenceMultipliesParentFirst) {
    Affine turn_x, turn_z;
    turn_x.row = {{{1, 0, 0, 1}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    turn_z.row = {{{0, -1, 0, 2}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
    const auto model = scan_reference(std::vector<uint32_t>{kNone, 0},
                                      std::vector{turn_x.as<double>(), turn_z.as<double>()});
    const Vec3<double> wanted{1 + 2 - 5, -7, 3};  // (3, 5, 7) turned about z and moved, then about x and moved
    EXPECT_EQ(transform_point(model[1], Vec3<double>{3, 5, 7}), wanted);
}

}  // namespace
}  // namespace throng
