// add_clips(): clips of another file, transferred to a rig with the same joint names.
#include "tests/host/compile_cases.h"
#include "tests/test_rig.h"
#include "tests/text.h"

#include <throng/character.h>
#include <throng/reference.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace throng {
namespace {

using namespace test;

Asset without_clips(Asset asset) {
    asset.clips.clear();
    return asset;
}

// Only nodes, in reverse order, and clips, as exporters write them to a file beside the character.
Asset animation_of(const Asset& asset) {
    const auto count = static_cast<uint32_t>(asset.nodes.size());
    const auto moved = [&](uint32_t node) { return node == kNone ? kNone : count - 1 - node; };
    Asset out{.name = "moves.glb", .nodes = {asset.nodes.rbegin(), asset.nodes.rend()}, .clips = asset.clips};
    for (AssetNode& node : out.nodes) node.parent = moved(node.parent);
    for (AssetClip& clip : out.clips)
        for (AssetTrack& track : clip.tracks) track.node = moved(track.node);
    return out;
}

// For each joint, its name and its position in clip `clip` at `time_s`.
std::vector<std::pair<std::string, Vec3<double>>> places(const Asset& asset, uint32_t clip, float time_s) {
    const Character character = compile_character(asset, {.error = 0}).expect();
    const ReferencePose pose =
        reference_pose(character, {.first = {.clip = clip, .time_s = time_s, .loop = false}}).expect();
    std::vector<std::pair<std::string, Vec3<double>>> out;
    for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
        const AffineT<double>& m = pose.model_from_joint[joint];
        out.emplace_back(character.rig.names[joint], Vec3<double>{m.row[0][3], m.row[1][3], m.row[2][3]});
    }
    std::ranges::sort(out, {}, &std::pair<std::string, Vec3<double>>::first);
    return out;
}

// Each joint of `got` must be where the joint of the same name in `wanted` is, times `scale`.
void expect_same_places(const Asset& got, const Asset& wanted, double scale = 1, double bound = 1e-5) {
    ASSERT_EQ(got.clips.size(), wanted.clips.size());
    for (uint32_t clip = 0; clip < wanted.clips.size(); ++clip)
        for (const float time_s : {0.0f, 0.3f, 0.71f}) {
            const auto found = places(got, clip, time_s), expected = places(wanted, clip, time_s);
            size_t compared = 0;
            for (const auto& [name, place] : expected) {
                const auto same = std::ranges::find(found, name, &std::pair<std::string, Vec3<double>>::first);
                if (same == found.end()) continue;
                ++compared;
                EXPECT_LT(length(same->second - place * scale), bound * scale)
                    << name << " in " << wanted.clips[clip].name << " after " << time_s << " s";
            }
            EXPECT_GE(compared, 40u);
        }
}

void expect_refused(Asset asset, const Asset& from, const char* message) {
    const size_t clip_count = asset.clips.size();
    const Result<void> added = add_clips(asset, from);
    ASSERT_FALSE(added) << message;
    EXPECT_EQ(added.error().code, ErrorCode::kInvalidArgument);
    EXPECT_TRUE(contains(added.error().text(), message)) << added.error().text();
    EXPECT_EQ(asset.clips.size(), clip_count);
    EXPECT_TRUE(asset.warnings.empty());
}

TEST(AddClips, EqualTheCharactersOwnOnItsOwnRig) {
    const Asset whole = walker_asset();
    Asset asset = without_clips(whole);
    const Result<void> added = add_clips(asset, animation_of(whole));
    ASSERT_TRUE(added) << added.error().text();
    EXPECT_TRUE(asset.warnings.empty());
    ASSERT_EQ(asset.clips.size(), whole.clips.size());
    for (size_t i = 0; i < whole.clips.size(); ++i) {
        const AssetClip &clip = asset.clips[i], &wanted = whole.clips[i];
        EXPECT_EQ(clip.name, wanted.name);
        EXPECT_EQ(clip.duration_s, wanted.duration_s);
        ASSERT_EQ(clip.tracks.size(), wanted.tracks.size());
        for (size_t t = 0; t < wanted.tracks.size(); ++t) {
            EXPECT_EQ(clip.tracks[t].node, wanted.tracks[t].node);
            EXPECT_EQ(clip.tracks[t].target, wanted.tracks[t].target);
            EXPECT_EQ(clip.tracks[t].times_s, wanted.tracks[t].times_s);
            EXPECT_EQ(clip.tracks[t].values, wanted.tracks[t].values) << "bit for bit";
        }
    }
}

