// What compiled clips keep exactly, and what they may leave out.
#include <throng/controller.h>
#include <throng/procedural.h>

#include "compile/clip/read_clips.h"
#include "compile/rig/rig.h"
#include "sample/sample_reference.h"
#include "tests/host/compile_cases.h"
#include "tests/shared.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace throng {
namespace {

using namespace test;

struct TrackErrors {
    double rotation_rad = 0, translation = 0, scale = 0;
};

// Compares the compiled clip with the source at times on, near and between the keys. `asset` must have no node that is
// folded.
TrackErrors clip_errors(const Asset& asset, const Character& character, uint32_t clip) {
    TrackErrors errors;
    std::vector<double> times_s;
    const Clip& compiled = character.clips[clip];
    for (uint32_t row = 0; row < compiled.row_count; ++row) {
        const double time_s = character.times_s[compiled.first_time + row];
        const double next_s = row + 1 < compiled.row_count ? character.times_s[compiled.first_time + row + 1] : time_s;
        for (const double w : {0.0, 0.1, 0.37, 0.5, 0.83}) times_s.push_back(time_s + w * (next_s - time_s));
    }
    times_s.push_back(compiled.duration_s);
    times_s.push_back(0);
    std::vector<AssetClip> of_nodes(asset.nodes.size());  // one clip per node, since node_trs() searches all tracks
    for (const AssetTrack& track : asset.clips[clip].tracks) of_nodes[track.node].tracks.push_back(track);
    for (const double time_s : times_s) {
        const std::vector<Trs<double>> pose = sample_reference(character, clip, time_s);
        for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
            const uint32_t node = character.rig.nodes[joint];
            const Trs<double> wanted = node_trs(asset, node, &of_nodes[node], time_s);
            const auto &q = pose[joint].rotation, w = normalized(wanted.rotation);
            const double chord = std::min(dot(Quaternion<double>{q.x - w.x, q.y - w.y, q.z - w.z, q.w - w.w},
                                              {q.x - w.x, q.y - w.y, q.z - w.z, q.w - w.w}),
                                          dot(Quaternion<double>{q.x + w.x, q.y + w.y, q.z + w.z, q.w + w.w},
                                              {q.x + w.x, q.y + w.y, q.z + w.z, q.w + w.w}));
            errors.rotation_rad = worse_of(errors.rotation_rad, 2 * std::sqrt(chord));
            errors.translation = worse_of(errors.translation, length(pose[joint].translation - wanted.translation));
            errors.scale = worse_of(errors.scale, length(pose[joint].scale - wanted.scale));
        }
    }
    return errors;
}

TEST(Compile, LinearAndSteppedClipsAreExact) {
    for (const uint64_t seed : {1u, 2u, 3u}) {
        const Asset asset = make_asset(
            {.joint_count = 30, .seed = seed, .clip_count = 3, .axis_count = 5, .key_count = 9});
        const Character character = compiled(asset);
        ASSERT_EQ(character.clips.size(), 3u);
        for (uint32_t clip = 0; clip < 3; ++clip) {
            const TrackErrors errors = clip_errors(asset, character, clip);
            EXPECT_LE(errors.rotation_rad, 4e-7);  // rounding to float
            EXPECT_LE(errors.translation, 1e-7);
            EXPECT_LE(errors.scale, 2e-7);
            const Clip& compiled = character.clips[clip];
            EXPECT_EQ(compiled.row_count, 45u) << "the union of five axes of nine";
            EXPECT_EQ(compiled.refined_row_count, 0u);
            EXPECT_EQ(compiled.dropped_row_count, 0u);
            EXPECT_EQ(compiled.duration_s, static_cast<float>(asset.clips[clip].duration_s));
            EXPECT_EQ(compiled.channel_count, asset.clips[clip].tracks.size());
            uint64_t key_count = 0;
            for (const AssetTrack& track : asset.clips[clip].tracks) key_count += track.times_s.size();
            EXPECT_EQ(compiled.source_key_count, key_count);
            EXPECT_EQ(character.find_clip(asset.clips[clip].name), clip);
        }
    }
    EXPECT_EQ(compiled(make_asset({})).find_clip("no such clip"), kNone);
}

