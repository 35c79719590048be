// What compilation keeps exactly, and what it may leave out. Tracks are evaluated here once more, from glTF's words
// alone.
#include <throng/controller.h>
#include <throng/procedural.h>

#include "compile/clip/read_clips.h"
#include "compile/rig/rig.h"
#include "control/control_reference.h"
#include "sample/sample_reference.h"
#include "tests/test_rig.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

namespace throng {
namespace {

using namespace test;

Error refusal_of(const Asset& asset) {
    const Result<Character> character = compile_character(asset, kExact);
    if (!character) return character.error();
    ADD_FAILURE() << "nothing was refused";
    return {};
}

// ---- glTF 2.0, appendix C, without a look at src/compile

using Value = std::array<double, 4>;

Value unit(Value v) {
    const double l = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
    for (double& x : v) x /= l;
    return v;
}

Value track_value(const AssetTrack& track, double time_s) {
    const size_t components = track.target == TrackTarget::kRotation ? 4 : 3;
    const bool cubic = track.interpolation == Interpolation::kCubicSpline, rotation = components == 4;
    const auto element = [&](size_t key, size_t part) {  // part: 0 in-tangent, 1 value, 2 out-tangent
        Value v{};
        for (size_t c = 0; c < components; ++c) v[c] = track.values[(cubic ? key * 3 + part : key) * components + c];
        return v;
    };
    const auto finished = [&](const Value& v) { return rotation ? unit(v) : v; };
    const auto& times = track.times_s;
    if (time_s <= times.front()) return finished(element(0, 1));
    if (time_s >= times.back()) return finished(element(times.size() - 1, 1));
    size_t k = 0;
    while (times[k + 1] <= time_s) ++k;
    const double td = double{times[k + 1]} - times[k], t = (time_s - times[k]) / td;
    Value a = element(k, 1), b = element(k + 1, 1), out{};
    switch (track.interpolation) {
        case Interpolation::kStep: return finished(a);
        case Interpolation::kLinear: {
            double from = 1 - t, to = t;
            if (rotation) {
                a = unit(a);
                b = unit(b);
                double d = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
                const double sign = d < 0 ? -1 : 1;
                const double angle = std::acos(std::min(1.0, d * sign));
                if (angle > 1e-6) {
                    from = std::sin((1 - t) * angle) / std::sin(angle);
                    to = std::sin(t * angle) / std::sin(angle);
                }
                to *= sign;
            }
            for (size_t c = 0; c < 4; ++c) out[c] = from * a[c] + to * b[c];
            return finished(out);
        }
        case Interpolation::kCubicSpline: {
            const Value out_tangent = element(k, 2), in_tangent = element(k + 1, 0);
            for (size_t c = 0; c < 4; ++c)
                out[c] = (2 * t * t * t - 3 * t * t + 1) * a[c] + td * (t * t * t - 2 * t * t + t) * out_tangent[c] +
                         (-2 * t * t * t + 3 * t * t) * b[c] + td * (t * t * t - t * t) * in_tangent[c];
            return finished(out);
        }
    }
    return out;
}

Trs<double> node_trs(const Asset& asset, uint32_t node, const AssetClip* clip, double time_s) {
    Trs<double> trs = asset.nodes[node].parent_from_node;
    if (!clip) return trs;
    for (const AssetTrack& track : clip->tracks) {
        if (track.node != node) continue;
        const Value v = track_value(track, time_s);
        if (track.target == TrackTarget::kRotation)
            trs.rotation = {v[0], v[1], v[2], v[3]};
        else
            (track.target == TrackTarget::kTranslation ? trs.translation : trs.scale) = {v[0], v[1], v[2]};
    }
    return trs;
}

// model_from_node of every node, nothing folded.
std::vector<AffineT<double>> node_models(const Asset& asset, const AssetClip* clip, double time_s) {
    std::vector<AffineT<double>> models(asset.nodes.size());
    for (uint32_t node = 0; node < asset.nodes.size(); ++node)
        for (uint32_t up = node; up != kNone; up = asset.nodes[up].parent)
            models[node] = to_affine(node_trs(asset, up, clip, time_s)) * models[node];
    return models;
}

// ---- Small assets

struct Builder {
    Asset asset{.name = "built"};

