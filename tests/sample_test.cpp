// Sampled poses against the reference: compiled clips at random times, and arcs of every angle.
#include "sample/sample.h"
#include "sample/sample_reference.h"
#include "tests/kernel_runner.h"
#include "tests/sample_cases.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace throng {
namespace {

// Under GPU-assisted validation the excluded test takes too long.
const test::InSubset kSampleInSubsets({test::Subset::kGpuAssisted},
                                      {"Sample.*", "-Sample.PackedClipsFollowTheReference"});
const test::InSubset kSampleNatively({test::Subset::kNative}, {"Sample.*"});

using namespace test;

constexpr double kSampleBound = 2e-6;  // of a component, relative where it exceeds 1

std::vector<io::JointPose> run_sample(const Character& character, const std::vector<io::InstanceCursor>& cursors,
                                      uint32_t which) {
    const auto count = static_cast<uint32_t>(cursors.size());
    const Guarded<io::JointPose> poses(poison<io::JointPose>(size_t{count} * character.rig.joint_count()));
    const Guarded<io::InstanceCursor> cursor_buffer(cursors);
    const Guarded<JointTracks> tracks(character.tracks);
    const Guarded<std::array<float, 4>> keys(character.keys);
    const Guarded<uint32_t> words(character.words);
    run_workgroups(sample_kernel(test_gpu(), character.packed),
                   BufferTable{{io::kCursorsBuffer, cursor_buffer},
                               {io::kTracksBuffer, tracks},
                               {io::kKeysBuffer, keys},
                               {io::kWordsBuffer, words},
                               {io::kSampledPosesBuffer, poses},
                               {io::kBirthsBuffer, Guarded<uint32_t>({})}},
                   io::SamplePush{character.rig.joint_count(), which}, count);
    return poses.read();
}

void expect_reference(const Character& character) {
    const uint32_t joint_count = character.rig.joint_count();
    Random random(joint_count);
    std::vector<std::array<Moment, 2>> shown;
    std::vector<io::InstanceCursor> cursors;
    for (int i = 0; i < 100; ++i) {
        const auto any = [&] {
            Moment moment = random_moment(random, character);
            const bool is_rest = moment.clip == character.clips.size();
            if (i == 0) moment.time_s = 0;
            if (i == 1 && !is_rest) moment.time_s = character.clips[moment.clip].duration_s;
            return moment;
        };
        shown.push_back({any(), any()});
        cursors.push_back({shown.back()[0].cursor(character), shown.back()[1].cursor(character), 0.5f});
    }
    double worst = 0;
    for (const uint32_t which : {0u, 1u}) {
        const std::vector<io::JointPose> poses = run_sample(character, cursors, which);
        for (size_t i = 0; i < cursors.size(); ++i) {
            const std::vector<Trs<double>> wanted = sample_reference(character, shown[i][which].clip,
                                                                     shown[i][which].time_s);
            for (size_t joint = 0; joint < joint_count; ++joint)
                worst = std::max(worst, pose_error(poses[i * joint_count + joint], wanted[joint]));
        }
    }
    EXPECT_LE(worst, kSampleBound) << joint_count << " joints";
    std::printf("  %3u joints, 100 instances, both clips: largest error %.1e\n", joint_count, worst);
}

TEST(Sample, CompiledClipsFollowTheReference) {
    for (const uint32_t joint_count : {1u, 63u, 64u, 65u, 300u})
        expect_reference(make_character(
            {.joint_count = joint_count, .seed = joint_count, .clip_count = 4, .cubic = joint_count == 65}));
}

TEST(Sample, PackedClipsFollowTheReference) {
    for (const uint32_t joint_count : {1u, 63u, 65u, 300u}) {
        for (const double error : {1e-2, 1e-4, 1e-6}) {
            // Fine ones of many joints take seconds to pack
            const bool takes_long = joint_count > 63 && error < 1e-2;
            const Result<Character> packed = compile_character(make_asset({.joint_count = joint_count,
                                                                           .seed = joint_count,
                                                                           .clip_count = takes_long ? 1u : 4u,
                                                                           .key_count = takes_long ? 3u : 6u,
                                                                           .cubic = joint_count == 65 && error > 1e-6}),
                                                               {.error = error});
            ASSERT_TRUE(packed) << packed.error().text();
            ASSERT_TRUE(packed->packed);
            expect_reference(*packed);
        }
    }
}

// A clip with weight 0 is not sampled, and its poses are left unchanged.
TEST(Sample, SkipsClipsWithoutWeight) {
    const Character character = make_character({.joint_count = 70});
    const io::ClipCursor first = cursor_at(character, 0, 0.3), second = cursor_at(character, 1, 0.7);
    const std::vector<io::InstanceCursor> cursors{
        {first, second, 1}, {first, second, 0}, {first, second, 0.5f}, {first, second, 1}};
    const std::vector<io::JointPose> untouched = poison<io::JointPose>(70);
    for (const uint32_t which : {0u, 1u}) {
        const std::vector<io::JointPose> poses = run_sample(character, cursors, which);
        const std::vector<Trs<double>> wanted = sample_reference(character, which, which == 0 ? 0.3 : 0.7);
        for (size_t i = 0; i < cursors.size(); ++i) {
            const std::vector<io::JointPose> of_instance(poses.begin() + static_cast<ptrdiff_t>(i * 70),
                                                         poses.begin() + static_cast<ptrdiff_t>(i * 70 + 70));
            const bool has_weight = (which == 0 ? cursors[i].weight : 1 - cursors[i].weight) > 0;
            EXPECT_EQ(same_bits(of_instance, untouched), !has_weight) << "clip " << which << ", instance " << i;
            if (!has_weight) continue;
            for (size_t joint = 0; joint < 70; ++joint)
                EXPECT_LE(pose_error(of_instance[joint], wanted[joint]), kSampleBound);
        }
    }
}

// One clip of two rows. Each joint turns by its own angle, from zero to half a turn.
TEST(Sample, RotationsOfEveryAngleFollowTheReference) {
    std::vector<double> angles_rad{0, std::numbers::pi};
    for (double angle = 1e-9; angle < std::numbers::pi; angle *= 1.1) angles_rad.push_back(angle);
    for (const double distance : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) angles_rad.push_back(std::numbers::pi - distance);
    for (const double angle : {1e-3, 2e-3, 3e-3}) {  // where the kernel changes from the chord to the arc
        angles_rad.push_back(angle * 0.9999);
        angles_rad.push_back(angle);
        angles_rad.push_back(angle * 1.0001);
    }
    const auto joint_count = static_cast<uint32_t>(angles_rad.size());
    Random random(3);
    Character character;
    character.rig.parents.assign(joint_count, kNone);
    character.clips.push_back({.duration_s = 1, .row_count = 2, .row_stride = joint_count});
    character.times_s = {0, 1};
    character.keys.resize(2 * joint_count);
    const auto constants = static_cast<uint32_t>(character.keys.size());
    character.keys.push_back({1, 2, 3, 0});
    character.keys.push_back({1, 1, 1, 0});
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        // An exact half turn: the quaternions are orthogonal, so either direction would be correct. The rule dot >= 0
        // decides.
        const Vec3<double> axis = joint < 2 ? Vec3<double>{0, 1, 0} : random.direction();
        const Quaternion<double> from = joint < 2 ? Quaternion<double>{} : random.rotation(),
                                 turn = axis_angle(axis, angles_rad[joint]);
        const Quaternion<float> a = from.as<float>(),
                                b = (joint == 1 ? Quaternion<double>{0, 1, 0, 0} : normalized(from * turn)).as<float>();
        character.keys[joint] = {a.x, a.y, a.z, a.w};
        character.keys[joint_count + joint] = {b.x, b.y, b.z, b.w};
        character.tracks.push_back(
            {.rotation = joint | kTrackAnimated, .translation = constants, .scale = constants + 1});
    }
    std::vector<io::InstanceCursor> cursors;
    std::vector<double> times_s;
    for (const double time_s : {0.0, 1e-7, 0.001, 0.1, 0.25, 0.5, 0.75, 0.9, 0.999, 0.9999999}) {
        times_s.push_back(static_cast<float>(time_s));
        cursors.push_back(
            {.first = {.first_track = 0, .earlier = 0, .later = joint_count, .fraction = static_cast<float>(time_s)},
             .second = {},
             .weight = 1});
    }
    const std::vector<io::JointPose> poses = run_sample(character, cursors, 0);
    double worst = 0, worst_length = 0;
    for (size_t i = 0; i < cursors.size(); ++i) {
        const std::vector<Trs<double>> wanted = sample_reference(character, 0, times_s[i]);
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            const io::JointPose& pose = poses[i * joint_count + joint];
            const double error = pose_error(pose, wanted[joint]);
            EXPECT_LE(error, kSampleBound) << angles_rad[joint] << " rad at " << times_s[i];
            worst = std::max(worst, error);
            const io::vec4& q = pose.rotation;
            worst_length = std::max(
                worst_length,
                std::abs(std::sqrt(double{q.x} * q.x + double{q.y} * q.y + double{q.z} * q.z + double{q.w} * q.w) - 1));
        }
    }
    EXPECT_LE(worst_length, 5e-7);
    std::printf("  %u arcs x %zu times: largest error %.1e, of the length %.1e\n", joint_count, cursors.size(), worst,
                worst_length);
}