TEST(Compile, JointsAreFoundByTheirNames) {
    Character character = compiled(make_asset({}));
    character.rig.names[3] = character.rig.names[5] = "hand";
    EXPECT_EQ(character.rig.find_joint("hand"), 3u) << "the first";
    EXPECT_EQ(character.rig.find_joint("no such joint"), kNone);
    EXPECT_EQ(character.rig.joint_named("hand").value(), 3u);
    character.rig.names.resize(2);
    EXPECT_EQ(character.rig.joint_named("arm").error().text(),
              "rig: there is no joint 'arm'. There are: " + character.rig.names[0] + ", " + character.rig.names[1]);
}

TEST(Compile, ErrorsForUnknownNamesListWhatExists) {
    Character character = compiled(make_asset({.clip_count = 2}));
    character.name = "fox.glb";
    character.clips[0].name = "walk";
    character.clips[1].name = "run";
    EXPECT_EQ(character.clip_named("run").value(), 1u);
    EXPECT_EQ(character.clip_named("Walk").error().text(),
              "fox.glb: there is no clip 'Walk'; did you mean 'walk'? There are: walk, run");
    EXPECT_EQ(character.morph_named("smile").error().text(), "fox.glb: there is no morph 'smile', nor any other");
    Controller controller = direct_layers(1, {{.name = "tail", .items = {}}});
    controller.name = "guard";
    EXPECT_EQ(controller.mask_named("tail").value(), 0u);
    EXPECT_EQ(controller.mask_named("tial").error().text(),
              "guard: there is no mask 'tial'; did you mean 'tail'? There is: tail");
    EXPECT_EQ(controller.parameter_named("speed").error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(controller.layer_named(controller.layers[0].name).value(), 0u);
    const ControllerLayer layer{.name = "legs", .states = {{.name = "idle"}, {.name = "run"}}};
    EXPECT_EQ(layer.find_state("run"), 1u);
    EXPECT_EQ(layer.find_state("walk"), kNone);
    EXPECT_EQ(layer.state_named("run").value(), 1u);
    EXPECT_EQ(layer.state_named("runs").error().text(),
              "legs: there is no state 'runs'; did you mean 'run'? There are: idle, run");
    const ProceduralRules rules{.targets = {"eye"}, .rules = {}};
    EXPECT_EQ(rules.target_named("eye").value(), 0u);
    EXPECT_EQ(rules.target_named("Eye").error().text(),
              "procedural rules: there is no target 'Eye'; did you mean 'eye'? There is: eye");
}

TEST(Compile, CubicClipsAreRefinedToTheBound) {
    TrackErrors worst;
    uint32_t rows = 0;
    for (const uint64_t seed : kSanitized ? std::vector<uint64_t>{4} : std::vector<uint64_t>{4, 5, 6}) {
        const Asset asset = make_asset(
            {.joint_count = 20, .seed = seed, .clip_count = 2, .key_count = 5, .cubic = true});
        const Character character = compiled(asset);
        for (uint32_t clip = 0; clip < 2; ++clip) {
            const TrackErrors errors = clip_errors(asset, character, clip);
            worst.rotation_rad = std::max(worst.rotation_rad, errors.rotation_rad);
            worst.translation = std::max(worst.translation, errors.translation / character.size);
            worst.scale = std::max(worst.scale, errors.scale);
            EXPECT_GT(character.clips[clip].refined_row_count, 0u);
            rows += character.clips[clip].refined_row_count;
        }
    }
    constexpr double kRounding = 4e-7;
    EXPECT_LE(worst.rotation_rad, 1e-6 + kRounding);
    EXPECT_LE(worst.translation, 1e-6 + kRounding);
    EXPECT_LE(worst.scale, 1e-6 + kRounding);
    std::printf("  cubic clips, %u rows added: largest error %.1e rad, %.1e of the size, factor %.1e\n", rows,
                worst.rotation_rad, worst.translation, worst.scale);
}

// A symmetric curve crosses its chord in the middle: a check only there would take it for a line.
TEST(Compile, ACubicTrackThatMeetsItsChordIsRefined) {
    AssetBuilder builder;
    const uint32_t joint = builder.node(kNone);
    builder.mesh(joint, builder.skin({joint}));
    builder.track(joint, TrackTarget::kTranslation, {0, 1}, {0, 0, 0, 0, 0, 0, 3, 0, 0, 3, 0, 0, 1, 0, 0, 0, 0, 0},
                  Interpolation::kCubicSpline);
    const Character character = compiled(builder.asset);
    EXPECT_GT(character.clips[0].refined_row_count, 100u);
    EXPECT_LE(clip_errors(builder.asset, character, 0).translation, 1.3e-6 * character.size);
}

TEST(Compile, ConstantTracksAreStoredOnce) {
    AssetBuilder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a);
    builder.mesh(a, builder.skin({a, b}));
    builder.track(a, TrackTarget::kTranslation, {0, 1, 2}, {1, 2, 3, 1, 2, 3, 1, 2, 3});
    builder.track(a, TrackTarget::kScale, {0.5f}, {2, 2, 2});
    // Tangents make it move
    builder.track(b, TrackTarget::kTranslation, {0, 1}, {9, 9, 9, 4, 5, 6, 9, 9, 9, 0, 0, 0, 4, 5, 6, 0, 0, 0},
                  Interpolation::kCubicSpline);
    // These do not
    builder.track(b, TrackTarget::kScale, {0, 1}, {0, 0, 0, 3, 3, 3, 0, 0, 0, 0, 0, 0, 3, 3, 3, 0, 0, 0},
                  Interpolation::kCubicSpline);
    builder.track(b, TrackTarget::kRotation, {0, 2}, {0, 0, 0, 1, 0, 0, 1, 0});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.clips[0].row_stride, 2u);
    EXPECT_EQ(character.keys.size(), 3 * 2 + 3 + 2 * size_t{character.clips[0].row_count})
        << "rest pose, constants, rows";
    const Trs<double> first = sample_reference(character, 0, 0.3)[0], second = sample_reference(character, 0, 1.9)[1];
    EXPECT_EQ(first.translation, (Vec3<double>{1, 2, 3}));
    EXPECT_EQ(first.scale, (Vec3<double>{2, 2, 2}));
    EXPECT_EQ(second.scale, (Vec3<double>{3, 3, 3}));
}

