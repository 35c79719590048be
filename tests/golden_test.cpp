// Poses of real characters on the GPU against golden files.
#include "scan/scan_table.h"
#include "tests/goldens.h"
#include "tests/subset.h"
#include "tests/test_device.h"

namespace throng {
namespace {

const test::InSubset kGoldenInSubsets({test::Subset::kNative}, {"Golden.*"});

using namespace test;

// All answers of a file are one crowd, so that the instances differ from each other.
void expect_golden(const Golden& golden, const Character& character, CrowdSettings settings, const std::string& label,
                   const GoldenBounds& bounds) {
    const auto as_doubles = [](const auto& from, auto&& to) {
        for (const auto& value : from) to.push_back(value.template as<double>());
    };
    const auto count = static_cast<uint32_t>(golden.playbacks.size());
    settings.groups = {{&character, count}};
    settings.keep_model_matrices = true;
    Result<Crowd> crowd = Crowd::create(test_device(), settings);
    ASSERT_TRUE(crowd) << crowd.error().text();
    ASSERT_TRUE(crowd->set_playback(crowd->instances(), golden.playbacks));
    ASSERT_TRUE(crowd->update(0));
    Comparison worst;
    for (uint32_t i = 0; i < count; ++i) {
        Computed computed;
        as_doubles(*crowd->read_model_matrices({i}), computed.model);
        as_doubles(*crowd->read_skin_matrices({i}), computed.skin);
        as_doubles(*crowd->read_positions({i}), computed.positions);
        compare(golden, i, computed, worst);
    }
    report(golden, label, worst, bounds);
}

TEST(Golden, EveryScanMethodMatchesOnTheGpu) {
    THRONG_SKIP_WITHOUT(shared_folder("goldens"));
    for (const Golden& golden : load_goldens())
        for (const ScanMethodInfo& method : scan_methods()) {
            const bool takes_similarities = find_scan_method(method.name)->format == ScanFormat::kSimilarity;
            if (!method.in_crowds || !has_scan(method.name) ||
                (takes_similarities && !golden.character.rig.uniform_scale))
                continue;
            expect_golden(golden, golden.character, {.path = UpdatePath::kStaged, .scan = method.name}, method.name,
                          {});
        }
}

TEST(Golden, FusedUpdatesMatchOnTheGpu) {
    THRONG_SKIP_WITHOUT(shared_folder("goldens"));
    constexpr double kAnyMatrix = 1;
    for (const Golden& golden : load_goldens()) {
        expect_golden(golden, golden.character, {.path = UpdatePath::kFused}, "fused", {});
        expect_golden(golden, golden.character, {.path = UpdatePath::kFused, .skin_format = SkinFormat::kHalfAffine},
                      "fused, 24 bytes", {.matrix = kAnyMatrix, .vertex = 5e-3});
        const Result<Character> packed = load_character(golden.file, {.lods = false});
        ASSERT_TRUE(packed && packed->packed) << golden.file;
        const double bound = CompileSettings{}.error * packed->size / golden.size + kGoldenBound;
        for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged})
            expect_golden(golden, *packed, {.path = path},
                          path == UpdatePath::kFused ? "fused, packed" : "staged, packed",
                          {.matrix = kAnyMatrix, .vertex = bound});
    }
}

}  // namespace
}  // namespace throng
