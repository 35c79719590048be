// Blended poses as matrices, against the reference.
#include "blend/blend.h"
#include "blend/blend_reference.h"
#include "tests/joint_pose.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace throng {
namespace {

const test::InSubset kBlendInSubsets({test::Subset::kGpuAssisted}, {"Blend.*"});
const test::InSubset kBlendNatively({test::Subset::kNative}, {"Blend.*"});

using namespace test;

constexpr double kBlendBound = 2e-6;  // of an element, relative where it exceeds 1

Trs<double> as_trs(const io::JointPose& p) {
    return {{p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w},
            {p.translation.x, p.translation.y, p.translation.z},
            {p.scale.x, p.scale.y, p.scale.z}};
}

std::vector<Affine> run_blend(const std::vector<float>& weights, const std::vector<io::JointPose>& first,
                              const std::vector<io::JointPose>& second, uint32_t joint_count) {
    std::vector<io::InstanceCursor> cursors;
    for (const float weight : weights) cursors.push_back({.first = {}, .second = {}, .weight = weight});
    const Guarded<io::InstanceCursor> cursor_buffer(cursors);
    const Guarded<io::JointPose> first_poses(first), second_poses(second);
    const Guarded<Affine> local(poison<Affine>(first.size()));
    run_workgroups(blend_kernel(test_gpu(), {.output = BlendOutput::kAffine}),
                   BufferTable{{io::kCursorsBuffer, cursor_buffer},
                               {io::kFirstPosesBuffer, first_poses},
                               {io::kSecondPosesBuffer, second_poses},
                               {io::kLocalBuffer, local},
                               {io::kPoseOverridesBuffer, Guarded<uint32_t>({})},
                               {io::kSetPosesBuffer, first_poses},
                               {io::kBirthsBuffer, Guarded<uint32_t>({})}},
                   io::BlendPush{joint_count}, static_cast<uint32_t>(weights.size()));
    EXPECT_TRUE(same_bits(first_poses.read(), first) && same_bits(second_poses.read(), second))
        << "the stage wrote its input";
    return local.read();
}

// Rotations, uniform scales and translations come out unchanged at weights 0 and 1, and blended between.
TEST(Blend, SimilaritiesAreTheSameTransforms) {
    constexpr uint32_t kJoints = 70;
    Random random(3);
    const std::vector<float> weights{0, 1, 0.3f, 0.8f};
    std::vector<io::InstanceCursor> cursors;
    for (const float weight : weights) cursors.push_back({.first = {}, .second = {}, .weight = weight});
    std::vector<io::JointPose> first, second;
    for (size_t i = 0; i < weights.size() * kJoints; ++i) {
        for (std::vector<io::JointPose>* poses : {&first, &second}) {
            Trs<double> trs = random.trs(2, 0);
            trs.scale = Vec3<double>{1, 1, 1} * random.between(0.5, 2);
            poses->push_back(to_pose(trs));
        }
    }
    const Guarded<io::InstanceCursor> cursor_buffer(cursors);
    const Guarded<io::JointPose> first_poses(first), second_poses(second);
    const Guarded<io::vec4> local(poison<io::vec4>(2 * first.size()));  // rotation; translation and scale
    run_workgroups(blend_kernel(test_gpu(), {.output = BlendOutput::kSimilarity}),
                   BufferTable{{io::kCursorsBuffer, cursor_buffer},
                               {io::kFirstPosesBuffer, first_poses},
                               {io::kSecondPosesBuffer, second_poses},
                               {io::kLocalBuffer, local},
                               {io::kPoseOverridesBuffer, Guarded<uint32_t>({})},
                               {io::kSetPosesBuffer, first_poses},
                               {io::kBirthsBuffer, Guarded<uint32_t>({})}},
                   io::BlendPush{kJoints}, static_cast<uint32_t>(weights.size()));
    const std::vector<io::vec4> rows = local.read();
    for (size_t i = 0; i < first.size(); ++i) {
        const io::vec4 q = rows[2 * i], t = rows[2 * i + 1];
        const Trs<float> got{{q.x, q.y, q.z, q.w}, {t.x, t.y, t.z}, {t.w, t.w, t.w}};
        const Trs<double> wanted = blend_reference(as_trs(first[i]), as_trs(second[i]), weights[i / kJoints]);
        EXPECT_LE(matrix_error(to_affine(got), to_affine(wanted), std::max(1.0, length(wanted.translation))),
                  kBlendBound)
            << "joint " << i;
    }
}

TEST(Blend, FollowsTheReference) {
    for (const uint32_t joint_count : {1u, 64u, 65u, 300u}) {
        Random random(joint_count);
        std::vector<float> weights{0, 1, 0.5f, 0.25f, 1e-6f, 1 - 1e-6f};
        for (int i = 0; i < 30; ++i) weights.push_back(static_cast<float>(random.unit()));
        std::vector<io::JointPose> first, second;
        for (size_t i = 0; i < weights.size() * joint_count; ++i) {
            Trs<double> a = random.trs(2, 0.5), b = random.trs(2, 0.5);
            // Nearly the same rotation
            if (random.chance(0.3))
                b.rotation = normalized(a.rotation * axis_angle(random.direction(), random.between(0, 0.01)));
            const double cosine = dot(a.rotation, b.rotation);
            if (std::abs(cosine) < 1e-3) b.rotation = a.rotation;  // neither way is the shorter one
            if (random.chance(0.5)) b.rotation = -b.rotation;      // the other hemisphere
            first.push_back(to_pose(a));
            second.push_back(to_pose(b));
        }
        const std::vector<Affine> local = run_blend(weights, first, second, joint_count);
        double worst = 0;
        for (size_t i = 0; i < local.size(); ++i) {
            const double weight = weights[i / joint_count];
            const Trs<double> wanted = blend_reference(as_trs(first[i]), as_trs(second[i]), weight);
            const double error = matrix_error(local[i], to_affine(wanted), std::max(1.0, length(wanted.translation)));
            EXPECT_LE(error, kBlendBound) << "weight " << weight;
            worst = std::max(worst, error);
        }
        std::printf("  %3u joints, %zu weights: largest error %.1e\n", joint_count, weights.size(), worst);
    }
}

// The pose of a clip with weight 0 was never written: its contents must not show.
TEST(Blend, APoseWithZeroWeightIsNotShown) {
    constexpr uint32_t kJointCount = 70;
    Random random(4);
    std::vector<io::JointPose> first = poison<io::JointPose>(2 * kJointCount), second = first;
    for (size_t joint = 0; joint < kJointCount; ++joint) {
        first[joint] = to_pose(random.trs(1, 0.2));
        second[kJointCount + joint] = to_pose(random.trs(1, 0.2));
    }
    const std::vector<Affine> local = run_blend({1, 0}, first, second, kJointCount);
    for (size_t joint = 0; joint < kJointCount; ++joint) {
        EXPECT_LE(matrix_error(local[joint], to_affine(as_trs(first[joint])), 1), kBlendBound);
        EXPECT_LE(matrix_error(local[kJointCount + joint], to_affine(as_trs(second[kJointCount + joint])), 1),
                  kBlendBound);
    }
}

TEST(Blend, TheReferenceTakesTheShorterWay) {
    const Trs<double> a{
        .rotation = axis_angle(Vec3<double>{0, 0, 1}, 0.2), .translation = {1, 0, 0}, .scale = {1, 2, 3}};
    const Trs<double> b{
        .rotation = -axis_angle(Vec3<double>{0, 0, 1}, 0.4), .translation = {0, 4, 0}, .scale = {2, 2, 2}};
    const Trs<double> half = blend_reference(a, b, 0.5);
    EXPECT_NEAR(std::abs(dot(half.rotation, axis_angle(Vec3<double>{0, 0, 1}, 0.3))), 1, 1e-12);
    const Trs<double> quarter = blend_reference(a, b, 0.25);
    EXPECT_EQ(quarter.translation, (Vec3<double>{0.25, 3, 0}));
    EXPECT_EQ(quarter.scale, (Vec3<double>{1.75, 2, 2.25}));
}

}  // namespace
}  // namespace throng