    uint32_t node(uint32_t parent, const Trs<double>& trs = {}) {
        asset.nodes.push_back(
            {.name = "node " + std::to_string(asset.nodes.size()), .parent = parent, .parent_from_node = trs});
        return static_cast<uint32_t>(asset.nodes.size() - 1);
    }
    uint32_t skin(const std::vector<uint32_t>& joints) {
        asset.skins.push_back({.name = "skin", .joints = joints, .inverse_binds = std::vector<Affine>(joints.size())});
        return static_cast<uint32_t>(asset.skins.size() - 1);
    }
    // One triangle; skinned vertices follow joint 0, 1, 2 of the skin, modulo its size.
    uint32_t mesh(uint32_t node, uint32_t skin_index = kNone, uint32_t influence_count = 4) {
        AssetPrimitive primitive{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}};
        if (skin_index != kNone) {
            primitive.influence_count = influence_count;
            for (uint32_t v = 0; v < 3; ++v)
                for (uint32_t i = 0; i < influence_count; ++i) {
                    primitive.influence_joints.push_back(
                        static_cast<uint16_t>((v + i) % asset.skins[skin_index].joints.size()));
                    primitive.influence_weights.push_back(i == 0 ? 1.0f : 0.0f);
                }
        }
        asset.meshes.push_back({.name = "mesh", .primitives = {primitive}});
        asset.mesh_instances.push_back(
            {.node = node, .mesh = static_cast<uint32_t>(asset.meshes.size() - 1), .skin = skin_index});
        return static_cast<uint32_t>(asset.meshes.size() - 1);
    }
    AssetTrack& track(uint32_t node_index, TrackTarget target, const std::vector<float>& times_s,
                      const std::vector<float>& values, Interpolation interpolation = Interpolation::kLinear) {
        if (asset.clips.empty()) asset.clips.push_back({.name = "clip"});
        AssetClip& clip = asset.clips.back();
        clip.tracks.push_back({.node = node_index,
                               .target = target,
                               .interpolation = interpolation,
                               .times_s = times_s,
                               .values = values});
        clip.duration_s = std::max(clip.duration_s, double{times_s.back()});
        return clip.tracks.back();
    }
};

Trs<double> moved(double x, double y, double z) {
    Trs<double> trs;
    trs.translation = {x, y, z};
    return trs;
}

Trs<double> similarity(Random& random) {
    Trs<double> trs = random.trs(0.3, 0);
    const double scale = random.between(0.8, 1.25);
    trs.scale = {scale, scale, scale};
    return trs;
}

// ---- Clips

struct TrackErrors {
    double rotation_rad = 0, translation = 0, scale = 0;
};

// The compiled clip against the source at times on, beside and between the keys. `asset` must fold nothing.
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
    for (const double time_s : times_s) {
        const std::vector<Trs<double>> pose = sample_reference(character, clip, time_s);
        for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
            const Trs<double> wanted = node_trs(asset, character.rig.nodes[joint], &asset.clips[clip], time_s);
            const auto &q = pose[joint].rotation, w = normalized(wanted.rotation);
            const double chord = std::min(dot(Quaternion<double>{q.x - w.x, q.y - w.y, q.z - w.z, q.w - w.w},
                                              {q.x - w.x, q.y - w.y, q.z - w.z, q.w - w.w}),
                                          dot(Quaternion<double>{q.x + w.x, q.y + w.y, q.z + w.z, q.w + w.w},
                                              {q.x + w.x, q.y + w.y, q.z + w.z, q.w + w.w}));
            errors.rotation_rad = std::max(errors.rotation_rad, 2 * std::sqrt(chord));
            errors.translation = std::max(errors.translation, length(pose[joint].translation - wanted.translation));
            errors.scale = std::max(errors.scale, length(pose[joint].scale - wanted.scale));
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

TEST(Compile, WhatHasNoSuchNameIsAnErrorThatSaysWhatThereIs) {
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
    const ProceduralRules rules{.targets = {"eye"}, .rules = {}};
    EXPECT_EQ(rules.target_named("eye").value(), 0u);
    EXPECT_EQ(rules.target_named("Eye").error().text(),
              "procedural rules: there is no target 'Eye'; did you mean 'eye'? There is: eye");
}

TEST(Compile, CubicClipsAreRefinedToTheBound) {
    TrackErrors worst;
    uint32_t rows = 0;
    for (const uint64_t seed : {4u, 5u, 6u}) {
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
    std::printf("  6 cubic clips, %u rows added: largest error %.1e rad, %.1e of the size, factor %.1e\n", rows,
                worst.rotation_rad, worst.translation, worst.scale);
}

// A symmetric curve meets its chord in the middle: looking there alone would take it for a line.
TEST(Compile, ACubicTrackThatMeetsItsChordIsRefined) {
    Builder builder;
    const uint32_t joint = builder.node(kNone);
    builder.mesh(joint, builder.skin({joint}));
    builder.track(joint, TrackTarget::kTranslation, {0, 1}, {0, 0, 0, 0, 0, 0, 3, 0, 0, 3, 0, 0, 1, 0, 0, 0, 0, 0},
                  Interpolation::kCubicSpline);
    const Character character = compiled(builder.asset);
    EXPECT_GT(character.clips[0].refined_row_count, 100u);
    EXPECT_LE(clip_errors(builder.asset, character, 0).translation, 1.3e-6 * character.size);
}

TEST(Compile, WhatDoesNotChangeIsStoredOnce) {
    Builder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a);
    builder.mesh(a, builder.skin({a, b}));
    builder.track(a, TrackTarget::kTranslation, {0, 1, 2}, {1, 2, 3, 1, 2, 3, 1, 2, 3});
    builder.track(a, TrackTarget::kScale, {0.5f}, {2, 2, 2});
    // Tangents move it
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

TEST(Compile, AClipMayMoveNothingThatShows) {
    Builder builder;
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

// Half a turn lies on the border of the hemispheres, where rounding decides: what is stored must mean what the source
// means.
TEST(Compile, HalfATurnGoesTheSourcesWay) {
    Random random(8);
    Builder builder;
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

// Many tracks of few keys at times of their own: the union repeats most keys, and drops what the others reproduce.
TEST(Compile, AFarLargerUnionDropsRowsWithinTheBound) {
    Random random(9);
    Builder builder;
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
    // And one with a corner
    builder.track(7, TrackTarget::kRotation, {0, 4, 5, 10}, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0});
    // And some that spin by half turns, fast enough that every row between two keys could go
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

// ---- The rig

// Random trees in which some nodes are skinned, some animated, and the rest only stand between.
TEST(Compile, FoldingStaticNodesChangesNothing) {
    size_t folded = 0, kept_static = 0;
    double worst = 0;
    for (uint64_t seed = 10; seed < 20; ++seed) {
        Random random(seed);
        Builder builder;
        std::vector<uint32_t> skinned, animated;
        for (uint32_t i = 0; i < 80; ++i) {
            const uint32_t parent = i == 0 || random.chance(0.05) ? kNone : i - 1 - random.below(std::min(i, 5u));
            Trs<double> trs = i % 7 == 3            ? Trs<double>{}
                              : random.chance(0.15) ? random.trs(0.3, 0.2)
                                                    : similarity(random);
            if (random.chance(0.05)) trs.scale = trs.scale * -1.0;
            builder.node(parent, trs);
            if (random.chance(0.2))
                skinned.push_back(i);
            else if (random.chance(0.2))
                animated.push_back(i);
        }
        if (skinned.empty()) skinned.push_back(79);
        builder.mesh(0, builder.skin(skinned));
        builder.mesh(60);
        for (const uint32_t node : animated) {
            const Quaternion<double> a = random.rotation(), b = random.rotation();
            const auto f = [](double x) { return static_cast<float>(x); };
            builder.track(node, TrackTarget::kRotation, {0, 1},
                          {f(a.x), f(a.y), f(a.z), f(a.w), f(b.x), f(b.y), f(b.z), f(b.w)});
            builder.track(node, TrackTarget::kTranslation, {0, 0.4f, 1}, {0, 0, 0, 0.2f, 0.1f, 0, 0.1f, 0.3f, 0.2f});
            builder.track(node, TrackTarget::kScale, {0, 1}, {1, 1, 1, 1.2f, 0.9f, 1.1f}, Interpolation::kStep);
        }
        const Character character = compiled(builder.asset);
        folded += build_rig(builder.asset).folded_node_count;
        for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
            const uint32_t node = character.rig.nodes[joint], parent = character.rig.parents[joint];
            EXPECT_TRUE(parent == kNone || parent < joint);
            EXPECT_EQ(character.rig.names[joint], builder.asset.nodes[node].name);
            kept_static += std::count(skinned.begin(), skinned.end(), node) == 0 &&
                           std::count(animated.begin(), animated.end(), node) == 0;
        }
        for (const double time_s : {0.0, 0.25, 0.4, 0.77, 1.0}) {
            const AssetClip* clip = builder.asset.clips.empty() ? nullptr : &builder.asset.clips[0];
            const std::vector<AffineT<double>> models = node_models(builder.asset, clip, time_s);
            const ReferencePose pose = *reference_pose(
                character, {.first = {.clip = clip ? 0 : kNone, .time_s = time_s, .loop = false}});
            for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
                const double error = matrix_error(pose.model_from_joint[joint].as<float>(),
                                                  models[character.rig.nodes[joint]], 1);
                EXPECT_LE(error, 3e-6) << "seed " << seed << ", node " << character.rig.nodes[joint] << " at "
                                       << time_s;
                worst = std::max(worst, error);
            }
            // The rigid mesh too, wherever it hangs.
            const MeshSection& rigid = character.sections[1];
            const uint32_t entry = character.influences[rigid.first_influences].entries[0];
            EXPECT_LE(matrix_error(pose.model_from_bind[entry].as<float>(), models[60], 1), 3e-6) << "seed " << seed;
        }
    }
    EXPECT_GT(folded, 50u);
    EXPECT_GT(kept_static, 10u) << "static, but scaled unevenly";
    std::printf("  10 trees of 80 nodes: %zu nodes folded, %zu kept for their scale; largest error %.1e\n", folded,
                kept_static, worst);
}

TEST(Compile, AnUnevenlyScaledNodeIsKept) {
    for (const Vec3<double>& scale :
         {Vec3<double>{2, 1, 1}, Vec3<double>{1, 2, 1}, Vec3<double>{1, 1, 2}, Vec3<double>{1, 1, 1}}) {
        Builder builder;
        Trs<double> middle;
        middle.scale = scale;
        const uint32_t root = builder.node(kNone), joint = builder.node(builder.node(root, middle));
        builder.mesh(root, builder.skin({joint}));
        EXPECT_EQ(compiled(builder.asset).rig.joint_count(), scale.x == scale.y && scale.y == scale.z ? 1u : 2u);
    }
    Builder builder;
    Trs<double> even = moved(1, 0, 0), uneven = moved(0, 1, 0);
    even.scale = {2, 2, 2};
    uneven.scale = {1, 2, 1};
    const uint32_t root = builder.node(kNone, even), middle = builder.node(root, uneven),
                   joint = builder.node(middle, moved(0, 0, 1));
    builder.mesh(root, builder.skin({joint}));
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.rig.joint_count(), 2u);
    EXPECT_EQ(character.rig.nodes, (std::vector<uint32_t>{middle, joint}));
    EXPECT_EQ(character.rig.rest[0].scale, (Vec3<float>{2, 4, 2}));
    EXPECT_EQ(character.rig.rest[0].translation, (Vec3<float>{1, 2, 0}));
}

TEST(Compile, TheRigIsMeasured) {
    Builder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a), c = builder.node(b), d = builder.node(a),
                   e = builder.node(kNone);
    builder.mesh(a, builder.skin({e, d, c, b, a}));
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.rig.nodes, (std::vector<uint32_t>{a, b, c, d, e})) << "depth first";
    EXPECT_EQ(character.rig.parents, (std::vector<uint32_t>{kNone, 0, 1, 0, kNone}));
    EXPECT_EQ(character.rig.level_count, 3u);
    EXPECT_EQ(character.rig.leaf_count, 3u);
    EXPECT_DOUBLE_EQ(character.rig.mean_depth, (1 + 2 + 3 + 2 + 1) / 5.0);
    std::vector<uint32_t> joints;
    for (const PaletteEntry& entry : character.palette) joints.push_back(entry.joint);
    EXPECT_EQ(joints, (std::vector<uint32_t>{4, 3, 2, 1, 0})) << "the palette keeps the file's order";
}

