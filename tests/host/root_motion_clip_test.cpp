// Root motion extracted from clips: the extracted motion and the remaining clip together give the original.
#include "control/root_motion_reference.h"
#include "controller/controller_arrays.h"
#include "sample/sample_reference.h"
#include "tests/files.h"
#include "tests/test_rig.h"
#include "tests/walker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

using namespace test;
using std::numbers::pi;

const CompileSettings kTaken{.error = 0, .root_motion_joint = "hips"};

RootRows rows_of(const Character& character, const Clip& clip) {
    return RootRows(character.root_rows).subspan(clip.first_root_row, clip.root_row_count);
}

Vec3<double> moved(const GroundMove& move, const Vec3<double>& p) {
    return {move.cos * p.x + move.sin * p.z + move.x, p.y, -move.sin * p.x + move.cos * p.z + move.z};
}

std::vector<Vec3<double>> points(const Character& character, uint32_t clip, double time_s) {
    return reference_positions(character, *reference_pose(character, {.first = {clip, time_s, 1, false}}));
}

// The largest distance of a vertex between the whole clip and the remaining clip moved by its root rows, as a fraction
// of the size.
double put_together_error(const Character& whole, const Character& taken, uint32_t clip, double time_s) {
    const double duration_s = whole.clips[clip].duration_s;
    const GroundMove place = place_at(rows_of(taken, taken.clips[clip]), phase_at(time_s, duration_s, false));
    const std::vector<Vec3<double>> wanted = points(whole, clip, time_s), got = points(taken, clip, time_s);
    double worst = 0;
    for (size_t v = 0; v < wanted.size(); ++v) worst = worse_of(worst, length(moved(place, got[v]) - wanted[v]));
    return worst / double{whole.size};
}

void expect_put_together(const Walker& walker, double between) {
    const Character whole = compiled(walker.asset), taken = compiled(walker.asset, kTaken);
    for (uint32_t clip = 0; clip < whole.clips.size(); ++clip) {
        SCOPED_TRACE(whole.clips[clip].name);
        EXPECT_GE(taken.clips[clip].root_row_count, 2u);
        for (uint32_t row = 0; row < whole.clips[clip].row_count; ++row)
            EXPECT_LE(put_together_error(whole, taken, clip, whole.times_s[whole.clips[clip].first_time + row]), 1e-5)
                << row;
        Random random(4);
        double worst = 0;
        for (int i = 0; i < 2000; ++i)
            worst = std::max(worst,
                             put_together_error(whole, taken, clip, random.between(0, whole.clips[clip].duration_s)));
        EXPECT_LE(worst, between);
    }
}

TEST(RootMotionOfClips, RootMotionAndRemainderGiveTheOriginalClip) {
    for (const bool armature_is_joint : {false, true}) {
        Walker walker(armature_is_joint);
        for (const double rate : {30.0, 24.0, 60.0, 7.0})
            walker.move(("walk of " + std::to_string(rate)).c_str(), times(2, rate), walk);
        walker.move("uneven", {0, 0.01f, 0.3f, 0.31f, 0.9f, 1.2345f}, walk);
        walker.move("two keys", {0, 1}, walk);
        walker.move("late", {0.4f, 0.5f, 0.61f}, walk);
        expect_put_together(walker, 1e-3);
    }
}

