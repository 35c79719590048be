// Packed clips: what decoding gives, and how far the skin is from that of exact keys, measured here at the vertices.
#include "compile/clip/clip_packer.h"
#include "compile/limits.h"
#include "compile/clip/packed_track.h"
#include "compile/clip/read_clips.h"
#include "bind/bind_reference.h"
#include "reference/sampled_poses.h"
#include "sample/sample_reference.h"
#include "skin/skin_reference.h"
#include "tests/morph_cases.h"
#include "tests/shared.h"
#include "tests/test_rig.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace throng {
namespace {

using namespace test;

constexpr double kExactKeys = 1e-6;  // of the size: what the rows added for cubic tracks leave
const std::vector<double> kBounds{1e-3, 1e-4, 1e-5};

PackedTrack track_at(const Character& character, uint32_t position) {
    std::array<std::array<float, 4>, 2> keys{character.keys[position]};
    if (packed_row_bits(std::bit_cast<PackedTrack>(keys)) > 0) keys[1] = character.keys[position + 1];
    return std::bit_cast<PackedTrack>(keys);
}

// The largest displacement of a vertex in a clip, as a fraction of the character's size, at both clips' rows and
// between.
double vertex_error(const Character& exact, const Character& packed, uint32_t clip, size_t max_times) {
    std::vector<double> times_s;
    for (const Character* c : {&exact, &packed})
        for (uint32_t row = 0; row < c->clips[clip].row_count; ++row) {
            const uint32_t at = c->clips[clip].first_time + row;
            times_s.push_back(c->times_s[at]);
            if (row + 1 == c->clips[clip].row_count) continue;
            for (const double w : {0.21, 0.5, 0.8})
                times_s.push_back(c->times_s[at] + w * (double{c->times_s[at + 1]} - c->times_s[at]));
        }
    const size_t stride = std::max<size_t>(1, times_s.size() / max_times);
    double largest = 0;
    for (size_t i = 0; i < times_s.size(); i += stride) {
        const Playback playback{.first = {clip, times_s[i], 1, false}};
        const std::vector<Vec3<double>> wanted = reference_positions(exact, *reference_pose(exact, playback));
        const std::vector<Vec3<double>> got = reference_positions(packed, *reference_pose(packed, playback));
        for (size_t v = 0; v < wanted.size(); ++v) {
            const double distance = length(got[v] - wanted[v]);
            if (!std::isfinite(distance)) return std::numeric_limits<double>::infinity();
            largest = std::max(largest, distance);
        }
    }
    return largest / double{exact.size};
}

bool has_full_rotation(const Character& character, uint32_t clip) {
    const size_t joint_count = character.rig.joint_count();
    for (size_t joint = 0; joint < joint_count; ++joint)
        if (track_at(character, character.tracks[clip * joint_count + joint].rotation).layout & kPackedFull)
            return true;
    return false;
}

// Checks each bound. Only full rotations have a fixed number of bits: clips with them may miss a small bound if the
// smallest bound misses it, too, and must report so. Calls visit(packed, bound) for each bound.
template <class Visit>
void expect_within(const Asset& asset, const std::vector<double>& bounds, size_t max_times, const Visit& visit) {
    const Character exact = compiled(asset, {.error = 0, .lods = false});
    Character finest;
    for (const double bound : bounds) {
        const Character packed = compiled(asset, {.error = bound, .lods = false});
        ASSERT_TRUE(packed.packed);
        ASSERT_EQ(packed.clips.size(), exact.clips.size());
        size_t missed = 0;
        for (uint32_t index = 0; index < exact.clips.size(); ++index) {
            const Clip& clip = packed.clips[index];
            SCOPED_TRACE(asset.name + ", " + clip.name + ", bound " + std::to_string(bound));
            if (clip.error > bound) {
                ++missed;
                EXPECT_TRUE(has_full_rotation(packed, index));
                if (!finest.packed) finest = compiled(asset, {.error = 1e-6, .lods = false});
                EXPECT_GT(finest.clips[index].error, bound) << "it could be kept";
                EXPECT_LE(clip.error, 2e-4);
            }
            EXPECT_LE(vertex_error(exact, packed, index, max_times), std::max(bound, clip.error) + kExactKeys);
            EXPECT_EQ(clip.raw_size_bytes, exact.clips[index].raw_size_bytes);
        }
        EXPECT_EQ(packed.warnings.size() - exact.warnings.size(), missed);
        visit(packed, bound);
    }
}
void expect_within(const Asset& asset, const std::vector<double>& bounds, size_t max_times) {
    expect_within(asset, bounds, max_times, [](const Character&, double) {});
}

// One joint with a triangle about a metre and a half across, and an empty clip.
struct OneJoint {
    Asset asset{.name = "one joint"};