TEST(AddClips, MatchNamesThatExportersChange) {
    const Asset whole = walker_asset();
    struct Case {
        const char* what;
        std::string (*changed)(const std::string&);
    };
    const Case cases[]{
        {"a namespace and punctuation", [](const std::string& name) { return "mixamorig:" + name + "_"; }},
        {"a prefix, as three.js writes a namespace", [](const std::string& name) { return "mixamorig" + name; }},
        {"Sketchfab's numbers", [](const std::string& name) { return "mixamorig:" + name + "_07"; }},
        {"capitals", [](const std::string& name) {
             return static_cast<char>(std::toupper(static_cast<unsigned char>(name[0]))) + name.substr(1);
         }}};
    for (const Case& c : cases) {
        Asset from = animation_of(whole), asset = without_clips(whole);
        for (AssetNode& node : from.nodes) node.name = c.changed(node.name);
        const Result<void> added = add_clips(asset, from);
        ASSERT_TRUE(added) << c.what << ": " << added.error().text();
        EXPECT_TRUE(asset.warnings.empty()) << c.what << ": " << asset.warnings[0];
        expect_same_places(asset, whole, 1, 1e-12);
    }
    // An exact match of the name has priority over a similar name, whichever comes first.
    Asset from = animation_of(whole), asset = without_clips(whole);
    const std::string name = asset.nodes[1].name;
    asset.nodes.push_back({.name = name});
    asset.nodes[1].name = "_" + name;
    ASSERT_TRUE(add_clips(asset, from));
    const auto moves = [&](uint32_t node) {
        return std::ranges::any_of(asset.clips[0].tracks, [&](const AssetTrack& t) { return t.node == node; });
    };
    EXPECT_FALSE(moves(1));
    EXPECT_TRUE(moves(static_cast<uint32_t>(asset.nodes.size() - 1)));
}

// Files with only animation have as rest pose whatever the exporter showed on screen.
TEST(AddClips, IgnoreTheOtherRestPoseIfBonesHaveEqualLength) {
    const Asset whole = walker_asset();
    Asset from = animation_of(whole), asset = without_clips(whole);
    Random random(5);
    for (AssetNode& node : from.nodes) node.parent_from_node.rotation = random.rotation();
    for (const AssetTrack& track : from.clips[0].tracks)
        if (track.target == TrackTarget::kTranslation)
            from.nodes[track.node].parent_from_node.translation = {track.values[0], track.values[1] / 2,
                                                                   track.values[2]};
    ASSERT_TRUE(add_clips(asset, from));
    expect_same_places(asset, whole, 1, 1e-12);
}

