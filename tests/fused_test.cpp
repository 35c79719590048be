// The fused update against reference_pose(): every method that has one, packed and exact keys, skin matrix formats, and
// the matrices that are kept.
#include "bind/skin_format.h"
#include "crowd/crowd_state.h"
#include "fused/fused.h"
#include "gpu/spirv_info.h"
#include "scan/scan_planner.h"
#include "scan/scan_shaders.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"

#include <cstdio>
#include <cstring>
#include <map>

namespace throng {
namespace {

// Rows of several characters per subgroup, and of several rounds. The other kernels differ only in numbers.
const test::InSubset kFusedInSubsets({test::Subset::kGpuAssisted},
                                     {"Fused/FusedMethod.*", "Fused/FusedRows.*/3", "Fused/FusedRows.*/300",
                                      "Fused.RowsWithUniformScaleFollowTheReference",
                                      "Fused.KeysAreReadIfRowsAreUnavailable",
                                      "Fused.AnyNumberOfSubgroupsYieldsTheSameBits",
                                      "Fused.SimilaritiesOfMirrorsAndHalfTurns"});
const test::InSubset kFusedOnOtherDrivers({test::Subset::kOtherDriver},
                                          {"-Fused/FusedMethod.*_1", "-Fused/FusedMethod.*_300"});
const test::InSubset kFusedWithOtherSubgroups({test::Subset::kSubgroups},
                                              {"Fused.*", "Fused/*",
                                               "-Fused.LargeRigsAreStagedUnlessFusedIsRequested"});
// Methods that exchange values through registers; only `stream` reads rows.
const test::InSubset kFusedWithWideSubgroups({test::Subset::kWideSubgroups},
                                             {"Fused/FusedMethod.*/stream*", "Fused/FusedMethod.*/subgroup*",
                                              "Fused/FusedMethod.*/fragments*", "Fused/FusedRows.*", "Fused.AnyNumber*",
                                              "Fused.RowsWithUniformScaleFollowTheReference"});
const test::InSubset kFusedNatively({test::Subset::kNative},
                                    {"Fused.*", "Fused/FusedMethod.*", "-Fused.AGpuTakesTheFirstMethodThatFits",
                                     "-Fused.SharedMemoryIsTheTileAndTheMethodsArrays",
                                     "-Fused.TooFewStorageBuffersAreAnObstacle",
                                     "-Fused.TablesAreNamedWhereTheDeviceCannotReadThem",
                                     "-Fused.LargeRigsAreStagedUnlessFusedIsRequested", "-Fused.Rows*",
                                     "-Fused.KeysAreReadIfRowsAreUnavailable"});

using namespace test;

// Tests of all methods share a few characters, since packing takes seconds.
const Character& packed_character(const AssetSettings& settings) {
    static std::map<AssetSettings, Character> all;
    const auto [at, is_new] = all.try_emplace(settings);
    if (is_new) at->second = compiled(make_asset(settings), {.error = 1e-4});
    return at->second;
}

double crowd_error(Crowd& crowd, const Character& character, const std::vector<Playback>& playbacks,
                   bool with_model = true) {
    double worst = 0;
    for (uint32_t i = 0; i < playbacks.size(); ++i)
        worst = std::max(worst, instance_error(crowd, i, character, playbacks[i], with_model));
    return worst;
}

// Why the test device cannot run the method. A native one has its own pass, which takes any character.
std::string obstacle(const ScanChoice& choice, const Character& character) {
    if (test_gpu()->is_native()) return {};
    return plan_fused(choice, FusedRig(character), scan_limits(*test_gpu())).unsupported_reason;
}

class FusedMethod : public testing::TestWithParam<std::tuple<const ScanMethod*, uint32_t>> {};

TEST_P(FusedMethod, FollowsTheReference) {
    const auto [given, joint_count] = GetParam();
    const ScanMethod& method = *given;
    if (!has_scan(method.name)) GTEST_SKIP() << "this device has no scan by " << method.name;
    const ScanLimits limits = scan_limits(*test_gpu());
    size_t cases = 0, refused = 0;
    double worst = 0;
    const AssetSettings asset{.joint_count = joint_count,
                              .seed = joint_count,
                              .scale_spread = method.format == ScanFormat::kSimilarity ? 0 : 0.1};
    for (const Character& character : {make_character(asset), packed_character(asset)}) {
        Random random(joint_count);
        const std::vector<Playback> playbacks = random_playbacks(random, character, 19);
        std::vector<uint32_t> thread_choices = method.thread_choices(limits);
        if (character.packed) thread_choices.resize(1);  // which keys are read does not depend on the lanes
        for (const uint32_t threads : thread_choices) {
            const ScanChoice choice{&method, threads};
            const CrowdSettings settings{.groups = {{&character, 19}},
                                         .path = UpdatePath::kFused,
                                         .scan = name_of(choice),
                                         .keep_model_matrices = true};
            if (const std::string reason = obstacle(choice, character); !reason.empty()) {
                const Result<Crowd> crowd = Crowd::create(test_device(), settings);
                ASSERT_FALSE(crowd);
                EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported);
                EXPECT_NE(crowd.error().text().find(reason), std::string::npos) << crowd.error().text();
                ++refused;
                continue;
            }
            Crowd crowd = create(settings);
            ASSERT_TRUE(crowd.path(0)->is_fused);
            ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
            ASSERT_TRUE(crowd.update(0));
            const double error = crowd_error(crowd, character, playbacks);
            EXPECT_LE(error, 2 * kPoseBound) << settings.scan << ", " << (character.packed ? "packed" : "exact");
            worst = std::max(worst, error);
            ++cases;
        }
    }
    EXPECT_GT(cases + (joint_count == 300 ? refused : 0), 0u);  // the largest character's tile may not fit
    std::printf("  %zu cases, %zu refused: largest error %.1e of the size\n", cases, refused, worst);
}

std::vector<const ScanMethod*> fused_methods() {
    std::vector<const ScanMethod*> methods;
    for (const ScanMethod& method : scan_table())
        if (!scan_shaders(method.name).fused.empty()) methods.push_back(&method);
    return methods;
}

INSTANTIATE_TEST_SUITE_P(Fused, FusedMethod,
                         testing::Combine(testing::ValuesIn(fused_methods()), testing::Values(1u, 70u, 300u)),
                         [](const testing::TestParamInfo<FusedMethod::ParamType>& of) {
                             return std::string(std::get<0>(of.param)->name) + "_" +
                                    std::to_string(std::get<1>(of.param));
                         });

// With uniform scales, `stream` reads rows instead of keys: of clips with steps, of joints that move and joints that
// only turn, of ranges that need more than 16 bits and of small ones.
class FusedRows : public testing::TestWithParam<uint32_t> {};

TEST_P(FusedRows, FollowTheReference) {
    if (!has_scan("stream")) GTEST_SKIP() << "no stream here";
    const uint32_t joint_count = GetParam();
    const AssetSettings asset{.joint_count = joint_count, .seed = joint_count, .scale_spread = 0};
    double worst = 0;
    for (const Character& character : {make_character(asset), packed_character(asset)})
        for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine, SkinFormat::kSimilarity}) {
            Random random(joint_count);
            const std::vector<Playback> playbacks = random_playbacks(random, character, 19);
            Crowd crowd = create({.groups = {{&character, 19}},
                                  .path = UpdatePath::kFused,
                                  .skin_format = format,
                                  .scan = "stream",
                                  .keep_model_matrices = true});
            EXPECT_NE(crowd.path(0)->reason.find("from rows"), std::string::npos) << crowd.path(0)->reason;
            ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
            ASSERT_TRUE(crowd.update(0));
            const double error = crowd_error(crowd, character, playbacks);
            EXPECT_LE(error, format == SkinFormat::kHalfAffine ? 2e-3 : 2 * kPoseBound)
                << (character.packed ? "packed" : "exact");
            if (format == SkinFormat::kAffine) worst = std::max(worst, error);
        }
    std::printf("  largest error %.1e of the size\n", worst);
}