TEST(RootMotionOfClips, RowsAreEvenlySpacedAndExactAtBothEnds) {
    Walker walker(true);
    for (const double duration_s : {2.0, 31.0 / 30, 0.5, 0.01}) walker.move("walk", times(duration_s, 30), walk);
    const Character taken = compiled(walker.asset, kTaken);
    const std::array<uint32_t, 4> counts{121, 63, 31, 2};
    uint32_t first = 0;
    for (size_t i = 0; i < counts.size(); ++i) {
        const Clip& clip = taken.clips[i];
        EXPECT_EQ(clip.first_root_row, first);
        ASSERT_EQ(clip.root_row_count, counts[i]);
        first += counts[i];
        const RootRows rows = rows_of(taken, clip);
        EXPECT_EQ(rows.front(), (std::array<float, 4>{0, 0, 1, 0}));
        const ModelPose begin = walk(0), end = walk(clip.duration_s);
        const double yaw = 50 * pi / 180 * double{clip.duration_s};
        const GroundMove last{rows.back()[0], rows.back()[1], rows.back()[2], rows.back()[3]};
        EXPECT_NEAR(last.cos, std::cos(yaw), 0.01) << "a pelvis that rolls turns a little";
        EXPECT_NEAR(std::hypot(last.cos, last.sin), 1, 1e-6);
        const Vec3<double> hips = moved(last, begin.position);
        EXPECT_NEAR(hips.x, end.position.x, 2e-6);
        EXPECT_NEAR(hips.z, end.position.z, 2e-6);
    }
    EXPECT_EQ(taken.root_rows.size(), first);
}

TEST(RootMotionOfClips, TheRemainingClipStaysAtItsStart) {
    Walker walker(false);
    walker.move("walk", times(2, 30), walk);
    const Character taken = compiled(walker.asset, kTaken);
    const uint32_t hips = 0;
    ASSERT_EQ(taken.rig.names[hips], "hips");
    const ReferencePose begin = *reference_pose(taken, {.first = {0, 0, 1, false}});
    for (double time_s = 0; time_s <= 2; time_s += 0.01) {
        const ReferencePose pose = *reference_pose(taken, {.first = {0, time_s, 1, false}});
        const auto &from = begin.model_from_joint[hips].row, &to = pose.model_from_joint[hips].row;
        EXPECT_NEAR(to[0][3], from[0][3], 2e-4);
        EXPECT_NEAR(to[2][3], from[2][3], 2e-4);
        EXPECT_NEAR(to[1][3], walk(time_s).position.y, 1e-3);
        // The rotation relative to the clip's start has no twist about +y: its matrix is symmetric in these entries.
        double against_x = 0, against_z = 0;  // entries (z, x) and (x, z) of to * transposed(from)
        for (size_t k = 0; k < 3; ++k) {
            against_x += to[2][k] * from[0][k] * 1e4;
            against_z += to[0][k] * from[2][k] * 1e4;
        }
        EXPECT_NEAR(against_x, against_z, 1e-3);
    }
}

TEST(RootMotionOfClips, ASecondCycleContinuesFromTheFirst) {
    Walker walker(true);
    walker.move("walk", times(2, 30), walk);  // whole periods of everything that sways
    const Character taken = compiled(walker.asset, kTaken);
    walker.asset.clips.clear();
    walker.move("twice", times(4, 30), walk);
    const Character twice = compiled(walker.asset);
    const RootRows rows = rows_of(taken, taken.clips[0]);
    for (double time_s = 0; time_s < 2; time_s += 1.0 / 30) {
        const GroundMove place = move_between(rows, 0, phase_at(time_s, 2, false), 1);
        const std::vector<Vec3<double>> wanted = points(twice, 0, 2 + time_s), got = points(taken, 0, time_s);
        for (size_t v = 0; v < wanted.size(); ++v) EXPECT_LE(length(moved(place, got[v]) - wanted[v]), 1e-5) << time_s;
    }
}

TEST(RootMotionOfClips, AClipWithoutRootMotionHasNoRows) {
    Walker walker(true);
    const auto nod = [](double time_s) {
        return ModelPose{axis_angle(Vec3<double>{1, 0, 0}, 0.2 * std::sin(6 * time_s)),
                         {0.1, 0.9 + 0.1 * std::sin(6 * time_s), 0.3}};
    };
    walker.move("idle", times(1, 30), nod);
    const Character whole = compiled(walker.asset);
    Character taken = compiled(walker.asset, kTaken);
    EXPECT_EQ(taken.keys, whole.keys);
    EXPECT_TRUE(taken.root_rows.empty());
    ASSERT_EQ(taken.warnings.size(), 1u);
    EXPECT_NE(taken.warnings[0].find("'hips' does not move over the ground in any clip"), std::string::npos);

    walker.move("walk", times(1, 30), walk);
    walker.clip("nothing", 0);
    walker.move("idle again", times(1, 30), nod);
    taken = compiled(walker.asset, kTaken);
    EXPECT_TRUE(taken.warnings.empty());
    for (const uint32_t clip : {0u, 2u, 3u})
        EXPECT_EQ(taken.clips[clip].root_row_count + taken.clips[clip].first_root_row, 0u);
    EXPECT_EQ(taken.clips[1].root_row_count, 61u);
    const Character all = compiled(walker.asset);
    for (const uint32_t clip : {0u, 2u, 3u}) {
        EXPECT_EQ(taken.clips[clip].size_bytes, all.clips[clip].size_bytes);
        for (double time_s = 0; time_s < 1; time_s += 0.07)
            EXPECT_EQ(points(taken, clip, time_s), points(all, clip, time_s));
    }
}