// As with characters that were modelled in another unit, or are larger.
TEST(AddClips, BonesKeepTheirOwnLength) {
    const Asset whole = walker_asset();
    Asset asset = without_clips(whole);
    const auto enlarge = [](Asset& of, double scale) {
        for (AssetNode& node : of.nodes) node.parent_from_node.translation = node.parent_from_node.translation * scale;
        for (AssetSkin& skin : of.skins)
            for (Affine& bind : skin.inverse_binds)
                for (auto& row : bind.row) row[3] *= static_cast<float>(scale);
    };
    enlarge(asset, 3);
    ASSERT_TRUE(add_clips(asset, animation_of(whole)));
    expect_same_places(asset, whole, 3);

    // A bone that moves, with cubic spline keys.
    Asset from = animation_of(whole);
    asset = without_clips(whole);
    enlarge(asset, 0.5);
    const uint32_t node = whole.clips[0].tracks.back().node;
    const auto name = [&](const AssetNode& of) { return of.name == whole.nodes[node].name; };
    const auto from_node = static_cast<uint32_t>(std::ranges::find_if(from.nodes, name) - from.nodes.begin());
    const Vec3<double> rest = from.nodes[from_node].parent_from_node.translation;
    const auto x = static_cast<float>(rest.x), y = static_cast<float>(rest.y), z = static_cast<float>(rest.z);
    std::erase_if(from.clips[0].tracks, [&](const AssetTrack& track) {
        return track.node == from_node && track.target == TrackTarget::kTranslation;
    });
    from.clips[0].tracks.push_back({.node = from_node,
                                    .target = TrackTarget::kTranslation,
                                    .interpolation = Interpolation::kCubicSpline,
                                    .times_s = {0, 1},
                                    .values = {0, 0, 0, x, y, z, 0, 4, 0, 8, 0, 0, x, y + 2, z, 0, 0, 0}});
    ASSERT_TRUE(add_clips(asset, from));
    const AssetTrack& track = asset.clips[0].tracks.back();
    const std::vector<float> wanted{0, 0, 0, x / 2, y / 2, z / 2, 0, 2, 0, 4, 0, 0, x / 2, y / 2 + 1, z / 2, 0, 0, 0};
    ASSERT_EQ(track.values.size(), wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(track.values[i], wanted[i], 1e-6) << i;
}

// "Armature" nodes, which many exporters turn and scale and give constant keys.
TEST(AddClips, ArmatureNodesAreNotTransferred) {
    const Asset whole = walker_asset();
    const auto held = [](Asset asset, const Trs<double>& model_from_holder) {
        const auto holder = static_cast<uint32_t>(asset.nodes.size());
        for (AssetNode& node : asset.nodes)
            if (node.parent == kNone) node.parent = holder;
        asset.nodes.push_back({.name = "Armature", .parent_from_node = model_from_holder});
        for (AssetClip& clip : asset.clips)
            clip.tracks.push_back({.node = holder,
                                   .target = TrackTarget::kScale,
                                   .times_s = {0},
                                   .values = {static_cast<float>(model_from_holder.scale.x),
                                              static_cast<float>(model_from_holder.scale.y),
                                              static_cast<float>(model_from_holder.scale.z)}});
        return asset;
    };
    const Trs<double> turned{.rotation = axis_angle<double>({1, 0, 0}, -1.5707963267948966),
                             .scale = {0.01, 0.01, 0.01}};
    // Written for a rig whose joints are turned and scaled, so that its overall size and orientation match the other's.
    Asset asset = without_clips(whole);
    const Quaternion<double> back{-turned.rotation.x, -turned.rotation.y, -turned.rotation.z, turned.rotation.w};
    for (uint32_t i = 0; i < asset.nodes.size(); ++i) {
        auto& [rotation, translation, scale] = asset.nodes[i].parent_from_node;
        translation = translation * 100.0;
        if (asset.nodes[i].parent != kNone) continue;
        const Quaternion<double> t = back * Quaternion<double>{translation.x, translation.y, translation.z, 0} *
                                     turned.rotation;
        translation = {t.x, t.y, t.z};
        rotation = back * rotation;
    }
    asset = held(asset, turned);
    ASSERT_TRUE(add_clips(asset, held(animation_of(whole), {})));
    EXPECT_TRUE(asset.warnings.empty());
    expect_same_places(asset, whole);
}

TEST(AddClips, TracksWithoutANodeAreLeftOutAndNamed) {
    const Asset whole = walker_asset();
    Asset from = animation_of(whole), asset = without_clips(whole);
    const size_t track_count = whole.clips[0].tracks.size();
    from.nodes.push_back({.name = "tail"});
    from.clips[0].tracks.push_back({.node = static_cast<uint32_t>(from.nodes.size() - 1),
                                    .target = TrackTarget::kTranslation,
                                    .times_s = {0, 1},
                                    .values = {0, 0, 0, 1, 0, 0}});
    from.clips.push_back({.name = "wag", .duration_s = 1, .tracks = {from.clips[0].tracks.back()}});
    ASSERT_TRUE(add_clips(asset, from));
    ASSERT_EQ(asset.clips.size(), whole.clips.size()) << "without the one of which nothing is left";
    EXPECT_EQ(asset.clips[0].tracks.size(), track_count);
    ASSERT_EQ(asset.warnings.size(), 1u);
    std::set<uint32_t> nodes;
    for (const AssetClip& clip : from.clips)
        for (const AssetTrack& track : clip.tracks) nodes.insert(track.node);
    const size_t moved = nodes.size();
    EXPECT_EQ(asset.warnings[0],
              "moves.glb: 1 of its " + std::to_string(moved) + " animated nodes ('tail') are not in walker.glb");

    asset = without_clips(whole);
    for (size_t i = 0; i < from.nodes.size(); ++i) from.nodes[i].name = "other " + std::to_string(i * 7 + 1000);
    expect_refused(asset, from, "are not in walker.glb, which has");
    from.clips.clear();
    expect_refused(asset, from, "moves.glb: has no clips to add to walker.glb");
}

TEST(AddClips, GetUniqueNames) {
    const Asset whole = walker_asset();
    Asset from = animation_of(whole), asset = without_clips(whole);
    from.clips.resize(1);
    const auto add = [&](const char* file, const char* clip) {
        from.name = file;
        from.clips[0].name = clip;
        EXPECT_TRUE(add_clips(asset, from));
        return asset.clips.back().name;
    };
    EXPECT_EQ(add("walk.glb", "mixamo.com"), "walk");
    EXPECT_EQ(add("run.glb", "Armature|mixamo.com|Layer0"), "run");
    EXPECT_EQ(add("run.glb", ""), "run 2");
    EXPECT_EQ(add("idle.v2.gltf", "Take 001"), "idle.v2");
    EXPECT_EQ(add("moves.glb", "Jump"), "Jump");
    EXPECT_EQ(add("more.glb", "Jump"), "more Jump");
    EXPECT_EQ(add("more.glb", "Jump"), "more Jump 2");
    EXPECT_EQ(add("folder.v1/crawl.glb", "Armature|Take 001|BaseLayer"), "crawl");
    EXPECT_EQ(add(".glb", ""), "clip");

    from.name = "run.glb";
    from.clips.assign(3, from.clips[0]);
    EXPECT_TRUE(add_clips(asset, from));
    const size_t count = asset.clips.size();
    EXPECT_EQ(asset.clips[count - 3].name + ", " + asset.clips[count - 1].name, "run 3, run 5");
}

Asset face(size_t target_count) {
    Asset asset{.name = "face.glb", .nodes = {{.name = "Face"}}};
    AssetPrimitive primitive{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}};
    primitive.targets.resize(target_count, {.positions = std::vector<Vec3<float>>(3, {0, 0, 1})});
    asset.meshes = {{.weights = std::vector<float>(target_count), .primitives = {primitive}}};
    asset.mesh_instances = {{.node = 0, .mesh = 0}};
    return asset;
}