INSTANTIATE_TEST_SUITE_P(Fused, FusedRows, testing::Values(1u, 3u, 20u, 70u, 300u), testing::PrintToStringParamName());

// One uniform scale per joint, changed by clips.
Character evenly_scaled() {
    Asset asset = make_asset({.joint_count = 12, .seed = 5, .scale_spread = 0});
    for (AssetClip& clip : asset.clips)
        for (uint32_t node = 0; node < 12; node += 2)
            clip.tracks.push_back({.node = node,
                                   .target = TrackTarget::kScale,
                                   .times_s = {0, 0.4f, 1},
                                   .values = {0.7f, 0.7f, 0.7f, 1.3f, 1.3f, 1.3f, 0.9f, 0.9f, 0.9f}});
    return compiled(asset);
}

TEST(Fused, RowsWithUniformScaleFollowTheReference) {
    if (!has_scan("stream")) GTEST_SKIP() << "no stream here";
    const Character character = evenly_scaled();
    Random random(3);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 19);
    Crowd crowd = create(
        {.groups = {{&character, 19}}, .path = UpdatePath::kFused, .scan = "stream", .keep_model_matrices = true});
    EXPECT_NE(crowd.path(0)->reason.find("from rows"), std::string::npos) << crowd.path(0)->reason;
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_LE(crowd_error(crowd, character, playbacks), 2 * kPoseBound);
}

