// What AMD's compiler makes of the kernels, compared with the committed record. Needs AMD's driver.
#include "base/failure.h"
#include "bench/isa/compiler.h"
#include "bench/isa/executable.h"
#include "bench/isa/machines.h"
#include "bench/isa/predicted_costs.h"
#include "bench/isa_bench.h"
#include "bench/report/records.h"
#include "bench/value_of.h"
#include "tests/shared.h"
#include "tools/creatures/creature.h"

#include <throng/crowd.h>

#include <algorithm>
#include <map>
#include <set>

namespace throng::bench {
namespace {

std::shared_ptr<Gpu> compiler_or_null() {
    try {
        return open_compiler("navi21");
    } catch (const Failure& failure) {
        std::printf("%s\n", failure.text.c_str());
        return nullptr;
    }
}

// The key of a record: what identifies it in the table.
std::string key_of(const Json& record) {
    return text(record, "configuration") + "; " + text(record, "kernel") + "; " + text(record, "scan") + "; " +
           record["subgroup_size"].dump();
}

std::map<std::string, Json> kernels_of(const std::vector<Json>& records) {
    std::map<std::string, Json> kernels;
    for (const Json& record : records)
        if (!record.contains("machine")) kernels[key_of(record)] = record;
    return kernels;
}

TEST(Isa, ACompileOnlyDeviceRunsNothing) {
    const std::shared_ptr<Gpu> gpu = compiler_or_null();
    if (!gpu) GTEST_SKIP() << "without AMD's driver";
    EXPECT_TRUE(gpu->compiles_only());
    EXPECT_FALSE(gpu->info.usable);
    std::vector<Executable> made;
    std::string refusal;  // set by drivers that report less, as some versions do
    gpu->on_pipeline = [&](const MadePipeline& pipeline) {
        try {
            for (const Executable& executable : executables_of(*gpu, pipeline)) made.push_back(executable);
        } catch (const Failure& failure) {
            refusal = failure.text;
        }
    };
    const Character character = value_of(
        compile_character(value_of(make_creature({.joint_count = 20, .level_count = 8})), {.lods = false}));
    Crowd crowd = value_of(Crowd::create(Device(gpu), {.groups = {{&character, 3}}}));
    EXPECT_TRUE(crowd.update(0.1f));
    gpu->on_pipeline = nullptr;
    if (!refusal.empty()) GTEST_SKIP() << refusal;
    ASSERT_FALSE(made.empty());
    for (const Executable& kernel : made) {
        EXPECT_GT(kernel.vgprs, 0u) << kernel.name;
        EXPECT_GT(kernel.code.all().total(), 0) << kernel.name;
    }
}

// A stage's kernel is named after its file. A scan method's kernel may have a suffix.
TEST(Isa, EachKernelIsInTheRecord) {
    const auto record_file = source_file("bench/results/2026-11-29_isa_navi21.jsonl"), sources = source_file("src");
    THRONG_SKIP_WITHOUT(record_file);
    THRONG_SKIP_WITHOUT(sources);
    std::set<std::string> recorded;
    for (const Json& record : read_records(record_file)) {
        recorded.insert(text(record, "kernel"));
        if (text(record, "kernel") == "draw picture: Fragment Shader") {
            EXPECT_GT(number(record, "instructions/all"), 100)
                << "its light is missing: was it made without a colour attachment?";
        }
    }
    size_t count = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(sources)) {
        if (file.path().extension() != ".comp" || file.path().parent_path().filename() == "fused") continue;
        EXPECT_TRUE(recorded.contains(file.path().stem().string())) << file.path();
        ++count;
    }
    EXPECT_GT(count, 20u);
}

// If a change of machine code is intended, run: throng bench isa --json > bench/results/…_isa_navi21.jsonl
TEST(Isa, DefaultFormsAreAsTheRecordHasThem) {
    const auto record_file = source_file("bench/results/2026-11-29_isa_navi21.jsonl");
    THRONG_SKIP_WITHOUT(record_file);
    const std::shared_ptr<Gpu> gpu = compiler_or_null();
    if (!gpu) GTEST_SKIP() << "without AMD's driver";
    const auto recorded = kernels_of(read_records(record_file));
    const std::string driver = text(recorded.begin()->second, "driver");
    if (gpu->info.driver != driver) GTEST_SKIP() << "the record is of " << driver << ", this is " << gpu->info.driver;
    const auto made = kernels_of(measure_isa("navi21", IsaScope::kDefaultForms, [](const std::string&) {}));
    ASSERT_FALSE(made.empty());
    for (const auto& [key, kernel] : made) {
        SCOPED_TRACE(key);
        for (const char* field : {"spilled_vgprs", "spilled_sgprs", "scratch_bytes"}) EXPECT_EQ(kernel[field], 0);
        const auto before = recorded.find(key);
        ASSERT_NE(before, recorded.end());
        for (const char* field : {"subgroups_per_simd", "instructions/all", "issued/all"}) {
            const double wanted = number(before->second, field), is = number(kernel, field);
            if (std::isnan(wanted)) {
                EXPECT_TRUE(std::isnan(is)) << field;
            } else {
                EXPECT_NEAR(is, wanted, 0.05 * wanted) << field;
            }
        }
    }
}

// The planner's built-in GPU costs must equal the output of `throng tune --predicted`, and lead to good choices by
// machine code.
TEST(Isa, PlannerCostsMatchMachineCode) {
    constexpr uint32_t kAmd = 0x1002;
    const std::shared_ptr<Gpu> gpu = compiler_or_null();
    if (!gpu) GTEST_SKIP() << "without AMD's driver";
    if (!gpu->info.driver.starts_with("radv Mesa 22.3")) GTEST_SKIP() << "counted by another driver than this one";
    const ScanCosts built_in = built_in_hardware_costs(kAmd);
    const auto machine = std::ranges::find(machines(), "RX 6900 XT", &Machine::name);
    const PredictedCosts predicted = predict_scan_costs(*machine, built_in, [](const std::string&) {});
    EXPECT_GT(predicted.scan_count, 50u);
    EXPECT_LT(predicted.largest_slack, 1.1);
    for (const auto constant :
         {&ScanCosts::row_ns, &ScanCosts::multiplication_ns, &ScanCosts::barrier_ns, &ScanCosts::workgroup_ns,
          &ScanCosts::latency_ns, &ScanCosts::units, &ScanCosts::resident_subgroups})
        EXPECT_NEAR(built_in.*constant, predicted.costs.*constant, 0.1 * predicted.costs.*constant);
}

}  // namespace
}  // namespace throng::bench