Asset face(const std::vector<std::string>& target_names) {
    Asset asset = face(target_names.size());
    asset.meshes[0].target_names = target_names;
    return asset;
}

// The face with a clip that has one such track.
Asset talking(Asset asset, Interpolation interpolation, const std::vector<float>& values) {
    asset.name = "talk.glb";
    asset.clips = {{.name = "talk", .duration_s = 1}};
    asset.clips[0].morph_tracks = {{.node = 0, .interpolation = interpolation, .times_s = {0, 1}, .values = values}};
    return asset;
}

TEST(AddClips, MorphWeightsGoToAMeshWithAsManyTargets) {
    const Asset from = talking(face(2), Interpolation::kLinear, {0, 1, 1, 0});
    Asset asset = face(2);
    asset.nodes.insert(asset.nodes.begin(), {.name = "root"});
    asset.nodes[1].parent = 0;
    asset.mesh_instances[0].node = 1;
    ASSERT_TRUE(add_clips(asset, from));
    ASSERT_EQ(asset.clips.size(), 1u);
    EXPECT_EQ(asset.clips[0].morph_tracks.at(0).node, 1u);
    EXPECT_EQ(asset.clips[0].morph_tracks[0].values, from.clips[0].morph_tracks[0].values);
    EXPECT_TRUE(compile_character(asset));
    expect_refused(face(3), from, "1 of its 1 animated nodes ('Face' with 2 morph targets) are not in face.glb");
}