    OneJoint() {
        asset.nodes.push_back({.name = "joint"});
        asset.skins.push_back({.name = "skin", .joints = {0}, .inverse_binds = {Affine{}}});
        AssetPrimitive primitive{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}}, .indices = {0, 1, 2}};
        primitive.influence_count = 4;
        for (int v = 0; v < 3; ++v) {
            primitive.influence_joints.insert(primitive.influence_joints.end(), 4, 0);
            primitive.influence_weights.insert(primitive.influence_weights.end(), {1, 0, 0, 0});
        }
        asset.meshes.push_back({.name = "mesh", .primitives = {primitive}});
        asset.mesh_instances.push_back({.node = 0, .mesh = 0, .skin = 0});
        asset.clips.push_back({.name = "clip"});
    }
    void track(TrackTarget target, const std::vector<float>& times_s, const std::vector<float>& values,
               Interpolation interpolation = Interpolation::kLinear) {
        asset.clips[0].tracks.push_back(
            {.node = 0, .target = target, .interpolation = interpolation, .times_s = times_s, .values = values});
        asset.clips[0].duration_s = std::max(asset.clips[0].duration_s, double{times_s.back()});
    }
    // `turns` about an axis, a key every `key_degrees`.
    void spin(double turns, double key_degrees, const Vec3<double>& axis) {
        std::vector<float> times_s, values;
        for (int key = 0; key * key_degrees <= turns * 360 + 0.1; ++key) {
            const Quaternion<double> q = axis_angle(normalized(axis), key * key_degrees * std::numbers::pi / 180);
            times_s.push_back(static_cast<float>(key) / 30);
            for (const double c : {q.x, q.y, q.z, q.w}) values.push_back(static_cast<float>(c));
        }
        track(TrackTarget::kRotation, times_s, values);
    }
};

TEST(Pack, BitsComeBackAtEveryOffsetAndWidth) {
    Random random(3);
    for (uint32_t width = 0; width <= kPackedComponentBits; ++width)
        for (size_t offset = 0; offset < 70; ++offset) {
            const std::array<uint32_t, 3> written{random.below(1u << width), random.below(1u << width),
                                                  random.below(1u << width)};
            std::vector<uint32_t> words(8);
            for (size_t i = 0; i < 3; ++i) write_bits(words, offset + i * width, written[i], width);
            for (size_t i = 0; i < 3; ++i)
                ASSERT_EQ(read_bits(words, offset + i * width, width), written[i]) << width << " bits at " << offset;
            uint32_t set_count = 0, wanted_count = 0;
            for (const uint32_t word : words) set_count += static_cast<uint32_t>(__builtin_popcount(word));
            for (const uint32_t bits : written) wanted_count += static_cast<uint32_t>(__builtin_popcount(bits));
            ASSERT_EQ(set_count, wanted_count) << "bits beside those of the field";
        }
}

