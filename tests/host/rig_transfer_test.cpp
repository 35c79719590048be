// Transferring clips between rigs with the same names but different parents, orientation, scale or structure. Expected
// results are calculated by hand.
#include <throng/character.h>
#include <throng/reference.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace throng {
namespace {

struct Part {
    const char* name;
    uint32_t parent;
    Trs<double> parent_from_node;
    bool is_joint = true;
};

// Joints and their parents, without a mesh.
Asset rig_of(const char* name, const std::vector<Part>& parts) {
    Asset asset{.name = name};
    AssetSkin skin;
    for (const Part& part : parts) {
        if (part.is_joint) skin.joints.push_back(static_cast<uint32_t>(asset.nodes.size()));
        asset.nodes.push_back({.name = part.name, .parent = part.parent, .parent_from_node = part.parent_from_node});
    }
    skin.inverse_binds.resize(skin.joints.size());
    asset.skins = {skin};
    return asset;
}

// The same without a skin, and with a clip of these tracks of two keys.
Asset clip_of(const std::vector<Part>& parts, const std::vector<AssetTrack>& tracks) {
    Asset asset = rig_of("moves.glb", parts);
    asset.skins.clear();
    asset.clips = {{.name = "move", .duration_s = 1, .tracks = tracks}};
    return asset;
}

AssetTrack moving(uint32_t node, Vec3<float> begin, Vec3<float> end) {
    return {.node = node,
            .target = TrackTarget::kTranslation,
            .times_s = {0, 1},
            .values = {begin.x, begin.y, begin.z, end.x, end.y, end.z}};
}

AssetTrack turning(uint32_t node, const Quaternion<double>& begin, const Quaternion<double>& end) {
    AssetTrack track{.node = node, .target = TrackTarget::kRotation, .times_s = {0, 1}};
    for (const Quaternion<double>& q : {begin, end})
        for (const double part : {q.x, q.y, q.z, q.w}) track.values.push_back(static_cast<float>(part));
    return track;
}

// The position of a joint at the end of the transferred clip.
Vec3<double> place_at_end(Asset asset, const Asset& from, const std::string& joint) {
    const Result<void> added = add_clips(asset, from);
    EXPECT_TRUE(added) << added.error().text();
    if (!added) return {};
    const Character character = compile_character(asset, {.error = 0}).expect();
    const ReferencePose pose = reference_pose(character, {.first = {.clip = 0, .time_s = 1, .loop = false}}).expect();
    const AffineT<double>& m = pose.model_from_joint[character.rig.joint_named(joint).expect()];
    return {m.row[0][3], m.row[1][3], m.row[2][3]};
}

void expect_near(const Vec3<double>& got, const Vec3<double>& wanted, const char* what) {
    EXPECT_LT(length(got - wanted), 1e-6) << what << ": " << got.x << ", " << got.y << ", " << got.z << " in place of "
                                          << wanted.x << ", " << wanted.y << ", " << wanted.z;
}

TEST(RigTransfer, FitsRigsWithOtherArmatureTransforms) {
    const Quaternion<double> none, lying = axis_angle<double>({1, 0, 0}, -1.5707963267948966);
    const Quaternion<double> upright{-lying.x, -lying.y, -lying.z, lying.w};
    const auto at = [](double x, double y, double z) { return Trs<double>{.translation = {x, y, z}}; };
    const Trs<double> in_cm{.scale = {0.01, 0.01, 0.01}}, turned{.rotation = lying};

    const std::vector<Part> in_m{{"Armature", kNone, {}, false}, {"Hips", 0, at(0, 1, 0)}, {"Head", 1, at(0, 0.7, 0)}};
    const Asset of_cm = rig_of(
        "cm.glb", {{"Armature", kNone, in_cm, false}, {"Hips", 0, at(0, 100, 0)}, {"Head", 1, at(0, 70, 0)}});
    expect_near(place_at_end(of_cm, clip_of(in_m, {moving(0, {0, 0, 0}, {0, 0, 1})}), "Head"), {0, 1.7, 1},
                "what holds the rig walks, in metres");
    expect_near(place_at_end(of_cm, clip_of(in_m, {moving(1, {0, 1, 0}, {0, 1, 2})}), "Head"), {0, 1.7, 2},
                "hips walk");

    // Keys that equal the clip's rest pose, and a scale track.
    const Asset hips_in_cm = rig_of(
        "hips.glb",
        {{"Hips", kNone, {.translation = {0, 1, 0}, .scale = {0.01, 0.01, 0.01}}}, {"Head", 0, at(0, 70, 0)}});
    AssetTrack scale = moving(0, {1, 1, 1}, {1, 1, 1});
    scale.target = TrackTarget::kScale;
    expect_near(place_at_end(hips_in_cm,
                             clip_of({{"Hips", kNone, at(0, 1, 0)}, {"Head", 0, at(0, 0.7, 0)}},
                                     {scale, moving(0, {0, 1, 0}, {1, 1, 0}), moving(1, {0, 0.7f, 0}, {0, 0.7f, 0})}),
                             "Head"),
                {1, 1.7, 0}, "a unit in the scale of a joint");

    // The rig has a bone that the clip does not.
    const Asset with_neck = rig_of(
        "neck.glb", {{"Chest", kNone, at(0, 1, 0)}, {"Neck", 0, at(0, 0.3, 0)}, {"Head", 1, at(0, 0.5, 0)}});
    expect_near(place_at_end(with_neck,
                             clip_of({{"Chest", kNone, at(0, 1, 0)}, {"Head", 0, at(0, 1, 0)}},
                                     {moving(0, {0, 1, 0}, {0, 1, 1}), moving(1, {0, 1, 0}, {0, 1, 0})}),
                             "Head"),
                {0, 1.8, 1}, "a neck more");

    // The pose in model space is the same whatever is turned: the Head is 0.7 above the Hips in `from`.
    const Asset lying_armature = rig_of("lying.glb", {{"Armature", kNone, turned, false},
                                                      {"Hips", 0, {.rotation = upright, .translation = {0, 0, 1}}},
                                                      {"Head", 1, at(0, 0.7, 0)}});
    expect_near(
        place_at_end(lying_armature, clip_of(in_m, {moving(0, {0, 0, 0}, {0, 0, 1}), turning(1, none, none)}), "Head"),
        {0, 1.7, 1}, "what holds the rig is turned, and walks");
    expect_near(
        place_at_end(lying_armature,
                     clip_of(in_m, {moving(0, {0, 0, 0}, {0, 0, 1}), turning(0, none, none), turning(1, none, none)}),
                     "Head"),
        {0, 1.7, 1}, "the same, with keys of what holds it");
    const Asset lying_root = rig_of("root.glb", {{"root", kNone, turned},
                                                 {"Hips", 0, {.rotation = upright, .translation = {0, 0, 1}}},
                                                 {"Head", 1, at(0, 0.7, 0)}});
    expect_near(place_at_end(lying_root,
                             clip_of({{"root", kNone, {}}, {"Hips", 0, at(0, 1, 0)}, {"Head", 1, at(0, 0.7, 0)}},
                                     {turning(1, none, none)}),
                             "Head"),
                {0, 1.7, 0}, "a joint is turned that the clip leaves as it is");
    expect_near(place_at_end(rig_of("plain.glb", {{"Hips", kNone, at(0, 1, 0)}, {"Head", 0, at(0, 0.7, 0)}}),
                             clip_of({{"root", kNone, turned},
                                      {"Hips", 0, {.rotation = upright, .translation = {0, 0, 1}}},
                                      {"Head", 1, at(0, 0.7, 0)}},
                                     {turning(1, upright, upright)}),
                             "Head"),
                {0, 1.7, 0}, "a root that the character does not have");
    expect_near(
        place_at_end(rig_of("lifted.glb",
                            {{"Armature", kNone, at(0, 1, 0), false}, {"Hips", 0, {}}, {"Head", 1, at(0, 0.7, 0)}}),
                     clip_of(in_m, {moving(1, {0, 1, 0}, {0, 1, 1})}), "Head"),
        {0, 1.7, 1}, "what holds the rig is lifted");
    expect_near(
        place_at_end(rig_of("joint.glb", {{"root", kNone, at(0, 1, 0)}, {"Hips", 0, {}}, {"Head", 1, at(0, 0.7, 0)}}),
                     clip_of(in_m, {moving(1, {0, 1, 0}, {0, 1, 2})}), "Head"),
        {0, 1.7, 2}, "a lifted joint holds the rig, which the clip does not have");
}

// Only a few of many bones.
TEST(RigTransfer, LegsKeepTheirLengthAmongManyEqualBones) {
    std::vector<Part> parts{{"Hips", kNone, {.translation = {0, 1, 0}}},
                            {"Thigh", 0, {.translation = {0, -0.5, 0}}},
                            {"Shin", 1, {.translation = {0, -0.5, 0}}}};
    std::vector<AssetTrack> tracks{moving(0, {0, 1, 0}, {0, 1, 0}), moving(1, {0, -0.3f, 0}, {0, -0.3f, 0}),
                                   moving(2, {0, -0.3f, 0}, {0, -0.3f, 0})};
    std::vector<std::string> names;
    for (uint32_t i = 0; i < 30; ++i) names.push_back("Finger " + std::to_string(i));
    for (uint32_t i = 0; i < 30; ++i) {
        parts.push_back({names[i].c_str(), 0, {.translation = {0.1, 0, 0}}});
        tracks.push_back(moving(3 + i, {0.1f, 0, 0}, {0.1f, 0, 0}));
    }
    const Asset character = rig_of("long.glb", parts);
    parts[1].parent_from_node.translation.y = parts[2].parent_from_node.translation.y = -0.3;
    parts[0].parent_from_node.translation.y = 0.6;
    tracks[0] = moving(0, {0, 0.6f, 0}, {0, 0.6f, 0.1f});
    const Asset from = clip_of(parts, tracks);
    const Vec3<double> hips = place_at_end(character, from, "Hips"), foot = place_at_end(character, from, "Shin");
    EXPECT_NEAR(hips.y - foot.y, 1, 1e-6);
}

// "Spine2" is missing in the rig, so its descendants cannot turn with it.
TEST(RigTransfer, NamesMissingJointsThatRotate) {
    const auto at = [](double y) { return Trs<double>{.translation = {0, y, 0}}; };
    const Quaternion<double> turn = axis_angle<double>({0, 0, 1}, 1);
    const std::vector<Part> parts{
        {"Hips", kNone, at(1)}, {"Spine2", 0, at(0.3)}, {"Neck", 1, at(0.3)}, {"Tail", 0, at(-0.1)}};
    Asset asset = rig_of("short.glb", {{"Hips", kNone, at(1)}, {"Neck", 0, at(0.6)}});
    Asset from = clip_of(parts,
                         {turning(0, {}, turn), turning(1, {}, turn), turning(2, {}, turn), turning(3, {}, turn)});
    ASSERT_TRUE(add_clips(asset, from));
    EXPECT_EQ(asset.warnings,
              (std::vector<std::string>{"moves.glb: 2 of its 4 animated nodes ('Spine2', 'Tail') are not in short.glb; "
                                        "what is below 'Spine2' will be turned differently"}));
    // A missing joint that only translates turns nothing.
    asset.warnings.clear();
    from.clips[0].tracks[1] = moving(1, {0, 0.3f, 0}, {0, 0.5f, 0});
    ASSERT_TRUE(add_clips(asset, from));
    EXPECT_EQ(
        asset.warnings,
        (std::vector<std::string>{"moves.glb: 2 of its 4 animated nodes ('Spine2', 'Tail') are not in short.glb"}));
}

// Clothes are often exported with their own copy of the skeleton.
TEST(RigTransfer, MovesAllJointsWithTheSameName) {
    const auto at = [](double y) { return Trs<double>{.translation = {0, y, 0}}; };
    Asset asset = rig_of(
        "clothed.glb", {{"Hips", kNone, at(1)}, {"Spine", 0, at(0.5)}, {"Hips", kNone, at(1)}, {"Spine", 2, at(0.5)}});
    asset.skins.push_back(asset.skins[0]);
    asset.skins[0].joints = {0, 1};
    asset.skins[1].joints = {2, 3};
    for (AssetSkin& skin : asset.skins) skin.inverse_binds.resize(2);
    const Quaternion<double> turn = axis_angle<double>({0, 0, 1}, 1);
    ASSERT_TRUE(add_clips(
        asset, clip_of({{"Hips", kNone, at(1)}, {"Spine", 0, at(0.5)}}, {turning(0, {}, turn), turning(1, {}, turn)})));
    std::vector<uint32_t> moved;
    for (const AssetTrack& track : asset.clips.at(0).tracks) moved.push_back(track.node);
    std::ranges::sort(moved);
    EXPECT_EQ(moved, (std::vector<uint32_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace throng