// A stepped track holds its earlier row until the last moment, beside a linear track and a constant one.
TEST(Sample, StepLinearAndConstantTracksCombine) {
    Character character;
    character.rig.parents = {kNone};
    character.clips.push_back({.duration_s = 1, .row_count = 3, .row_stride = 2});
    character.times_s = {0, 0.5f, 1};
    // [row][column], then a constant
    character.keys = {{1, 0, 0, 0}, {1, 1, 1, 0}, {3, 0, 0, 0}, {2, 4, 6, 0}, {7, 0, 0, 0}, {9, 9, 9, 0}, {0, 0, 1, 0}};
    character.tracks = {{.rotation = 6, .translation = 0 | kTrackAnimated | kTrackStep, .scale = 1 | kTrackAnimated}};
    const io::ClipCursor end{.first_track = 0, .earlier = 4, .later = 4, .fraction = 0};
    const std::vector<io::JointPose> poses = run_sample(
        character, {{{0, 0, 2, 0.25f}, {}, 1}, {{0, 2, 4, 0.999f}, {}, 1}, {end, {}, 1}}, 0);
    const auto equals = [](const io::vec4& v, float x, float y, float z) {
        return std::abs(v.x - x) + std::abs(v.y - y) + std::abs(v.z - z) < 1e-5f;
    };
    EXPECT_TRUE(equals(poses[0].translation, 1, 0, 0) && equals(poses[0].scale, 1.25f, 1.75f, 2.25f));
    EXPECT_TRUE(equals(poses[1].translation, 3, 0, 0) && equals(poses[1].scale, 8.993f, 8.995f, 8.997f));
    EXPECT_TRUE(equals(poses[2].translation, 7, 0, 0) && equals(poses[2].scale, 9, 9, 9));
    for (const io::JointPose& pose : poses) EXPECT_TRUE(equals(pose.rotation, 0, 0, 1)) << "half a turn about z";
}

TEST(Sample, TheReferenceTakesTheShorterArc) {
    const Quaternion<double> from{}, to = axis_angle(Vec3<double>{0, 0, 1}, 1.0),
                                     middle = axis_angle(Vec3<double>{0, 0, 1}, 0.25);
    for (const Quaternion<double>& end : {to, -to}) {
        const Quaternion<double> got = slerp(from, end, 0.25);
        EXPECT_NEAR(std::abs(dot(got, middle)), 1, 1e-12);
    }
    EXPECT_NEAR(std::abs(dot(slerp(from, to, 0), from)), 1, 1e-15);
    EXPECT_NEAR(std::abs(dot(slerp(from, to, 1), to)), 1, 1e-15);
}

}  // namespace
}  // namespace throng