TEST(Pack, EachComponentComesBackWithinHalfAStep) {
    Random random(5);
    for (uint32_t left_out = 0; left_out < 4; ++left_out) {
        PackedTrack track{.minimum = {-0.4f, 0.1f, -0.2f},
                          .layout = 21u | 7u << 5 | 1u << 10 | left_out << kPackedLeftOutShift};
        track.step = {0.8f / (1 << 21), 0.4f / (1 << 7), 0.4f};
        for (int i = 0; i < 100; ++i) {
            const std::array<double, 3> v{random.between(-0.4, 0.4), random.between(0.1, 0.5),
                                          random.between(-0.4, 0.4)};
            TrackValue value{};
            for (uint32_t c = 0; c < 3; ++c) value[(left_out + 1 + c) % 4] = v[c];
            value[left_out] = std::sqrt(1 - v[0] * v[0] - v[1] * v[1] - v[2] * v[2]);
            const TrackValue got = packed_value(track, TrackTarget::kRotation,
                                                quantised(track, TrackTarget::kRotation, value));
            for (uint32_t c = 0; c < 3; ++c)
                EXPECT_LE(std::abs(got[(left_out + 1 + c) % 4] - v[c]),
                          double{track.step[c]} * 0.501 + (c == 1 ? double{track.step[1]} / 2 : 0));
            EXPECT_GE(got[left_out], 0);
        }
    }
}