// More joints than a workgroup has invocations, and parents that come after their children in the file.
TEST(Compile, LargeRigsInAnyOrder) {
    constexpr uint32_t kCount = 3000;
    Builder builder;
    std::vector<uint32_t> joints;
    for (uint32_t i = 0; i < kCount; ++i)
        joints.push_back(
            builder.node(i + 1 == kCount ? kNone : i + 1 + (i % 2 == 0 && i + 2 < kCount ? 1 : 0), moved(0.001, 0, 0)));
    builder.mesh(0, builder.skin(joints));
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.rig.joint_count(), kCount);
    EXPECT_EQ(character.rig.nodes[0], kCount - 1);
    for (uint32_t joint = 1; joint < kCount; ++joint) {
        ASSERT_LT(character.rig.parents[joint], joint);
        ASSERT_EQ(character.rig.nodes[character.rig.parents[joint]],
                  builder.asset.nodes[character.rig.nodes[joint]].parent);
    }
}

TEST(Compile, LimitsAreNamed) {
    Builder builder;
    std::vector<uint32_t> joints;
    for (uint32_t i = 0; i < 65'536; ++i) joints.push_back(builder.node(i == 0 ? kNone : 0));
    builder.mesh(0, builder.skin(joints));
    const Error error = refusal_of(builder.asset);
    EXPECT_EQ(error.code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(error.text(), "65535") && contains(error.text(), "built")) << error.text();
    joints.pop_back();
    builder.asset.skins[0] = {.name = "skin", .joints = joints, .inverse_binds = std::vector<Affine>(joints.size())};
    EXPECT_EQ(compiled(builder.asset).rig.joint_count(), 65'535u);
    // Two skins of as many joints, not equal: more palette entries than 16 bits hold.
    builder.skin(joints);
    builder.asset.skins[1].inverse_binds[5].row[0][3] = 1;
    const Error palette = refusal_of(builder.asset);
    EXPECT_EQ(palette.code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(palette.text(), "65536")) << palette.text();
}

TEST(Compile, AnAssetWithNothingToDrawIsRefused) {
    Builder builder;
    builder.node(kNone);
    const Error error = refusal_of(builder.asset);
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_TRUE(contains(error.text(), "no skin and no mesh: there is nothing to draw")) << error.text();
    EXPECT_FALSE(contains(error.text(), "animation")) << error.text();
    builder.asset.clips.emplace_back();
    EXPECT_TRUE(contains(refusal_of(builder.asset).text(), "only animation"));
    EXPECT_EQ(refusal_of({}).code, ErrorCode::kUnsupported);
}

TEST(Compile, ASkinWithoutAMeshIsEnough) {
    Builder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a, moved(0, 3, 4));
    builder.skin({a, b});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.palette.size(), 2u);
    EXPECT_TRUE(character.vertices.empty());
    EXPECT_FLOAT_EQ(character.size, 5) << "of the joints, where there is no mesh";
}