TEST(Compile, PassesSeeClipsAsTheyAreWritten) {
    for (const bool cubic : {false, true}) {
        const Asset asset = make_asset({.joint_count = 40, .cubic = cubic});
        Character character = compiled(asset);
        const std::vector<ExactClip> clips = read_clips(asset, build_rig(asset), character);
        ASSERT_EQ(clips.size(), character.clips.size());
        for (uint32_t clip = 0; clip < clips.size(); ++clip)
            for (int i = -1; i <= 50; ++i) {
                const double time_s = i / 49.0 * character.clips[clip].duration_s;
                EXPECT_EQ(sample_exact(clips[clip], character.rig, time_s), sample_reference(character, clip, time_s));
            }
    }
}

TEST(Compile, AClipThatMovesOnlyUndrawnNodesIsAccepted) {
    AssetBuilder builder;
    const uint32_t joint = builder.node(kNone), camera = builder.node(kNone);
    builder.mesh(joint, builder.skin({joint}));
    builder.track(camera, TrackTarget::kTranslation, {0, 3}, {0, 0, 0, 1, 1, 1});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.rig.joint_count(), 1u);
    EXPECT_EQ(character.clips[0].row_count, 1u);
    EXPECT_EQ(character.clips[0].row_stride, 0u);
    EXPECT_EQ(character.clips[0].duration_s, 3);
    EXPECT_TRUE(reference_pose(character, {.first = {.clip = 0, .time_s = 1.5}}));
}

TEST(Compile, NeighbouringRotationsLieInOneHemisphere) {
    const Asset asset = make_asset({.joint_count = 40, .seed = 7, .clip_count = 2, .key_count = 12});
    const Character character = compiled(asset);
    size_t flipped = 0;
    for (const AssetClip& clip : asset.clips)
        for (const AssetTrack& track : clip.tracks)
            for (size_t k = 4; track.target == TrackTarget::kRotation && k < track.values.size(); k += 4) {
                double d = 0;
                for (size_t c = 0; c < 4; ++c) d += double{track.values[k + c]} * track.values[k - 4 + c];
                flipped += d < 0;
            }
    EXPECT_GT(flipped, 50u) << "the source must have something to mend";
    for (uint32_t clip = 0; clip < 2; ++clip) {
        const Clip& c = character.clips[clip];
        for (uint32_t joint = 0; joint < 40; ++joint) {
            const uint32_t word = character.tracks[clip * 40 + joint].rotation;
            if (!(word & kTrackAnimated)) continue;
            for (uint32_t row = 1; row < c.row_count; ++row) {
                const auto &a = character.keys[(word & kTrackPosition) + (row - 1) * c.row_stride],
                           &b = character.keys[(word & kTrackPosition) + row * c.row_stride];
                EXPECT_GE(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3], 0);
            }
        }
    }
}