TEST(Pack, BoundsOutsideTheRangeAreRefused) {
    const Asset asset = make_asset({.joint_count = 3});
    for (const double bad :
         {-1e-4, 1e-7, 0.2, 1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const Result<Character> character = compile_character(asset, {.error = bad});
        ASSERT_FALSE(character) << bad;
        EXPECT_EQ(character.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(character.error().message.find("1e-6 to 0.1"), std::string::npos) << character.error().text();
    }
    for (const double good : {1e-6, 0.1}) EXPECT_TRUE(compile_character(asset, {.error = good}));
}

TEST(Pack, TheRestPoseIsStoredAsConstants) {
    Asset asset = make_asset({.joint_count = 40, .clip_count = 0});
    asset.nodes[7].parent_from_node.rotation = {0.6, 0, 0, -0.8};
    const Character exact = compiled(asset), packed = compiled(asset, {.error = 1e-4});
    EXPECT_TRUE(packed.packed);
    EXPECT_EQ(packed.words.size(), 3u);
    for (const JointTracks& tracks : packed.tracks)
        for (const uint32_t position : {tracks.rotation, tracks.translation, tracks.scale})
            EXPECT_EQ(packed_row_bits(track_at(packed, position)), 0u);
    const std::vector<Trs<double>> wanted = sample_reference(exact, 0, 0), got = sample_reference(packed, 0, 0);
    for (size_t joint = 0; joint < wanted.size(); ++joint) {
        EXPECT_NEAR(std::abs(dot(got[joint].rotation, wanted[joint].rotation)), 1, 1e-12);
        EXPECT_EQ(got[joint].translation, wanted[joint].translation);
        EXPECT_EQ(got[joint].scale, wanted[joint].scale);
    }
}

TEST(Pack, EqualConstantsAreStoredOnce) {
    OneJoint one;
    one.track(TrackTarget::kTranslation, {0, 1}, {0.5f, 0, 0, 0.5f, 0, 0});
    one.asset.clips.push_back(one.asset.clips[0]);
    const Character packed = compiled(one.asset, {.error = 1e-4});
    EXPECT_EQ(packed.keys.size(), 4u) << "three of the rest pose, one of both clips";
    EXPECT_EQ(packed.tracks[0].translation, packed.tracks[1].translation);
    EXPECT_EQ(packed.tracks[0].rotation, packed.tracks[2].rotation) << "as in the rest pose";
    EXPECT_EQ(packed.clips[0].size_bytes, 16u + 4 + 16) << "the constant, one time, the joint's row of the table";
    EXPECT_EQ(packed.clips[1].size_bytes, 4u + 16);
    EXPECT_EQ(packed.clips[1].row_count, 1u);
    EXPECT_EQ(packed.clips[1].row_stride, 0u);
}

// A tremble smaller than the bound becomes a constant; one ten times the bound does not.
TEST(Pack, ATrackWithinTheToleranceBecomesAConstant) {
    for (const double tremble : {1e-5, 1e-2}) {
        OneJoint one;
        std::vector<float> times_s, values;
        for (int key = 0; key < 20; ++key) {
            times_s.push_back(static_cast<float>(key));
            values.insert(values.end(), {static_cast<float>(3 + tremble * std::sin(key)), 0, 0});
        }
        one.track(TrackTarget::kTranslation, times_s, values);
        const Character packed = compiled(one.asset, {.error = 1e-4});
        EXPECT_EQ(packed.clips[0].animated_track_count, tremble > 1e-3 ? 1u : 0u);
        EXPECT_EQ(packed.clips[0].row_count > 1, tremble > 1e-3);
        expect_within(one.asset, {1e-4}, 1000);
    }
}

TEST(Pack, StepTracksHoldAndSwitchAtTheirKeys) {
    OneJoint one;
    std::vector<float> times_s, values;
    for (int key = 0; key < 50; ++key) {
        times_s.push_back(static_cast<float>(key) / 10);
        values.insert(values.end(), {static_cast<float>(key), 0, 0});  // a straight line: no row of it is needed
    }
    one.track(TrackTarget::kTranslation, times_s, values);
    one.track(TrackTarget::kRotation, {0.05f, 1.23f, 2.34f, 3.45f},
              {0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0.6f, 0, 0, 0.8f}, Interpolation::kStep);
    const Character exact = compiled(one.asset), packed = compiled(one.asset, {.error = 1e-4});
    const PackedTrack rotation = track_at(packed, packed.tracks[0].rotation);
    EXPECT_TRUE(rotation.layout & kPackedStep);
    EXPECT_LE(packed.clips[0].row_count, 5u) << "two ends, and two switches";
    for (const float switch_s : {1.23f, 3.45f})
        for (const double offset_s : {-1e-6, 0.0, 1e-6}) {
            const Quaternion<double> wanted = sample_reference(exact, 0, double{switch_s} + offset_s)[0].rotation,
                                     got = sample_reference(packed, 0, double{switch_s} + offset_s)[0].rotation;
            EXPECT_NEAR(std::abs(dot(wanted, got)), 1, 1e-6) << switch_s << " " << offset_s;
        }
    expect_within(one.asset, {1e-4}, 1000);
}

// Even a step too small to be measured stays at its time.
TEST(Pack, RowsWhereAStepTrackChangesAreKept) {
    OneJoint one;
    std::vector<float> times_s, values;
    for (int key = 0; key < 30; ++key) {
        times_s.push_back(static_cast<float>(key) / 10);
        values.insert(values.end(), {0, 0, 0, 1});
    }
    one.track(TrackTarget::kRotation, times_s, values);
    one.track(TrackTarget::kTranslation, {0, 0.7f, 1.1f, 2.9f}, {0, 0, 0, 1, 0, 0, 1.00001f, 0, 0, 0, 0, 0},
              Interpolation::kStep);
    const Character packed = compiled(one.asset, {.error = 1e-3});
    EXPECT_EQ(packed.times_s, (std::vector<float>{0, 0.7f, 1.1f, 2.9f}));
}

TEST(Pack, UniformScaleStaysUniform) {
    OneJoint one;
    std::vector<float> times_s, values;
    Random random(9);
    for (int key = 0; key < 40; ++key) {
        times_s.push_back(static_cast<float>(key) / 7);
        values.insert(values.end(), 3, static_cast<float>(random.between(0.3, 2)));
    }
    one.track(TrackTarget::kScale, times_s, values);
    one.spin(0.3, 10, {1, 2, 3});
    const Character packed = compiled(one.asset, {.error = 1e-3});
    ASSERT_TRUE(packed.rig.uniform_scale);
    ASSERT_GT(packed_row_bits(track_at(packed, packed.tracks[0].scale)), 0u);
    for (int i = 0; i < 600; ++i) {
        const Vec3<double> scale = sample_reference(packed, 0, i / 100.0)[0].scale;
        ASSERT_EQ(scale.x, scale.y);
        ASSERT_EQ(scale.x, scale.z);
    }
    expect_within(one.asset, {1e-3}, 1000);
}

TEST(Pack, RotationsOfHalfAndWholeTurnsKeepTheBound) {
    for (const double turns : {0.4, 0.5, 1.0, 2.5})
        for (const double key_degrees : {9.0, 36.0, 90.0, 179.0})
            for (const Vec3<double>& axis : {Vec3<double>{0, 0, 1}, Vec3<double>{1, 0, 0}, Vec3<double>{1, -2, 0.5}}) {
                OneJoint one;
                one.spin(turns, key_degrees, axis);
                SCOPED_TRACE(testing::Message() << turns << " turns, keys every " << key_degrees << " degrees");
                expect_within(one.asset, {1e-4}, 2000);
                const Character packed = compiled(one.asset, {.error = 1e-4});
                const bool full = (track_at(packed, packed.tracks[0].rotation).layout & kPackedFull) != 0;
                if (key_degrees > 100) continue;
                EXPECT_EQ(full, turns >= 0.5) << "after half a turn no component is away from 0 throughout";
            }
}

TEST(Pack, AnUnreachableBoundIsReported) {
    OneJoint one;
    one.spin(2, 9, {1, 2, 3});  // full rotations have 16 bits
    const Character exact = compiled(one.asset), packed = compiled(one.asset, {.error = 1e-6});
    EXPECT_GT(packed.clips[0].error, 1e-6);
    EXPECT_LE(packed.clips[0].error, 1e-4);
    EXPECT_LE(vertex_error(exact, packed, 0, 1000), packed.clips[0].error + kExactKeys);
    ASSERT_EQ(packed.warnings.size(), 1u);
    EXPECT_NE(packed.warnings[0].find("'clip'"), std::string::npos) << packed.warnings[0];
    EXPECT_NE(packed.warnings[0].find("0.0001 %"), std::string::npos) << packed.warnings[0];
}

// A full rotation, with its fixed number of bits, beside joints with variable bits: the bound is just above the error
// of the finest keys.
TEST(Pack, ABoundThatTheFinestKeysKeepIsKept) {
    OneJoint one;
    one.spin(2, 9, {1, 2, 3});
    Random random(4);
    for (uint32_t beside = 1; beside <= 4; ++beside) {
        one.asset.nodes.push_back({.name = "beside"});
        one.asset.skins[0].joints.push_back(beside);
        one.asset.skins[0].inverse_binds.push_back(Affine{});
        AssetTrack shake{.node = beside, .target = TrackTarget::kTranslation};
        for (int key = 0; key < 81; ++key) {
            shake.times_s.push_back(static_cast<float>(key) / 30);
            for (int c = 0; c < 3; ++c) shake.values.push_back(static_cast<float>(random.between(-1, 1)));
        }
        one.asset.clips[0].tracks.push_back(shake);
    }
    const double finest = compiled(one.asset, {.error = 1e-6}).clips[0].error;
    ASSERT_GT(finest, 1e-6);
    for (double above = 1.01; above < 1.5; above += 0.02) {
        const Character packed = compiled(one.asset, {.error = finest * above});
        EXPECT_LE(packed.clips[0].error, finest * above) << above;
        EXPECT_TRUE(packed.warnings.empty()) << packed.warnings[0];
    }
}

// If the limit on rows leaves none for an arc, a straight line replaces it. Its error must be measured between the
// rows: a quarter turn lags by 0.9 degrees, at a vertex 1 m away.
TEST(Pack, ArcsWithoutRowsAreMeasured) {
    OneJoint one;
    one.spin(0.25, 90, {0, 0, 1});
    Character exact = compiled(one.asset);
    const double bound = 1e-4 * double{exact.size};
    const std::vector<Box> boxes = influence_boxes(exact);
    const std::vector<ExactClip> clips = read_clips(one.asset, build_rig(one.asset), exact);
    EXPECT_LE(pack_clip(exact, clips[0], boxes, {bound, 1000}).error, bound);
    const PackedClip limited = pack_clip(exact, clips[0], boxes, {bound, 1});
    EXPECT_EQ(limited.times_s.size(), 2u);
    EXPECT_GT(limited.error, 0.0157);
    EXPECT_LT(limited.error, 0.0157 * 1.5) << "at a corner of the box";
}

// The importer writes several keys at one time as adjacent floats. Times between them do not count.
TEST(Pack, AJumpIsNoArc) {
    OneJoint one;
    std::vector<float> values;
    for (const double degrees : {0.0, 2.0, 100.0, 102.0}) {
        const Quaternion<double> q = axis_angle({0, 0, 1}, degrees * std::numbers::pi / 180);
        for (const double c : {q.x, q.y, q.z, q.w}) values.push_back(static_cast<float>(c));
    }
    one.track(TrackTarget::kRotation, {0, std::nextafter(1.0f, 0.0f), 1, 2}, values);
    const Character exact = compiled(one.asset), packed = compiled(one.asset, {.error = 1e-4});
    EXPECT_TRUE(packed.warnings.empty()) << packed.warnings[0];
    EXPECT_LE(packed.clips[0].error, 1e-4);
    EXPECT_EQ(packed.times_s, exact.times_s);
    for (const double time_s : {0.5, 0.999, 1.0, 1.5}) {
        const Playback playback{.first = {0, time_s, 1, false}};
        const auto wanted = reference_positions(exact, *reference_pose(exact, playback));
        const auto got = reference_positions(packed, *reference_pose(packed, playback));
        for (size_t v = 0; v < wanted.size(); ++v) EXPECT_LE(length(got[v] - wanted[v]), 1e-4 * double{exact.size});
    }
    // If one arc is long, points are measured between all rows: here 30 degrees, with no rows left.
    std::copy_n(values.begin() + 4, 4, values.begin());
    const Quaternion<double> q = axis_angle({0, 0, 1}, 130 * std::numbers::pi / 180);
    values[14] = static_cast<float>(q.z);
    values[15] = static_cast<float>(q.w);
    one.asset.clips[0].tracks[0].values = values;
    Character arc = compiled(one.asset);
    const std::vector<Box> boxes = influence_boxes(arc);
    const std::vector<ExactClip> clips = read_clips(one.asset, build_rig(one.asset), arc);
    EXPECT_LT(pack_clip(arc, clips[0], boxes, {1e-4 * double{arc.size}, 1}).error, 2e-3) << "of 30 degrees, not of 98";
}

// Only 1 of 65 rows shows the joint, and sensitivities are not sampled there.
TEST(Pack, JointsHiddenInMostRowsMoveWhenShown) {
    OneJoint one;
    std::vector<float> times_s, scales, rotations;
    for (int key = 0; key < 65; ++key) {
        times_s.push_back(static_cast<float>(key) / 30);
        scales.insert(scales.end(), 3, key == 2 ? 1 : 0);
        const Quaternion<double> q = axis_angle(normalized(Vec3<double>{1, 2, 3}), 1 + 0.01 * key);
        for (const double c : {q.x, q.y, q.z, q.w}) rotations.push_back(static_cast<float>(c));
    }
    one.track(TrackTarget::kScale, times_s, scales);
    one.track(TrackTarget::kRotation, times_s, rotations);
    expect_within(one.asset, {1e-4}, 1000);
}

TEST(Pack, WithoutASkinTheJointsAreMeasured) {
    Asset asset = make_asset({.joint_count = 30, .clip_count = 1});
    asset.meshes.clear();
    asset.mesh_instances.clear();
    const Character exact = compiled(asset), packed = compiled(asset, {.error = 1e-4});
    EXPECT_LE(packed.clips[0].error, 1e-4);
    EXPECT_GT(packed.clips[0].animated_track_count, 10u);
    for (int i = 0; i <= 200; ++i) {
        const Playback playback{.first = {0, i / 200.0, 1, false}};
        const ReferencePose wanted = *reference_pose(exact, playback), got = *reference_pose(packed, playback);
        for (size_t joint = 0; joint < 30; ++joint)
            for (size_t r = 0; r < 3; ++r)
                EXPECT_NEAR(got.model_from_joint[joint].row[r][3], wanted.model_from_joint[joint].row[r][3],
                            1e-4 * double{exact.size});
    }
}

TEST(Pack, TestRigsKeepTheBound) {
    THRONG_SKIP_WHERE_SANITIZED();
    for (const uint32_t joint_count : {1u, 65u, 300u}) {
        SCOPED_TRACE(testing::Message() << joint_count << " joints");
        expect_within(make_asset({.joint_count = joint_count, .seed = joint_count}), kBounds, 150);
        if (joint_count < 300)
            expect_within(make_asset({.joint_count = joint_count, .seed = joint_count, .cubic = true}), kBounds, 150);
    }
}

TEST(Pack, ADeepChainKeepsTheBound) {
    THRONG_SKIP_WHERE_SANITIZED();
    expect_within(
        make_asset(
            {.joint_count = 120, .shape = RigShape::kChain, .scale_spread = 0, .clip_count = 1, .key_count = 20}),
        kBounds, 150);
}

TEST(Pack, VerticesThatLargeMorphWeightsMoveAwayKeepTheBound) {
    Asset asset = small_asset({{.node = 0, .times_s = {0}, .values = {5, 0.5f, 0}}});
    asset.meshes[0].primitives[0].targets[0].positions.assign(6, {10, 0, 0});
    expect_within(asset, {1e-2, 1e-3}, 150);
}

TEST(Pack, PosesThatAreNotFiniteAreRefused) {
    EXPECT_EQ(displacement(AffineT<double>{.row = {{{std::nan(""), 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}}},
                           {{-1, -1, -1}, {1, 1, 1}, false}),
              std::numeric_limits<double>::infinity());
    Asset asset = make_asset({.joint_count = 12, .shape = RigShape::kChain, .clip_count = 0});
    asset.clips.push_back({.name = "grow", .duration_s = 1});
    for (uint32_t node = 0; node < asset.nodes.size(); ++node)
        asset.clips[0].tracks.push_back(
            {.node = node, .target = TrackTarget::kScale, .times_s = {0, 1}, .values = {1, 1, 1, 3e38f, 3e38f, 3e38f}});
    const Result<Character> exact = compile_character(asset, kExact);
    ASSERT_FALSE(exact) << "no crowd would take it";
    EXPECT_EQ(exact.error().code, ErrorCode::kInvalidFile);
    EXPECT_NE(exact.error().text().find("clips[0]: its bounds are not finite"), std::string::npos)
        << exact.error().text();
    const Result<Character> packed = compile_character(asset);
    ASSERT_FALSE(packed);
    EXPECT_EQ(packed.error().code, ErrorCode::kInvalidFile);
    EXPECT_NE(packed.error().message.find("'grow': its poses are not finite"), std::string::npos)
        << packed.error().text();
}

// A file of a few megabytes that would take hours. Only one joint moves, otherwise exact keys would take long, too.
TEST(Pack, MoreThanCanBeMeasuredIsRefused) {
    THRONG_SKIP_WHERE_SANITIZED();
    Asset asset = make_asset({.joint_count = 65'535, .shape = RigShape::kStar, .clip_count = 0, .vertex_count = 3});
    AssetTrack track{.node = 1, .target = TrackTarget::kTranslation};
    for (int key = 0; key < 4100; ++key) {
        track.times_s.push_back(static_cast<float>(key));
        track.values.insert(track.values.end(), {static_cast<float>(key % 7), 0, 0});
    }
    asset.clips.push_back({.name = "long", .duration_s = 4099, .tracks = {track}});
    EXPECT_TRUE(compile_character(asset, kExact));
    const Result<Character> packed = compile_character(asset);
    ASSERT_FALSE(packed);
    EXPECT_EQ(packed.error().code, ErrorCode::kLimit);
    for (const std::string& named : {std::to_string(kPackingLimit), std::string("--error exact")})
        EXPECT_NE(packed.error().message.find(named), std::string::npos) << packed.error().text();
}

std::vector<std::filesystem::path> shared_characters() {
    std::vector<std::filesystem::path> files;
    for (const auto& file : std::filesystem::recursive_directory_iterator(shared_folder("characters")))
        if (file.path().extension() == ".glb" || file.path().extension() == ".gltf") files.push_back(file.path());
    std::sort(files.begin(), files.end());
    return files;
}

// Sizes of all clips of some characters.
struct ClipSizes {
    uint64_t packed_bytes = 0, raw_bytes = 0;

    void add(const Character& packed) {
        uint64_t of_clips_bytes = 0;
        for (const Clip& clip : packed.clips) {
            of_clips_bytes += clip.size_bytes;
            raw_bytes += clip.raw_size_bytes;
        }
        packed_bytes += of_clips_bytes;
        // Everything that is uploaded except the rest pose and the words behind the last row.
        const size_t joint_count = packed.rig.joint_count();
        const size_t uploaded_bytes = packed.keys.size() * 16 + packed.words.size() * 4 + packed.times_s.size() * 4 +
                                      packed.tracks.size() * 16;
        EXPECT_GE(uploaded_bytes, of_clips_bytes);
        EXPECT_LE(uploaded_bytes, of_clips_bytes + joint_count * (16 + 3 * 16) + 12);
    }
};

TEST(Pack, RealCharactersKeepTheBoundAndShrinkTenfold) {
    THRONG_SKIP_WHERE_SANITIZED();
    THRONG_SKIP_WITHOUT(shared_folder("characters"));
    ClipSizes sizes;  // at 1e-4
    for (const auto& file : shared_characters()) {
        const Result<Asset> asset = load_asset(file);
        ASSERT_TRUE(asset) << asset.error().text();
        expect_within(*asset, kBounds, 60, [&](const Character& packed, double bound) {
            if (bound == 1e-4) sizes.add(packed);
        });
    }
    EXPECT_GE(static_cast<double>(sizes.raw_bytes) / static_cast<double>(sizes.packed_bytes), 10.0);
}

// A joint's keys compensate for errors of the joints above it. A masked layer may use them without those: here each
// joint and its descendants come from one clip, and the others, exact, from the next clip.
double masked_error(const Character& exact, const Character& packed, uint32_t clip, double time_s) {
    const auto local = sample_reference(exact, clip, time_s), packed_local = sample_reference(packed, clip, time_s);
    const auto next = static_cast<uint32_t>((clip + 1) % exact.clips.size());
    const auto below = sample_reference(exact, next, 0.3 * double{exact.clips[next].duration_s});
    const auto skin = [](const Character& character, const std::vector<Trs<double>>& pose) {
        return skin_reference(character, bind_reference(character.palette, model_from_joint_of(character.rig, pose)));
    };
    double largest = 0;
    for (size_t masked = 1; masked < local.size(); ++masked) {
        std::vector<bool> is_masked(local.size(), false);
        std::vector<Trs<double>> pose = below, packed_pose = below;
        for (size_t joint = masked; joint < local.size(); ++joint) {
            const uint32_t parent = exact.rig.parents[joint];
            if (joint != masked && (parent == kNone || !is_masked[parent])) continue;
            is_masked[joint] = true;
            pose[joint] = local[joint];
            packed_pose[joint] = packed_local[joint];
        }
        const auto places = skin(exact, pose), packed_places = skin(packed, packed_pose);
        for (size_t v = 0; v < places.size(); ++v) largest = worse_of(largest, length(places[v] - packed_places[v]));
    }
    return largest / double{exact.size};
}

TEST(Pack, MasksOfRealCharactersStayNearTheBound) {
    THRONG_SKIP_WHERE_SANITIZED();
    THRONG_SKIP_WITHOUT(shared_folder("characters"));
    constexpr double kBound = 1e-4, kNear = 2.5;  // times the bound
    double largest = 0;
    for (const auto& file : shared_characters()) {
        const Result<Asset> asset = load_asset(file);
        ASSERT_TRUE(asset) << asset.error().text();
        const Character exact = compiled(*asset, {.error = 0, .lods = false}),
                        packed = compiled(*asset, {.error = kBound, .lods = false});
        for (uint32_t clip = 0; clip < exact.clips.size(); ++clip)
            for (const double part : {0.23, 0.61})
                largest = worse_of(largest,
                                   masked_error(exact, packed, clip, part * double{exact.clips[clip].duration_s}));
    }
    std::printf("  %.4f %% of the size\n", 100 * largest);
    EXPECT_LT(largest, kNear * kBound);
}

}  // namespace
}  // namespace throng