// ---- Meshes and skins

TEST(Compile, EqualSkinsShareTheirPalette) {
    Builder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a), c = builder.node(a);
    builder.skin({a, b});
    builder.skin({b, c});
    builder.skin({a, b});
    builder.skin({a, b});
    builder.asset.skins[3].inverse_binds[1].row[1][3] = 2;
    for (uint32_t skin = 0; skin < 4; ++skin) builder.mesh(a, skin);
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.palette.size(), 6u) << "two each of three different skins";
    ASSERT_EQ(character.skins.size(), 4u);
    EXPECT_EQ(character.skins[2].first_entry, character.skins[0].first_entry);
    EXPECT_NE(character.skins[3].first_entry, character.skins[0].first_entry);
    for (uint32_t s = 0; s < 4; ++s) {
        EXPECT_EQ(character.skins[s].joint_count, 2u);
        const MeshSection& section = character.sections[s];
        EXPECT_EQ(section.skin, s);
        for (uint32_t v = 0; v < 3; ++v) {
            const uint32_t entry = character.influences[section.first_influences + v].entries[0];
            const uint32_t node = character.rig.nodes[character.palette[entry].joint];
            EXPECT_EQ(node, builder.asset.skins[s].joints[v % 2]);
        }
    }
}

TEST(Compile, ARigidMeshFollowsItsNode) {
    Builder builder;
    const uint32_t joint = builder.node(kNone, moved(1, 0, 0));
    const uint32_t hand = builder.node(joint, moved(0, 2, 0)), sword = builder.node(hand, moved(0, 0, 3));
    builder.skin({joint});
    builder.mesh(sword);
    builder.track(joint, TrackTarget::kTranslation, {0, 1}, {1, 0, 0, 5, 0, 0});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.rig.joint_count(), 1u) << "hand and sword stand still";
    ASSERT_EQ(character.palette.size(), 2u);
    EXPECT_EQ(character.sections[0].skin, kNone);
    EXPECT_EQ(character.sections[0].node, sword);
    const ReferencePose pose = *reference_pose(character, {.first = {.clip = 0, .time_s = 1, .loop = false}});
    EXPECT_EQ(reference_positions(character, pose)[1], (Vec3<double>{5 + 1, 2, 3}));
    EXPECT_EQ(character.bounds_min, (Vec3<float>{1, 2, 3}));
    EXPECT_EQ(character.bounds_max, (Vec3<float>{2, 3, 3}));
}