TEST(AddClips, MorphWeightsGoByTheNamesOfTargets) {
    const auto added = [](Asset asset, const Asset& from) {
        EXPECT_TRUE(add_clips(asset, from));
        EXPECT_TRUE(compile_character(asset));
        return asset;
    };
    const auto values = [](const Asset& asset) { return asset.clips.at(0).morph_tracks.at(0).values; };
    const std::vector<float> keys{1, 2, 3, 4};
    const Asset from = talking(face({"blink", "smile"}), Interpolation::kLinear, keys);
    const Asset swapped = added(face({"smile", "blink"}), from);
    EXPECT_EQ(values(swapped), (std::vector<float>{2, 1, 4, 3}));
    EXPECT_TRUE(swapped.warnings.empty());
    EXPECT_EQ(values(added(face(2), from)), keys) << "without names in one";
    EXPECT_EQ(values(added(face({"same", "same"}), talking(face({"same", "same"}), Interpolation::kLinear, keys))),
              keys);

    // If the character has more targets, the others keep their weights: the node's if it has any, otherwise the mesh's.
    Asset more = face({"frown", "smile", "blink"});
    more.meshes[0].weights[0] = 0.25f;
    EXPECT_EQ(values(added(more, from)), (std::vector<float>{0.25f, 2, 1, 0.25f, 4, 3}));
    more.mesh_instances[0].weights = {0.5f, 0, 0};
    const Asset cubic = talking(face({"blink", "smile"}), Interpolation::kCubicSpline,
                                {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    EXPECT_EQ(values(added(more, cubic)),
              (std::vector<float>{0, 2, 1, 0.5f, 4, 3, 0, 6, 5, 0, 8, 7, 0.5f, 10, 9, 0, 12, 11}));

    // If it has fewer, the warnings name those that are lost.
    const Asset fewer = added(face({"smile"}), from);
    EXPECT_EQ(values(fewer), (std::vector<float>{2, 4}));
    EXPECT_EQ(fewer.warnings,
              (std::vector<std::string>{"talk.glb: 1 of 2 morph targets of 'Face' ('blink') are not in face.glb"}));
    expect_refused(face({"frown", "pout"}), from, "('Face' with 2 morph targets) are not in face.glb");
}

TEST(AddClips, RefuseInvalidAssets) {
    const Asset whole = walker_asset();
    Asset from = animation_of(whole), asset = without_clips(whole);
    from.clips[1].tracks[2].node = 1000;
    expect_refused(asset, from, "moves.glb: clips[1].tracks[2]");
    asset.nodes[3].parent = 1000;
    expect_refused(asset, animation_of(whole), "walker.glb: nodes[3]");
    asset = without_clips(whole);
    asset.mesh_instances[0].node = 1000;
    expect_refused(asset, animation_of(whole), "walker.glb: mesh_instances[0]: node is 1000");
    asset = without_clips(whole);
    asset.mesh_instances[0].weights.resize(1000);
    expect_refused(asset, animation_of(whole), "walker.glb: mesh_instances[0]: weights has 1000 elements");
    asset = without_clips(whole);
    asset.meshes[0].target_names.resize(1000);
    expect_refused(asset, animation_of(whole), "walker.glb: meshes[0]: target_names has 1000 elements");
}

}  // namespace
}  // namespace throng
