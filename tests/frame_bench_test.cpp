// The benchmark of whole updates: every variant and floor is measured or says why not, no wrong result is timed, and
// floors do all of their work.
#include "base/failure.h"
#include "bench/frame_bench.h"
#include "bench/frame_crowds.h"
#include "bench/frame_floors.h"
#include "bench/frame_traffic.h"
#include "bench/report/gnuplot.h"
#include "bench/scan_report.h"
#include "tests/kernel_runner.h"
#include "tests/text.h"
#include "tools/creatures/creature.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace throng::bench {
namespace {

using test::count_of;
using Json = nlohmann::json;

constexpr uint32_t kFrameBenchJoints = 40, kLevels = 12, kFrameBenchCharacters = 30;
constexpr const char* kConfiguration = "30 x 40, 12 levels";
const Progress kFrameBenchQuiet = [](const std::string&) {};

Character measured_creature(const CompileSettings& settings = {}) {
    return *compile_character(
        *make_creature({.joint_count = kFrameBenchJoints, .level_count = kLevels, .face_count = 600}), settings);
}

// Two different clips in each, at different times.
std::vector<Playback> playbacks() {
    std::vector<Playback> all;
    for (uint32_t i = 0; i < kFrameBenchCharacters; ++i)
        all.push_back({.first = {.clip = i % 3, .time_s = 0.1 * i},
                       .second = {.clip = (i + 1) % 3, .time_s = 0.07 * i},
                       .weight = 0.1f + 0.02f * static_cast<float>(i)});
    return all;
}

std::map<std::string, Json> by_variant(const std::vector<Json>& records) {
    std::map<std::string, Json> all;
    for (const Json& record : records)
        EXPECT_TRUE(all.emplace(record["variant"], record).second) << "twice: " << record["variant"];
    return all;
}

std::map<std::string, Json> measure(const Character& character, const Character* exact, uint32_t samples,
                                    const SkinReference& reference = skin_reference_of) {
    const std::vector<Playback> playback = playbacks();
    return by_variant(measure_frame(test_device(),
                                    {.configuration = kConfiguration,
                                     .character = &character,
                                     .keys = "0.01 %",
                                     .exact = exact,
                                     .playback = playback},
                                    samples, kFrameBenchQuiet, reference));
}

TEST(FrameBench, ByteCountsEqualThoseByHand) {
    // 188 = playback state 36 + both times 8 + the cursor (36), which is written once and read by two samples and the
    // blend.
    EXPECT_EQ((FrameTraffic{.joint_count = 300, .palette_count = 300}.bytes_per_instance()), 188 + 300u * 432);
    EXPECT_EQ((FrameTraffic{.joint_count = 300, .palette_count = 300, .local_bytes = 32}.bytes_per_instance()),
              188 + 300u * 400);
    EXPECT_EQ((FrameTraffic{.clip_count = 1, .joint_count = 300, .palette_count = 300}.bytes_per_instance()),
              188 + 300u * 336);
    EXPECT_EQ((FrameTraffic{.joint_count = 10, .palette_count = 7, .skin_bytes = 24}.bytes_per_instance()),
              188 + 10u * (192 + 144) + 7u * (48 + 24));
    EXPECT_EQ((FrameTraffic{.fused = true, .joint_count = 300, .palette_count = 300}.bytes_per_instance()),
              116 + 300u * 48);
    EXPECT_EQ(
        (FrameTraffic{.fused = true, .joint_count = 300, .palette_count = 7, .skin_bytes = 32}.bytes_per_instance()),
        116 + 7u * 32);
}

TEST(FrameBench, EveryVariantIsMeasured) {
    const Character packed = measured_creature(), exact = measured_creature(kExact);
    const std::map<std::string, Json> records = measure(packed, &exact, 2);
    ASSERT_EQ(records.size(), 11u);
    for (const auto& [variant, record] : records) {
        EXPECT_EQ(record["bench"], "frame");
        EXPECT_EQ(record["configuration"], kConfiguration);
        EXPECT_EQ(record["characters"], kFrameBenchCharacters);
        EXPECT_EQ(record["joints"], kFrameBenchJoints);
        EXPECT_EQ(record["levels"], kLevels);
        EXPECT_FALSE(record.contains("wrong")) << record;
        ASSERT_TRUE(record.contains("ms")) << record;
        EXPECT_EQ(record["samples"], 2);
        EXPECT_LE(record["host_samples"], 2);
        EXPECT_GT(record["ms"]["p5"], 0) << variant;
        EXPECT_LE(record["ms"]["p5"], record["ms"]["median"]);
        EXPECT_LE(record["ms"]["median"], record["ms"]["p95"]);
        const double ms = record["ms"]["median"];
        EXPECT_NEAR(record["ns_per_joint"].get<double>() * kFrameBenchCharacters * kFrameBenchJoints * 1e-6, ms,
                    1e-9 * ms);
        EXPECT_NEAR(record["gb_per_s"].get<double>() * ms * 1e6, record["bytes"].get<double>(),
                    1e-6 * record["bytes"].get<double>());
    }
    struct Wanted {
        const char *variant, *path, *format, *keys, *fill;
        int clips;
        uint64_t instance_bytes;
        double error;
    };
    for (const Wanted& wanted :
         {Wanted{"fused", "fused", "affine", "0.01 %", "fill, 48 bytes", 2, 116 + kFrameBenchJoints * 48, 1e-4},
          Wanted{"fused, one clip", "fused", "affine", "0.01 %", "fill, 48 bytes", 1, 116 + kFrameBenchJoints * 48,
                 1e-4},
          Wanted{"fused, 24 bytes", "fused", "half_affine", "0.01 %", "fill, 24 bytes", 2, 116 + kFrameBenchJoints * 24,
                 2e-3},
          Wanted{"fused, 32 bytes", "fused", "similarity", "0.01 %", "fill, 32 bytes", 2, 116 + kFrameBenchJoints * 32,
                 1e-4},
          Wanted{"fused, exact keys", "fused", "affine", "exact", "fill, 48 bytes", 2, 116 + kFrameBenchJoints * 48,
                 1e-4}}) {
        const Json &record = records.at(wanted.variant), &fill = records.at(wanted.fill);
        EXPECT_EQ(record["path"], wanted.path) << wanted.variant;
        EXPECT_EQ(record["skin_format"], wanted.format) << wanted.variant;
        EXPECT_EQ(record["keys"], wanted.keys) << wanted.variant;
        EXPECT_EQ(record["clips"], wanted.clips) << wanted.variant;
        EXPECT_EQ(record["bytes"], kFrameBenchCharacters * wanted.instance_bytes) << wanted.variant;
        EXPECT_LE(record["max_error"], wanted.error) << wanted.variant;
        EXPECT_NEAR(record["times_fill_floor"].get<double>(),
                    record["ms"]["median"].get<double>() / fill["ms"]["median"].get<double>(), 1e-9)
            << wanted.variant;
        EXPECT_TRUE(record["stages"].contains("fused") && !record["stages"].contains("sample")) << record;
        EXPECT_EQ(fill["path"], "fill");
        EXPECT_EQ(fill["bytes"], kFrameBenchCharacters * (wanted.instance_bytes - 116));
    }
    const Json& staged = records.at("staged");
    EXPECT_EQ(staged["path"], "staged");
    EXPECT_TRUE(staged["stages"].contains("sample") && !staged["stages"].contains("fused")) << staged;
    const bool similarities = staged["scan"].get<std::string>().find("quaternion") != std::string::npos;
    EXPECT_EQ(staged["bytes"], kFrameBenchCharacters * (188 + kFrameBenchJoints * (similarities ? 400 : 432)));
    EXPECT_EQ(records.at("copy as staged")["bytes"], staged["bytes"]);
    EXPECT_EQ(records.at("copy as staged")["path"], "copy");
    EXPECT_GT(records.at("fused, 24 bytes")["max_error"], records.at("fused")["max_error"])
        << "half floats cannot be as exact";
}

// The reference differs slightly in one number of one palette entry.
TEST(FrameBench, AWrongResultIsNotTimed) {
    const Character character = measured_creature();
    const auto reference_off_by = [](double offset) {
        return [offset](const Character& of, const Playback& playback) {
            std::vector<AffineT<double>> matrices = skin_reference_of(of, playback);
            matrices.back().row[1][2] += offset;
            return matrices;
        };
    };
    const std::map<std::string, Json> little = measure(character, nullptr, 1, reference_off_by(1e-3));
    for (const char* variant : {"staged", "fused", "fused, one clip", "fused, 32 bytes"}) {
        EXPECT_EQ(little.at(variant)["wrong"], true) << variant;
        EXPECT_NEAR(little.at(variant)["max_error"].get<double>(), 1e-3, 1e-4) << variant;
        for (const char* field : {"ms", "stages", "samples", "ns_per_joint", "times_fill_floor"})
            EXPECT_FALSE(little.at(variant).contains(field)) << variant << ", " << field;
    }
    EXPECT_FALSE(little.at("fused, 24 bytes").contains("wrong")) << "half floats are allowed that much";
    EXPECT_TRUE(little.at("fused, 24 bytes").contains("ms"));
    for (const double offset : {3e-3, std::numeric_limits<double>::quiet_NaN()})
        for (const auto& [variant, record] : measure(character, nullptr, 1, reference_off_by(offset)))
            EXPECT_NE(record.contains("wrong"), record["path"] == "copy") << variant;
}

TEST(FrameBench, ReportsWhyAVariantDoesNotApply) {
    Character character = measured_creature();
    for (float& element : character.palette[3].joint_from_bind.row[0]) element *= 2;  // not a similarity any more
    const std::map<std::string, Json> records = measure(character, nullptr, 1);
    EXPECT_NE(records.at("fused, 32 bytes")["unsupported_reason"].get<std::string>().find("palette entry 3"),
              std::string::npos)
        << records.at("fused, 32 bytes");
    EXPECT_FALSE(records.at("fused, 32 bytes").contains("ms"));
    EXPECT_FALSE(records.contains("fill, 32 bytes"));
    EXPECT_TRUE(records.at("fused").contains("ms"));
}

TEST(FrameBench, CrowdsAreSharedAndRefusedBeforeMemoryEnds) {
    const Character character = measured_creature();
    FrameCrowds crowds(test_device(), kFrameBenchCharacters);
    const FrameCrowdKey key{&character, UpdatePath::kFused, SkinFormat::kAffine};
    EXPECT_EQ(crowds.get(key), crowds.get(key));
    EXPECT_NE(crowds.get(key), crowds.get({&character, UpdatePath::kStaged, SkinFormat::kAffine}));
    EXPECT_EQ(crowds.memory_unsupported_reason(1), "");
    EXPECT_NE(crowds.memory_unsupported_reason(uint64_t{1} << 50).find("1073741824 MiB do not fit"), std::string::npos);
    FrameCrowds many(test_device(), 2'000'000'000);
    EXPECT_EQ(many.get(key)->crowd, nullptr);
    EXPECT_NE(many.get(key)->unsupported_reason.find("do not fit"), std::string::npos);
}

TEST(FrameBench, FillsWriteEveryRow) {
    const Character character = measured_creature();
    Crowd crowd = *Crowd::create(
        test_device(), {.groups = {{&character, kFrameBenchCharacters}}, .skin_format = SkinFormat::kHalfAffine});
    const FillFloor fill(test::test_gpu(), crowd, SkinFormat::kHalfAffine);
    EXPECT_EQ(fill.size_bytes(), uint64_t{kFrameBenchCharacters} * kFrameBenchJoints * 24);
    const BufferRange target(crowd.outputs()[0].skin.buffer, 0, fill.size_bytes());
    test::run_on_gpu([&](VkCommandBuffer commands) {
        test::test_gpu()->vk.vkCmdFillBuffer(commands, target.buffer, 0, target.size_bytes, ~0u);
    });
    test::run_on_gpu([&](VkCommandBuffer commands) { fill.record_kernel(commands); });
    const auto words = download<uint32_t>(test::test_gpu(), target);
    for (uint32_t row = 0; row < words.size() / 4; ++row) ASSERT_EQ(words[4 * row], row);
    test::run_on_gpu([&](VkCommandBuffer commands) { fill.record_transfer(commands); });
    for (const uint32_t word : download<uint32_t>(test::test_gpu(), target)) ASSERT_EQ(word, 0u);
}

// Copies alternate between two buffers of 1003 rows: three full passes, then one of five rows. The last bytes are less
// than a row and are dropped.
TEST(FrameBench, CopiesMoveEveryRow) {
    constexpr uint64_t kRows = 1003, kTailRows = 5, kRowBytes = 16;
    const CopyFloor copy(test::test_gpu(), 2 * ((3 * kRows + kTailRows) * kRowBytes + 8), kRows * kRowBytes);
    ASSERT_EQ(copy.passes().size(), 4u);
    for (size_t pass = 0; pass < 4; ++pass) {
        EXPECT_EQ(copy.passes()[pass].from, pass % 2);
        EXPECT_EQ(copy.passes()[pass].size_bytes, (pass < 3 ? kRows : kTailRows) * kRowBytes);
    }
    const CopyFloor tail(test::test_gpu(), 2 * 777 * kRowBytes, kRows * kRowBytes);
    ASSERT_EQ(tail.passes().size(), 1u);

    std::vector<uint32_t> first(4 * kRows), second(4 * kRows, 7);
    for (uint32_t i = 0; i < first.size(); ++i) first[i] = i * 2654435761u;
    for (const bool by_kernel : {true, false})
        for (const CopyFloor* floor : {&copy, &tail}) {
            const auto put = [&](VkCommandBuffer commands, const Buffer& buffer, const std::vector<uint32_t>& words) {
                test::test_gpu()->vk.vkCmdUpdateBuffer(commands, buffer.handle(), 0, words.size() * 4, words.data());
            };
            test::run_on_gpu([&](VkCommandBuffer commands) {
                put(commands, floor->buffers()[0], first);
                put(commands, floor->buffers()[1], second);
            });
            test::run_on_gpu([&](VkCommandBuffer commands) {
                if (by_kernel)
                    floor->record_kernel(commands);
                else
                    floor->record_transfer(commands);
            });
            std::vector<uint32_t> wanted = second;
            std::copy_n(first.begin(), floor == &copy ? first.size() : 4 * 777, wanted.begin());
            EXPECT_EQ(download<uint32_t>(test::test_gpu(), floor->buffers()[0]), first)
                << (by_kernel ? "kernel" : "transfer");
            EXPECT_EQ(download<uint32_t>(test::test_gpu(), floor->buffers()[1]), wanted)
                << (by_kernel ? "kernel" : "transfer");
        }
}

TEST(FrameBench, HostTimeCountsWhereASoftwareDevicesTimestampsAreTooShort) {
    const Gpu& gpu = *test::test_gpu();
    const Reading believed = credible_reading(gpu, 10, 12), doubted = credible_reading(gpu, 4, 12);
    EXPECT_EQ(believed.ms, 10);
    EXPECT_FALSE(believed.by_host);
    EXPECT_EQ(doubted.by_host, gpu.is_cpu());
    EXPECT_EQ(doubted.ms, gpu.is_cpu() ? 12 : 4);
}

Json frame_record(const char* variant, const char* path, double ms) {
    return {{"bench", "frame"},
            {"configuration", kConfiguration},
            {"variant", variant},
            {"path", path},
            {"characters", kFrameBenchCharacters},
            {"joints", kFrameBenchJoints},
            {"levels", kLevels},
            {"ms", {{"median", ms}, {"p5", 0.9 * ms}, {"p95", 1.2 * ms}}},
            {"times_fill_floor", ms / 4},
            {"device", "A GPU"}};
}

// A bare machine, for which `./run bundle` is meant, does not have it.
bool has_gnuplot() {
    try {
        run_gnuplot("");
    } catch (const Failure&) {
        return false;
    }
    return true;
}

TEST(FrameBench, TheReportHasASectionOfIt) {
    if (!has_gnuplot()) GTEST_SKIP() << "its figures need gnuplot, which is not installed";
    std::vector<Json> records{
        frame_record("staged", "staged", 321),        frame_record("fused", "fused", 55),
        frame_record("fill, 48 bytes", "fill", 4),    frame_record("fused", "fused", 60),
        frame_record("fused, 24 bytes", "fused", 30), frame_record("fused, 32 bytes", "fused", 30)};
    records[3]["samples"] = 15;
    records[3]["host_samples"] = 2;
    records[0]["host_samples"] = 0;
    records[4]["wrong"] = true;
    records[4].erase("ms");
    records[5]["unsupported_reason"] = "<a joint>";
    records[5].erase("ms");
    const std::string html = scan_report(records);
    EXPECT_EQ(count_of(html, "<svg"), 1u);
    EXPECT_NE(html.find("Whole updates: A GPU"), std::string::npos);
    for (const char* variant : {"staged", "fused", "fill, 48 bytes"}) {
        EXPECT_EQ(count_of(html, std::string("data-series=\"") + variant + "\"><title>"), 2u)
            << variant << ": its bar, and the line of its percentiles";
        EXPECT_EQ(count_of(html, std::string("</span>") + variant + "</td>"), 1u) << variant;
    }
    EXPECT_NE(html.find("Fused is 5.35 times as fast as staged and takes 15.0 times as long as writing its result."),
              std::string::npos)
        << "of the last record of a variant";
    EXPECT_EQ(count_of(html, "host's time in "), 1u);
    EXPECT_NE(html.find("host's time in 2 of 15 rounds"), std::string::npos);
    EXPECT_NE(html.find("wrong result, not timed"), std::string::npos);
    EXPECT_NE(html.find("not measured: &lt;a joint&gt;"), std::string::npos);
    EXPECT_EQ(html.find("no record of the scan"), std::string::npos);
}

TEST(FrameBench, TheReportAcceptsIncompleteRecords) {
    if (!has_gnuplot()) GTEST_SKIP() << "its figures need gnuplot, which is not installed";
    std::vector<Json> records{
        {{"bench", "frame"}},
        {{"bench", "frame"}, {"variant", "fused"}},
        {{"bench", "frame"}, {"variant", "staged"}, {"ms", 3}, {"stages", "none"}},
        {{"bench", "frame"}, {"variant", "a"}, {"ms", {{"median", 0}}}},
        {{"bench", "frame"}, {"variant", "b"}, {"ms", {{"median", -1}, {"p5", "x"}}}},
        {{"bench", "frame"}, {"variant", "c"}, {"ms", {{"median", 1}}}, {"stages", {{"fused", nullptr}}}}};
    for (size_t i = 1; i <= records.size(); ++i)
        EXPECT_NE(scan_report(std::span(records).first(i)).find("</html>"), std::string::npos) << records[i - 1].dump();
}

}  // namespace
}  // namespace throng::bench