TEST(Compile, AnAnimatedNodeThatCarriesAMeshIsAJoint) {
    Builder builder;
    const uint32_t wheel = builder.node(builder.node(kNone, moved(0, 0, 5)));
    builder.mesh(wheel);
    builder.track(wheel, TrackTarget::kRotation, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.rig.nodes, (std::vector<uint32_t>{wheel}));
    const ReferencePose pose = *reference_pose(character, {.first = {.clip = 0, .time_s = 0.5}});
    const Vec3<double> corner = reference_positions(character, pose)[1];
    EXPECT_LE(length(corner - Vec3<double>{0, 1, 5}), 1e-6) << "a quarter turn about z";
}

TEST(Compile, AMirroringNodeTurnsTheWindingRound) {
    Builder builder;
    Trs<double> mirror;
    mirror.scale = {-1, 1, 1};
    builder.mesh(builder.node(kNone, mirror));
    builder.mesh(builder.node(kNone));
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.indices, (std::vector<uint32_t>{0, 2, 1, 0, 1, 2}));
}

TEST(Compile, WeightsAreBroughtToOne) {
    Builder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a), c = builder.node(a);
    builder.mesh(a, builder.skin({a, b, c}), 8);
    AssetPrimitive& primitive = builder.asset.meshes[0].primitives[0];
    primitive.influence_weights = {1, 2, 1, 0, 0, 3, 0, 1, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.sections[0].influence_sets, 2u);
    ASSERT_EQ(character.influences.size(), 6u);
    EXPECT_EQ(character.influences[0].weights, (std::array<float, 4>{0.125f, 0.25f, 0.125f, 0}));
    EXPECT_EQ(character.influences[1].weights, (std::array<float, 4>{0, 0.375f, 0, 0.125f}));
    EXPECT_EQ(character.influences[1].entries, (std::array<uint16_t, 4>{1, 2, 0, 1}));
    EXPECT_EQ(character.influences[2].weights, (std::array<float, 4>{1, 0, 0, 0}));
    EXPECT_EQ(character.influences[4].weights, (std::array<float, 4>{1, 0, 0, 0}))
        << "without a weight: the first joint";
    EXPECT_EQ(character.influences[4].entries[0], 2u);
    ASSERT_EQ(character.warnings.size(), 1u);
    EXPECT_EQ(character.warnings[0],
              "built: meshes[0].primitives[0]: 1 of 3 skinned vertices, the first of them here, have no weight: "
              "they follow their first joint (JOINTS_0)");
}