// At half a turn the sign of the dot product depends on rounding. The stored keys must turn in the same direction as
// the source.
TEST(Compile, HalfTurnsKeepTheSourcesDirection) {
    Random random(8);
    AssetBuilder builder;
    std::vector<uint32_t> joints;
    for (int i = 0; i < 200; ++i) joints.push_back(builder.node(i == 0 ? kNone : 0));
    builder.mesh(0, builder.skin(joints));
    for (const uint32_t joint : joints) {
        const Quaternion<float> from = random.rotation().as<float>(),
                                to = (from.as<double>() * axis_angle(random.direction(), 3.14159265358979)).as<float>();
        builder.track(joint, TrackTarget::kRotation, {0, 1}, {from.x, from.y, from.z, from.w, to.x, to.y, to.z, to.w});
    }
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.clips[0].row_count, 3u) << "a row in the middle";
    EXPECT_LE(clip_errors(builder.asset, character, 0).rotation_rad, 1e-6);
}

// Many tracks with few keys at different times: merging their times repeats most keys, and drops rows that the others
// reproduce.
TEST(Compile, AFarLargerUnionDropsRowsWithinTheBound) {
    Random random(9);
    AssetBuilder builder;
    std::vector<uint32_t> joints;
    for (int i = 0; i < 150; ++i)
        joints.push_back(builder.node(i == 0 ? kNone : 0, moved(random.unit(), random.unit(), 0)));
    builder.mesh(0, builder.skin(joints));
    for (const uint32_t joint : joints) {
        // A line, given by too many keys at uneven times.
        const Vec3<double> from = random.vector(1), to = random.vector(1);
        std::vector<float> times_s, values;
        for (int k = 0; k < 5; ++k) {
            const float time_s = k == 0 ? 0 : k == 4 ? 10 : static_cast<float>(2.5 * k + random.between(-1, 1));
            const Vec3<double> v = lerp(from, to, time_s / 10.0);
            times_s.push_back(time_s);
            for (const double x : {v.x, v.y, v.z}) values.push_back(static_cast<float>(x));
        }
        builder.track(joint, TrackTarget::kTranslation, times_s, values);
    }
    // One with a corner
    builder.track(7, TrackTarget::kRotation, {0, 4, 5, 10}, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0});
    // Some that spin by half turns, so fast that every row between two keys could be dropped
    for (uint32_t wheel = 80; wheel < 140; ++wheel) {
        const Quaternion<double> start = random.rotation();
        const Vec3<double> axis = random.direction();
        std::vector<float> times_s, values;
        for (int k = 0; k < 8; ++k) {
            const Quaternion<float> q = (start * axis_angle(axis, 3.14159265358979 * k)).as<float>();
            times_s.push_back(static_cast<float>(0.3 * k));
            values.insert(values.end(), {q.x, q.y, q.z, q.w});
        }
        builder.track(wheel, TrackTarget::kRotation, times_s, values);
    }
    const Character character = compiled(builder.asset);
    const Clip& clip = character.clips[0];
    const TrackErrors errors = clip_errors(builder.asset, character, 0);
    std::printf("  %zu keys of 211 tracks; union of %u rows, %u dropped; largest error %.1e of the size, %.1e rad\n",
                size_t{clip.source_key_count}, clip.row_count + clip.dropped_row_count, clip.dropped_row_count,
                errors.translation / character.size, errors.rotation_rad);
    EXPECT_GT(clip.row_count + clip.dropped_row_count, 440u);
    EXPECT_LT(clip.row_count, 100u);
    EXPECT_GE(clip.row_count, 15u);
    EXPECT_LE(errors.translation, 1.5e-6 * character.size);
    EXPECT_LE(errors.rotation_rad, 1.5e-6);
}

}  // namespace
}  // namespace throng