// If the root jumps, the remaining clip must not keep a part of the jump.
TEST(RootMotionOfClips, StepKeysAreTakenEntirely) {
    Walker walker(true);
    walker.move(
        "steps", {0, 0.255f, 0.71f, 1},
        [](double time_s) {
            return ModelPose{axis_angle(kUp, time_s), {3 * time_s, 0.9, 0.2}};
        },
        Interpolation::kStep);
    const Character whole = compiled(walker.asset), taken = compiled(walker.asset, kTaken);
    EXPECT_EQ(taken.clips[0].row_count, 4u);
    for (double time_s = 0; time_s <= 1; time_s += 0.003) {
        const bool jumping = std::abs(time_s - 0.255) < 0.017 || std::abs(time_s - 0.71) < 0.017 || time_s > 0.983;
        if (jumping) continue;
        EXPECT_LE(put_together_error(whole, taken, 0, time_s), 1e-5) << time_s;
    }
}

TEST(RootMotionOfClips, TurnsOfAnySizeAreFollowed) {
    Walker walker(true);
    const auto spin = [](double degrees_per_s) {
        return [degrees_per_s](double time_s) {
            return ModelPose{
                axis_angle(kUp, degrees_per_s * pi / 180 * time_s) * axis_angle(Vec3<double>{0, 0, 1}, 0.3),
                {0.2, 0.9, -0.1}};
        };
    };
    // 17 degrees a row: the chord is 1.1 % shorter than the radius of 0.2
    walker.move("fast", times(2, 10), spin(1000));
    expect_put_together(walker, 2e-3);
    walker.asset.clips.clear();
    walker.move("half turns", times(4, 1), spin(180));
    walker.move("back", times(2, 30), spin(-720));
    expect_put_together(walker, 1e-3);
    const Character taken = compiled(walker.asset, kTaken);
    for (const Clip& clip : taken.clips)
        for (uint32_t row = 1; row < clip.row_count; ++row) {
            const uint32_t word =
                taken.tracks[static_cast<size_t>(&clip - taken.clips.data()) * taken.rig.joint_count() + Walker::kHips]
                    .rotation;
            if (!(word & kTrackAnimated)) continue;
            const auto &a = taken.keys[(word & kTrackPosition) + (row - 1) * clip.row_stride],
                       &b = taken.keys[(word & kTrackPosition) + row * clip.row_stride];
            EXPECT_GE(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3], 0);
        }
}

// The root turns over forward and lands on its feet, which is no rotation about +y.
TEST(RootMotionOfClips, ASomersaultIsNoRotationAboutTheUpAxis) {
    Walker walker(false);
    walker.move("somersault", times(1, 30), [](double time_s) {
        return ModelPose{axis_angle(Vec3<double>{1, 0, 0}, 2 * pi * time_s),
                         {0, 0.9 + time_s * (1 - time_s), 2 * time_s}};
    });
    expect_put_together(walker, 1e-3);
    const Character taken = compiled(walker.asset, kTaken);
    for (const auto& row : taken.root_rows) EXPECT_NEAR(row[2], 1, 1e-4);
}