TEST(Fused, KeysAreReadIfRowsAreUnavailable) {
    if (!has_scan("stream")) GTEST_SKIP() << "no stream here";
    const Character uneven = make_character({.joint_count = 20, .scale_spread = 0.1});
    const Character even = make_character({.joint_count = 20, .scale_spread = 0});
    for (const CrowdGroup& group : {CrowdGroup{.character = &uneven, .instance_count = 2},
                                    CrowdGroup{.character = &even, .instance_count = 2, .pose_capacity = 1}}) {
        const Crowd crowd = create({.groups = {group}, .path = UpdatePath::kFused, .scan = "stream"});
        EXPECT_EQ(crowd.path(0)->reason.find("from rows"), std::string::npos) << crowd.path(0)->reason;
    }
}

// A few instances share a subgroup's lanes; many have one lane each; more than fill a workgroup leave the last one
// partly empty.
TEST(Fused, AnyNumberOfInstancesFollowsTheReference) {
    const Character character = packed_character({.joint_count = 70, .seed = 3});
    size_t scan_count = 0;
    for (const char* scan : {"serial", "subgroup:1", "subgroup:8", "fragments", "stream", "stream:4"}) {
        const ScanRequest request = parse_scan_request(scan);
        if (!has_scan(request.method->name)) continue;
        if (request.threads && !obstacle({request.method, *request.threads}, character).empty()) continue;
        ++scan_count;
        for (const uint32_t count : {1u, 2u, 3u, 7u, 8u, 9u, 15u, 16u, 17u, 100u}) {
            Crowd crowd = create({.groups = {{&character, count}},
                                  .path = UpdatePath::kFused,
                                  .scan = scan,
                                  .keep_model_matrices = true});
            Random random(count);
            const std::vector<Playback> playbacks = random_playbacks(random, character, count);
            ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
            ASSERT_TRUE(crowd.update(0));
            EXPECT_LE(crowd_error(crowd, character, playbacks), kPoseBound)
                << count << " instances by " << crowd.path(0)->scan.method;
        }
    }
    EXPECT_GE(scan_count, test_gpu()->is_native() ? 1u : 2u);
}

void expect_turning_loops(const Character& character, uint32_t turning_count) {
    const FusedPlan plan = plan_fused({find_scan_method("serial"), 0}, FusedRig(character), scan_limits(*test_gpu()));
    ASSERT_EQ(plan.unsupported_reason, "");
    uint32_t fixed = 0, free = 0;
    for (uint32_t segment = 0; segment < plan.scan.links[io::kSegmentCount]; ++segment) {
        fixed += plan.scan.links[io::kFirstSegment + 2 * segment];
        free += plan.scan.links[io::kFirstSegment + 2 * segment + 1];
    }
    EXPECT_EQ(fixed + free, character.rig.joint_count());
    EXPECT_GE(fixed, turning_count);
    EXPECT_EQ(free > 0, turning_count < character.rig.joint_count());
}

// The number of subgroups that share a character does not change the bits of its joints' products.
TEST(Fused, AnyNumberOfSubgroupsYieldsTheSameBits) {
    if (!has_scan("stream")) GTEST_SKIP() << "no stream here";
    const Character character = packed_character({.joint_count = 300, .seed = 5, .scale_spread = 0});
    Random random(7);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 7);
    std::vector<std::vector<Affine>> first;
    for (const uint32_t subgroups : {1u, 2u, 4u}) {
        const ScanLimits limits = scan_limits(*test_gpu());
        const uint32_t lanes = std::min(32u, std::max(limits.subgroup_size, limits.largest_subgroup_size));
        Crowd crowd = create({.groups = {{&character, 7}},
                              .path = UpdatePath::kFused,
                              .scan = "stream:" + std::to_string(subgroups * lanes)});
        ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
        ASSERT_TRUE(crowd.update(0));
        for (uint32_t i = 0; i < 7; ++i) {
            const std::vector<Affine> skin = crowd.read_skin_matrices({i}).value();
            if (subgroups == 1)
                first.push_back(skin);
            else
                EXPECT_EQ(std::memcmp(skin.data(), first[i].data(), skin.size() * sizeof(Affine)), 0) << subgroups;
        }
    }
}

