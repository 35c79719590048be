// The pose kernels as devices without Vulkan run them, against the references.
#include "bind/bind.kernel.h"
#include "bind/bind_io.h"
#include "bind/bind_reference.h"
#include "blend/blend.kernel.h"
#include "blend/blend_io.h"
#include "blend/blend_reference.h"
#include "control/control.kernel.h"
#include "gpu/glsl.h"
#include "gpu/upload.h"
#include "sample/sample.kernel.h"
#include "sample/sample_reference.h"
#include "scan/scan_io.h"
#include "scan/scan_reference.h"
#include "scan/scan_shaders.h"
#include "scan/scan_table.h"
#include "tests/host/native_runner.h"
#include "tests/sample_cases.h"

#include <throng/skin_format.h>

#include <array>
#include <bit>
#include <cmath>
#include <set>

namespace throng {
namespace {

using namespace test;

constexpr double kNativePoseBound = 2e-6;  // of an element, relative where it exceeds 1
constexpr std::array kJointCounts{1u, 64u, 65u};

TEST(NativeKernels, ControlAdvancesClips) {
    Random random(1);
    const Character character = make_character({.joint_count = 7, .clip_count = 3});
    std::vector<io::ClipTimeline> timelines;
    for (const Clip& clip : character.clips)
        timelines.push_back({clip.first_time, clip.row_count, clip.row_stride, clip.first_row, clip.duration_s});
    std::vector<uint32_t> words = as_words(timelines);
    std::vector<float> times_s = character.times_s;
    std::vector<io::InstancePlayback> playbacks;
    const auto play = [&] {
        return io::ClipPlay{random.below(3), random.below(2), 0, static_cast<float>(random.between(-2, 2))};
    };
    for (int i = 0; i < 200; ++i) playbacks.push_back({play(), play(), static_cast<float>(random.unit())});
    auto cursors = unwritten<io::InstanceCursor>(200);
    NativeRun run(kernels::control.native);
    run.bind(io::kPlaybacksBuffer, playbacks).bind(io::kTimelineBuffer, words).bind(io::kTimesBuffer, times_s);
    run.bind(io::kCursorsBuffer, cursors);
    for (int step = 0; step < 50; ++step) {
        const std::vector<io::InstancePlayback> before = playbacks;
        run.invocations(io::ControlPush{200, 7, 0.1f}, 200);
        for (size_t i = 0; i < 200; ++i) {
            const io::ClipPlay &from = before[i].first, &to = playbacks[i].first;
            const Clip& clip = character.clips[from.clip];
            const double wanted = local_time_reference(double{from.time_s} + double{0.1f} * double{from.speed},
                                                       double{clip.duration_s}, from.loop != 0);
            const double off = std::abs(to.time_s - wanted);
            EXPECT_LE(std::min(off, std::abs(double{clip.duration_s} - off)), 1e-6);
            const io::ClipCursor expected = cursor_at(character, from.clip, double{to.time_s});
            EXPECT_EQ(cursors[i].first.first_track, expected.first_track);
            EXPECT_EQ(cursors[i].first.earlier, expected.earlier);
            EXPECT_NEAR(cursors[i].first.fraction, expected.fraction, 1e-6);
            EXPECT_EQ(cursors[i].weight, before[i].weight);
        }
    }
}

void expect_sampled(Character character) {
    const uint32_t joint_count = character.rig.joint_count();
    Random random(joint_count);
    std::vector<std::array<Moment, 2>> shown;
    std::vector<io::InstanceCursor> cursors;
    for (int i = 0; i < 30; ++i) {
        shown.push_back({random_moment(random, character), random_moment(random, character)});
        cursors.push_back({shown.back()[0].cursor(character), shown.back()[1].cursor(character), 0.5f});
    }
    for (const uint32_t which : {0u, 1u}) {
        auto poses = unwritten<io::JointPose>(cursors.size() * joint_count);
        NativeRun run(kernels::sample.native, {character.packed});
        run.bind(io::kCursorsBuffer, cursors).bind(io::kTracksBuffer, character.tracks);
        run.bind(io::kKeysBuffer, character.keys).bind(io::kWordsBuffer, character.words);
        run.bind(io::kSampledPosesBuffer, poses);
        run.workgroups(io::SamplePush{joint_count, which}, 30);
        for (size_t i = 0; i < cursors.size(); ++i) {
            const auto wanted = sample_reference(character, shown[i][which].clip, shown[i][which].time_s);
            for (size_t joint = 0; joint < joint_count; ++joint)
                ASSERT_LE(pose_error(poses[i * joint_count + joint], wanted[joint]), kNativePoseBound)
                    << "joint " << joint << " of " << joint_count;
        }
    }
}

// Which paths through the kernel the packed tracks cover.
struct PackedWays {
    size_t constant_count = 0, step_count = 0, full_count = 0;
    std::set<uint32_t> left_out;  // omitted components of rotations that are not full