TEST(RootMotionOfClips, ErrorsNameTheWrongJoint) {
    const auto expect_error = [](const Asset& asset, const char* joint, ErrorCode code,
                                 const std::vector<std::string>& named) {
        const Result<Character> refused = compile_character(asset, {.error = 0, .root_motion_joint = joint});
        ASSERT_FALSE(refused) << joint;
        EXPECT_EQ(refused.error().code, code);
        for (const std::string& name : named)
            EXPECT_NE(refused.error().text().find(name), std::string::npos) << refused.error().text();
    };
    Walker walker(true);
    walker.move("walk", times(1, 30), walk);
    expect_error(walker.asset, "hisp", ErrorCode::kInvalidArgument,
                 {"walker", "there is no joint 'hisp'; did you mean 'hips'? There are: armature, hips, leg"});
    expect_error(walker.asset, "leg", ErrorCode::kUnsupported, {"'hips', above 'leg', is animated in clip 'walk'"});
    for (const double scale : {0.0, 0.02}) {
        Asset uneven = walker.asset;
        uneven.nodes[Walker::kArmature].parent_from_node.scale.y = scale;
        expect_error(uneven, "hips", ErrorCode::kUnsupported, {"'armature', above 'hips', is scaled by 0.01"});
    }
    Asset nearly = walker.asset;  // as converters write it
    nearly.nodes[Walker::kArmature].parent_from_node.scale.y = 0.0100000001;
    EXPECT_TRUE(compile_character(nearly, kTaken));
    Asset mirrored = walker.asset;
    mirrored.nodes[Walker::kArmature].parent_from_node.scale = {-0.01, -0.01, -0.01};
    const Character whole = compiled(mirrored), taken = compiled(mirrored, kTaken);
    for (double time_s = 0; time_s < 1; time_s += 0.05) EXPECT_LE(put_together_error(whole, taken, 0, time_s), 1e-3);
}

TEST(RootMotionOfClips, PackedClipsKeepTheirBound) {
    Walker walker(true);
    walker.move("walk", times(2, 30), walk);
    walker.move("slow", times(3, 24), [](double time_s) { return walk(time_s / 2); });
    for (const double bound : {1e-3, 1e-4}) {
        const Character exact = compiled(walker.asset, kTaken),
                        packed = compiled(walker.asset, {.error = bound, .root_motion_joint = "hips"});
        ASSERT_TRUE(packed.packed);
        EXPECT_EQ(packed.root_rows, exact.root_rows);
        for (uint32_t clip = 0; clip < packed.clips.size(); ++clip) {
            EXPECT_LE(packed.clips[clip].error, bound);
            EXPECT_GT(packed.clips[clip].size_bytes, packed.clips[clip].root_row_count * 16);
            for (double time_s = 0; time_s < packed.clips[clip].duration_s; time_s += 0.011) {
                const std::vector<Vec3<double>> wanted = points(exact, clip, time_s),
                                                got = points(packed, clip, time_s);
                for (size_t v = 0; v < wanted.size(); ++v)
                    EXPECT_LE(length(got[v] - wanted[v]), (bound + 1e-6) * double{exact.size});
            }
        }
    }
}

TEST(RootMotionOfClips, IsSavedInCharacterFiles) {
    Walker walker(true);
    walker.move("walk", times(2, 30), walk);
    walker.move("again", times(1, 30), walk);
    const TemporaryFolder folder;
    for (const double error : {0.0, 1e-4}) {
        const Character taken = compiled(walker.asset, {.error = error, .root_motion_joint = "hips"});
        const Result<void> saved = save_character(taken, folder.path() / "walker.throng");
        ASSERT_TRUE(saved) << saved.error().text();
        const Result<Character> again = load_character(folder.path() / "walker.throng");
        ASSERT_TRUE(again) << again.error().text();
        EXPECT_EQ(again->root_rows, taken.root_rows);
        for (size_t clip = 0; clip < 2; ++clip) {
            EXPECT_EQ(again->clips[clip].first_root_row, taken.clips[clip].first_root_row);
            EXPECT_EQ(again->clips[clip].root_row_count, taken.clips[clip].root_row_count);
        }
    }
}

}  // namespace
}  // namespace throng