// Joints that only turn are processed in a separate loop. In the second asset, half of the joints only turn.
TEST(Fused, JointsThatOnlyRotateFollowTheReference) {
    constexpr uint32_t kJoints = 60, kInstances = 19;
    for (const uint32_t turning_count : {kJoints, kJoints / 2}) {
        Asset asset = make_asset({.joint_count = kJoints, .shape = RigShape::kChain, .seed = 31});
        for (AssetClip& clip : asset.clips)
            std::erase_if(clip.tracks, [&](const AssetTrack& track) {
                return track.target != TrackTarget::kRotation && track.node < turning_count;
            });
        for (const CompileSettings& compile : {kExact, CompileSettings{.error = 1e-4}}) {
            const Result<Character> character = compile_character(asset, compile);
            ASSERT_TRUE(character) << character.error().text();
            if (!test_gpu()->is_native()) expect_turning_loops(*character, turning_count);
            Crowd crowd = create({.groups = {{&*character, kInstances}},
                                  .path = UpdatePath::kFused,
                                  .scan = "serial",
                                  .keep_model_matrices = true});
            Random random(turning_count);
            // With weights of 0, 1 and between: one kernel
            std::vector<Playback> playbacks = random_playbacks(random, *character, kInstances);
            // 0 and 1 alone: the other
            for (const bool blends : {true, false}) {
                if (!blends)
                    for (Playback& playback : playbacks) playback.weight = playback.weight < 0.5f ? 0.0f : 1.0f;
                ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
                ASSERT_TRUE(crowd.update(0));
                EXPECT_LE(crowd_error(crowd, *character, playbacks), 2 * kPoseBound)
                    << turning_count << " joints only turn, " << (character->packed ? "packed" : "exact") << ", blends "
                    << blends;
            }
        }
    }
}

// A separate kernel for one clip per instance is used while no instance blends.
TEST(Fused, SwitchesBetweenOneClipAndBlending) {
    const Character character = packed_character({.joint_count = 40, .seed = 8});
    Crowd crowd = create({.groups = {{&character, 20}}, .path = UpdatePath::kFused, .keep_model_matrices = true});
    Random random(4);
    std::vector<Playback> playbacks = random_playbacks(random, character, 20);
    const auto show = [&](auto weight_of, bool blends) {
        for (uint32_t i = 0; i < playbacks.size(); ++i) playbacks[i].weight = weight_of(i);
        ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
        ASSERT_TRUE(crowd.update(0));
        EXPECT_EQ(crowd.state().batches[0].blends, blends);
        EXPECT_LE(crowd_error(crowd, character, playbacks), kPoseBound);
    };
    show([](uint32_t i) { return i % 2 == 0 ? 0.0f : 1.0f; }, false);
    show([](uint32_t i) { return i == 13 ? 0.25f : 1.0f; }, true);
    show([](uint32_t) { return 0.5f; }, true);
    show([](uint32_t) { return 0.0f; }, false);
}

TEST(Fused, EveryFormatOnBothPathsStaysWithinItsError) {
    const Character character = make_character({.joint_count = 120, .seed = 12, .scale_spread = 0});
    Random random(7);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 11);
    struct Case {
        SkinFormat format;
        double bound;  // of the size
        uint32_t bytes;
    };
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        for (const Case& c : {Case{SkinFormat::kAffine, kPoseBound, 48}, Case{SkinFormat::kHalfAffine, 5e-3, 24},
                              Case{SkinFormat::kSimilarity, 2e-5, 32}}) {
            EXPECT_EQ(skin_format_bytes(c.format), c.bytes);
            Crowd crowd = create({.groups = {{&character, 11}}, .path = path, .skin_format = c.format});
            ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
            ASSERT_TRUE(crowd.update(0));
            const double error = crowd_error(crowd, character, playbacks, false);
            EXPECT_LE(error, c.bound) << "path " << static_cast<int>(path) << ", " << c.bytes << " bytes";
            if (c.format == SkinFormat::kHalfAffine) {
                EXPECT_GT(error, 1e-5) << "halves were not used";
            }
            std::printf("  %s, %u bytes: largest error %.1e of the size\n",
                        path == UpdatePath::kFused ? "fused" : "staged", c.bytes, error);
        }
    }
}