TEST(Compile, ManyVerticesWithoutWeightAreOneWarning) {
    Builder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a);
    const uint32_t skin = builder.skin({a, b});
    for (int i = 0; i < 5; ++i) builder.mesh(a, skin);
    for (size_t i = 1; i < 5; ++i) {
        AssetPrimitive& primitive = builder.asset.meshes[i].primitives[0];
        primitive.influence_weights.assign(12, 0.0f);
        primitive.influence_joints[0] = 7;  // of a larger skin
    }
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.warnings.size(), 1u);
    const std::string& warning = character.warnings[0];
    EXPECT_TRUE(contains(warning, "meshes[1].primitives[0]: 12 of 15 skinned vertices")) << warning;
    EXPECT_EQ(character.influences[3].entries[0], character.skins[0].first_entry) << "the skin's first joint";
    EXPECT_EQ(character.influences[4].entries[0], character.skins[0].first_entry + 1);
}

// A mesh's skinned and its unskinned primitive, in one mesh with a skin.
TEST(Compile, PrimitivesWithoutJointsFollowTheirNode) {
    Builder builder;
    const uint32_t root = builder.node(kNone, moved(0, 0, 2)), joint = builder.node(root, moved(3, 0, 0));
    builder.mesh(root, builder.skin({joint}));
    builder.asset.meshes[0].primitives.push_back(
        {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.sections.size(), 2u);
    EXPECT_EQ(character.sections[0].skin, 0u);
    EXPECT_EQ(character.sections[1].skin, kNone);
    EXPECT_EQ(character.sections[1].first_vertex, 3u);
    const std::vector<Vec3<double>> positions = reference_positions(character, *reference_pose(character, {}));
    EXPECT_EQ(positions[0], (Vec3<double>{3, 0, 2}));
    EXPECT_EQ(positions[3], (Vec3<double>{0, 0, 2}));
}

TEST(Compile, ARestPoseThatIsNotFiniteIsRefused) {
    Builder builder;
    builder.mesh(builder.node(kNone, moved(1e300, 0, 0)));
    EXPECT_EQ(refusal_of(builder.asset).code, ErrorCode::kInvalidFile);
}

}  // namespace
}  // namespace throng