    void add(const Character& packed) {
        for (const JointTracks& tracks : packed.tracks)
            for (const uint32_t track : {tracks.rotation, tracks.translation, tracks.scale}) {
                const auto layout = std::bit_cast<uint32_t>(packed.keys[track][3]);
                if ((layout & kPackedBitsMask) == 0) {
                    ++constant_count;
                    continue;
                }
                if (layout & kPackedStep) ++step_count;
                if (layout & kPackedFull)
                    ++full_count;
                else if (track == tracks.rotation)
                    left_out.insert(layout >> kPackedLeftOutShift & 3);
            }
    }
};

TEST(NativeKernels, SampleFollowsTheReference) {
    PackedWays ways;
    for (const uint32_t joint_count : kJointCounts) {
        // Packing many joints takes seconds, above all with cubic tracks, and the kernels only see the resulting bits.
        // The single joint gets enough keys that its rotations become full ones.
        const bool is_one = joint_count == 1;
        const Asset asset = make_asset({.joint_count = joint_count,
                                        .seed = joint_count,
                                        .clip_count = is_one ? 3u : 1u,
                                        .key_count = is_one ? 60u : 3u,
                                        .cubic = joint_count == 65});
        expect_sampled(compiled(asset));
        const Character packed = compiled(asset, {.error = 1e-4});
        ways.add(packed);
        expect_sampled(packed);
    }
    EXPECT_GT(ways.constant_count, 0u);
    EXPECT_GT(ways.step_count, 0u);
    EXPECT_GT(ways.full_count, 0u);
    EXPECT_EQ(ways.left_out.size(), 4u);
}

io::JointPose to_pose(const Trs<double>& t) {
    const auto f = [](double x) { return static_cast<float>(x); };
    return {.rotation = {f(t.rotation.x), f(t.rotation.y), f(t.rotation.z), f(t.rotation.w)},
            .translation = {f(t.translation.x), f(t.translation.y), f(t.translation.z), 0},
            .scale = {f(t.scale.x), f(t.scale.y), f(t.scale.z), 0}};
}

Affine affine_of(const io::vec4& rotation, const io::vec4& translation_scale) {
    const io::vec4 &q = rotation, &t = translation_scale;
    return to_affine(Trs<float>{{q.x, q.y, q.z, q.w}, {t.x, t.y, t.z}, {t.w, t.w, t.w}});
}

TEST(NativeKernels, BlendFollowsTheReference) {
    constexpr uint32_t kJoints = 70;
    Random random(2);
    std::vector<io::InstanceCursor> cursors;
    for (const float weight : {0.0f, 1.0f, 0.5f, 0.01f, 0.9f}) cursors.push_back({{}, {}, weight});
    std::vector<Trs<double>> first, second;
    for (size_t i = 0; i < cursors.size() * kJoints; ++i)
        for (std::vector<Trs<double>>* poses : {&first, &second}) {
            poses->push_back(random.trs(2, 0));
            poses->back().scale = Vec3<double>{1, 1, 1} * random.between(0.5, 2);
        }
    std::vector<io::JointPose> first_poses, second_poses, set_poses;
    for (const Trs<double>& pose : first) first_poses.push_back(to_pose(pose));
    for (const Trs<double>& pose : second) second_poses.push_back(to_pose(pose));
    // Instance 4 has a pose override at half weight
    std::vector<uint32_t> overrides{0, 0, 0, 0, 0, 0, 0, 0, 1, std::bit_cast<uint32_t>(0.5f)};
    for (uint32_t i = 0; i < 2 * kJoints; ++i) set_poses.push_back(to_pose(random.trs(1, 0)));
    for (const bool similarity : {false, true}) {
        auto local = unwritten<io::vec4>((similarity ? 2 : 3) * first.size());
        NativeRun run(kernels::blend.native, {similarity, true});
        run.bind(io::kCursorsBuffer, cursors).bind(io::kFirstPosesBuffer, first_poses);
        run.bind(io::kSecondPosesBuffer, second_poses).bind(io::kLocalBuffer, local);
        run.bind(io::kPoseOverridesBuffer, overrides).bind(io::kSetPosesBuffer, set_poses);
        run.workgroups(io::BlendPush{kJoints}, static_cast<uint32_t>(cursors.size()));
        for (size_t i = 0; i < first.size(); ++i) {
            Trs<double> wanted = blend_reference(first[i], second[i], double{cursors[i / kJoints].weight});
            if (i / kJoints == 4) {
                const io::JointPose& p = set_poses[kJoints + i % kJoints];
                wanted = blend_reference({{p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w},
                                          {p.translation.x, p.translation.y, p.translation.z},
                                          {p.scale.x, p.scale.y, p.scale.z}},
                                         wanted, 0.5);
            }
            Affine got;
            if (similarity)
                got = affine_of(local[2 * i], local[2 * i + 1]);
            else
                std::memcpy(static_cast<void*>(&got), &local[3 * i], sizeof got);
            EXPECT_LE(matrix_error(got, to_affine(wanted), std::max(1.0, length(wanted.translation))),
                      2 * kNativePoseBound);
        }
    }
}

// Products are exact, so the results must match bit for bit.
TEST(NativeKernels, ScanIsExact) {
    constexpr uint32_t kInstances = 70;
    const ScanLimits limits{.shared_memory_bytes = 32768, .workgroup_size = 1024, .subgroup_size = 8, .is_cpu = true};
    for (const char* name : {"serial", "serial_transposed"})
        for (const RigShape shape : kRigShapes)
            for (const uint32_t joint_count : {1u, 100u}) {
                Random random(joint_count);
                const std::vector<uint32_t> parents = make_parents(shape, joint_count);
                ScanPlan plan = plan_scan(*find_scan_method(name), ScanRig(parents), limits, 0);
                std::vector<Affine> local, model = unwritten<Affine>(kInstances * joint_count);
                for (size_t i = 0; i < model.size(); ++i) local.push_back(exact_transform(random));
                NativeRun run(scan_shaders(name).native, plan.constants, plan.workgroup_size);
                run.bind(io::kLocalBuffer, local).bind(io::kModelBuffer, model).bind(io::kScanLinksBuffer, plan.links);
                run.invocations(io::ScanPush{joint_count, kInstances, 1}, kInstances);
                const bool is_transposed = scan_shaders(name).name == "serial_transposed";
                for (uint32_t i = 0; i < kInstances; ++i) {
                    const auto at = [&](uint32_t joint) {
                        return is_transposed ? joint * kInstances + i : i * joint_count + joint;
                    };
                    std::vector<AffineT<double>> of_instance;
                    for (uint32_t j = 0; j < joint_count; ++j) of_instance.push_back(local[at(j)].as<double>());
                    const auto wanted = scan_reference(parents, of_instance);
                    for (uint32_t j = 0; j < joint_count; ++j)
                        ASSERT_EQ(model[at(j)].as<double>(), wanted[j]) << name << ", " << name_of(shape);
                }
            }
}

TEST(NativeKernels, ScanOfSimilaritiesFollowsTheReference) {
    constexpr uint32_t kJoints = 40;
    Random random(3);
    const std::vector<uint32_t> parents = make_parents(RigShape::kRandom, kJoints);
    const ScanLimits limits{.shared_memory_bytes = 32768, .workgroup_size = 64, .subgroup_size = 8, .is_cpu = true};
    ScanPlan plan = plan_scan(*find_scan_method("serial_quaternion"), ScanRig(parents, true), limits, 0);
    std::vector<io::vec4> local;
    std::vector<AffineT<double>> wanted;
    for (uint32_t j = 0; j < kJoints; ++j) {
        Trs<double> trs = random.trs(0.2, 0);
        trs.scale = Vec3<double>{1, 1, 1} * random.between(0.9, 1.1);
        const io::JointPose pose = to_pose(trs);
        local.push_back(pose.rotation);
        local.push_back({pose.translation.x, pose.translation.y, pose.translation.z, pose.scale.x});
        wanted.push_back(to_affine(trs));
    }
    wanted = scan_reference(parents, wanted);
    auto model = unwritten<Affine>(kJoints);
    NativeRun run(scan_shaders("serial_quaternion").native, plan.constants, plan.workgroup_size);
    run.bind(io::kLocalBuffer, local).bind(io::kModelBuffer, model).bind(io::kScanLinksBuffer, plan.links);
    run.invocations(io::ScanPush{kJoints, 1, 1}, 1);
    for (uint32_t j = 0; j < kJoints; ++j) EXPECT_LE(matrix_error(model[j], wanted[j], 1), 1e-5);
}

// In every format.
TEST(NativeKernels, BindFollowsTheReference) {
    constexpr uint32_t kJoints = 30, kInstances = 5;
    for (const uint32_t palette_count : {1u, 64u, 130u}) {
        Random random(palette_count);
        const auto similar = [&] {
            Trs<double> trs = random.trs(1, 0);
            trs.scale = Vec3<double>{1, 1, 1} * random.between(0.5, 2);
            return to_affine(trs).as<float>();
        };
        std::vector<PaletteEntry> palette;
        std::vector<uint32_t> joints;
        std::vector<Affine> binds, model;
        for (uint32_t entry = 0; entry < palette_count; ++entry) {
            palette.push_back({.joint = random.below(kJoints), .joint_from_bind = similar()});
            joints.push_back(palette.back().joint);
            binds.push_back(palette.back().joint_from_bind);
        }
        std::vector<AffineT<double>> wanted;
        for (uint32_t i = 0; i < kInstances; ++i) {
            std::vector<AffineT<double>> of_instance;
            for (uint32_t j = 0; j < kJoints; ++j) {
                model.push_back(similar());
                of_instance.push_back(model.back().as<double>());
            }
            const auto bound = bind_reference(palette, of_instance);
            wanted.insert(wanted.end(), bound.begin(), bound.end());
        }
        for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine, SkinFormat::kSimilarity}) {
            auto skin = unwritten<uint32_t>(wanted.size() * skin_format_bytes(format) / 4);
            NativeRun run(kernels::bind.native, {static_cast<uint32_t>(format)});
            run.bind(io::kModelBuffer, model).bind(io::kPaletteJointsBuffer, joints);
            run.bind(io::kJointFromBindBuffer, binds).bind(io::kSkinBuffer, skin);
            run.workgroups(io::BindPush{kJoints, palette_count}, kInstances);
            for (size_t i = 0; i < wanted.size(); ++i) {
                Affine got;
                const uint32_t* const words = skin.data() + i * skin_format_bytes(format) / 4;
                if (format == SkinFormat::kAffine) {
                    std::memcpy(static_cast<void*>(&got), words, sizeof got);
                } else if (format == SkinFormat::kSimilarity) {
                    io::vec4 rows[2];
                    std::memcpy(static_cast<void*>(rows), words, sizeof rows);
                    got = affine_of(rows[0], rows[1]);
                } else {
                    for (size_t k = 0; k < 12; ++k)
                        got.row[k / 4][k % 4] = io::float_of(words[k / 2] >> 16 * (k % 2) & 0xFFFF);
                }
                const double bound = format == SkinFormat::kHalfAffine ? 2e-3 : 3e-6;
                ASSERT_LE(matrix_error(got, wanted[i], 1), bound) << "format " << static_cast<int>(format);
            }
        }
    }
}

// Halves are IEEE: compared with the compiler's own conversion.
TEST(NativeKernels, HalvesAreRoundedToTheNearest) {
    for (uint32_t half = 0; half < 0x10000; ++half) {
        const float number = io::float_of(half);
        if ((half & 0x7FFF) > 0x7C00) {
            EXPECT_TRUE(std::isnan(number) && std::isnan(io::float_of(io::half_of(number))));
            continue;
        }
        ASSERT_EQ(io::half_of(number), half);
        if ((half & 0x7FFF) >= 0x7BFF) continue;
        const float next = io::float_of(half + 1), middle = number + (next - number) / 2;
        ASSERT_EQ(io::half_of(middle), half + (half & 1)) << "of two the even one";
        ASSERT_EQ(io::half_of(std::nextafter(middle, next)), half + 1);
        ASSERT_EQ(io::half_of(std::nextafter(middle, number)), half);
    }
    EXPECT_EQ(io::half_of(65519.996f), 0x7BFFu);
    EXPECT_EQ(io::half_of(65520), 0x7C00u);
    EXPECT_EQ(io::half_of(1e-8f), 0u);
    EXPECT_EQ(io::float_of(0x3C00), 1);
}

}  // namespace
}  // namespace throng