TEST(Fused, SimilaritiesAreRefusedIfTheyCannotHoldTheMatrices) {
    const Character scaled = make_character({.joint_count = 20, .scale_spread = 0.1});
    Character sheared = make_character({.joint_count = 20, .scale_spread = 0});
    sheared.palette[3].joint_from_bind.row[0][1] += 0.5f;
    for (const Character& character : {scaled, sheared}) {
        const Result<Crowd> crowd = Crowd::create(
            test_device(), {.groups = {{&character, 2}}, .skin_format = SkinFormat::kSimilarity});
        ASSERT_FALSE(crowd);
        EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported);
        EXPECT_NE(crowd.error().text().find("32-byte skin matrices"), std::string::npos) << crowd.error().text();
    }
    EXPECT_NE(skin_format_unsupported_reason(SkinFormat::kSimilarity, sheared).find("entry 3"), std::string::npos);
}

// Mirrored joints and half turns about every axis, so that each quaternion component is the largest once.
TEST(Fused, SimilaritiesOfMirrorsAndHalfTurns) {
    Character character = make_character({.joint_count = 9, .scale_spread = 0});
    for (size_t entry = 0; entry < character.palette.size(); ++entry) {
        const std::array<Quaternion<float>, 5> turns{
            {{0, 0, 0, 1}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0.6f, 0, 0.8f, 0}}};
        const float scale = entry % 2 == 0 ? 1.5f : -0.5f;
        character.palette[entry].joint_from_bind = to_affine(Trs<float>{
            .rotation = turns[entry % turns.size()], .translation = {1, 2, 3}, .scale = {scale, scale, scale}});
    }
    Random random(21);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 9);
    Crowd crowd = create(
        {.groups = {{&character, 9}}, .path = UpdatePath::kFused, .skin_format = SkinFormat::kSimilarity});
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_LE(crowd_error(crowd, character, playbacks, false), 2e-5);
}

TEST(Fused, PreviousMatricesAreThoseOfTheUpdateBefore) {
    const Character character = small_character();
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        Crowd crowd = create({.groups = {{&character, 6}}, .path = path, .keep_previous_matrices = true});
        Random random(2);
        ASSERT_TRUE(crowd.set_playback(crowd.instances(), random_playbacks(random, character, 6)));
        const auto read = [&](BufferView OutputBlock::*member) {
            return output<Affine>(crowd.outputs()[0], member, 6 * character.palette.size());
        };
        std::vector<Affine> last;
        for (int update = 0; update < 4; ++update) {
            ASSERT_TRUE(crowd.update(0.13f));
            const std::vector<Affine> now = read(&OutputBlock::skin), previous = read(&OutputBlock::previous_skin);
            EXPECT_TRUE(same_bits(now, skins_of(crowd)));
            if (update == 0) {
                EXPECT_TRUE(same_bits(previous, now)) << "nothing has moved yet";
            } else {
                EXPECT_TRUE(same_bits(previous, last));
                EXPECT_FALSE(same_bits(previous, now));
            }
            last = now;
        }
    }
    const Crowd without = create({.groups = {{&character, 1}}});
    EXPECT_FALSE(has_output(without.outputs()[0], &OutputBlock::previous_skin));
}

TEST(Fused, UnsupportedThreadCountsAreRefusedOnEveryPath) {
    const Character character = small_character();
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kFused, UpdatePath::kStaged})
        for (const char* scan : {"serial:7", "subgroup:3"}) {
            if (!has_scan(parse_scan_request(scan).method->name)) continue;
            const Result<Crowd> crowd = Crowd::create(test_device(),
                                                      {.groups = {{&character, 2}}, .path = path, .scan = scan});
            ASSERT_FALSE(crowd) << scan;
            EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported) << scan;
            EXPECT_NE(crowd.error().text().find("invocations a character"), std::string::npos) << crowd.error().text();
        }
}

}  // namespace
}  // namespace throng
