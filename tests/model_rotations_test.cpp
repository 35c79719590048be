// Layers that blend rotations in model space: the reference's own guarantees, and crowds against the reference.
#include "blend/active_clips_reference.h"
#include "tests/crowd_cases.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

namespace throng::test {
namespace {

const InSubset kModelRotationsInSubsets({Subset::kGpuAssisted}, {"ModelRotations.CrowdsFollowTheReference"});
const InSubset kModelRotationsNatively({Subset::kNative}, {"ModelRotations.*"});

// Compares the rotation of model_from_joint of a character without scale, by columns.
double direction_error(const Affine& got, const Quaternion<double>& wanted) {
    const AffineT<double> matrix = to_affine(Trs<double>{.rotation = wanted});
    double worst = 0;
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 3; ++column)
            worst = worse_of(worst, std::abs(double{got.row[row][column]} - matrix.row[row][column]));
    return worst;
}

double difference(const Quaternion<double>& a, const Quaternion<double>& b) {
    return std::sqrt(worse_of(0, 1 - dot(a, b) * dot(a, b)));
}

ReferenceLayer layer_of(const Trs<double>& pose, double weight, bool in_model_space) {
    return {.weight = weight, .active_clips = {{.pose = pose, .first = {}}}, .in_model_space = in_model_space};
}

// A chain of random poses with random weights, some of them 0 or 1.
TEST(ModelRotations, TheReferenceBlendsRotationsInModelSpace) {
    Random random(1);
    std::vector<ReferenceJoint> chain;
    Quaternion<double> below, layer, blended;
    for (int joint = 0; joint < 120; ++joint) {
        const Trs<double> a = random.trs(1, 0.2), b = random.trs(1, 0.2);
        const double weight = joint % 4 == 0 ? 0 : joint % 4 == 1 ? 1 : random.unit();
        chain.push_back(joint_reference(std::vector{layer_of(a, 1, false), layer_of(b, weight, true)},
                                        chain.empty() ? nullptr : &chain.back()));
        const Trs<double>& got = chain.back().pose;
        const Trs<double> in_parent = active_clips_reference(
            std::vector{layer_of(a, 1, false), layer_of(b, weight, false)});
        EXPECT_EQ(got.translation, in_parent.translation);
        EXPECT_EQ(got.scale, in_parent.scale);
        below = below * a.rotation;
        layer = layer * b.rotation;
        blended = blended * got.rotation;
        if (weight == 0) {
            EXPECT_LE(difference(got.rotation, a.rotation), 1e-7) << "without weight it follows its parent";
            continue;
        }
        const double side = dot(layer, below) < 0 ? -1 : 1;
        const auto mixed = [&](double l, double o) { return weight * l + (1 - weight) * side * o; };
        EXPECT_LE(difference(blended, normalized(Quaternion<double>{mixed(layer.x, below.x), mixed(layer.y, below.y),
                                                                    mixed(layer.z, below.z), mixed(layer.w, below.w)})),
                  1e-7)
            << "joint " << joint;
    }
}

TEST(ModelRotations, TheLowestLayerIsTheSameInEitherSpace) {
    Random random(2);
    const Trs<double> parent = random.trs(1, 0.2), pose = random.trs(1, 0.2);
    const ReferenceJoint above = joint_reference(std::vector{layer_of(parent, 1, true)}, nullptr);
    EXPECT_EQ(above.pose.rotation, active_clips_reference(std::vector{layer_of(parent, 1, false)}).rotation);
    EXPECT_EQ(joint_reference(std::vector{layer_of(pose, 1, true)}, &above).pose.rotation,
              active_clips_reference(std::vector{layer_of(pose, 1, false)}).rotation);
}

// A chain of hips, spine and head, and a charm that hangs from the head and has no part in the aim. One clip turns the
// hips by a quarter turn, the other aims.
class AimingCharacter {
public:
    Quaternion<double> turn = axis_angle(Vec3<double>{0, 1, 0}, std::numbers::pi / 2),
                       spine = axis_angle(Vec3<double>{1, 0, 0}, 0.5), head = axis_angle(Vec3<double>{0, 1, 0}, -0.3),
                       charm = axis_angle(Vec3<double>{0, 0, 1}, 0.7);
    Character character;
    Controller controller;

    AimingCharacter() {
        Asset asset = make_asset({.joint_count = 4, .shape = RigShape::kChain, .scale_spread = 0, .clip_count = 2});
        const auto clip = [&](const char* name, const std::vector<Quaternion<double>>& rotations) {
            AssetClip out{.name = name, .duration_s = 1};
            for (uint32_t node = 0; node < rotations.size(); ++node) {
                const Quaternion<float> q = rotations[node].as<float>();
                out.tracks.push_back({.node = node,
                                      .target = TrackTarget::kRotation,
                                      .times_s = {0, 1},
                                      .values = {q.x, q.y, q.z, q.w, q.x, q.y, q.z, q.w}});
            }
            return out;
        };
        asset.clips = {clip("turned", {turn, {}, {}, charm}), clip("aim", {{}, spine, head, {}})};
        character = *compile_character(asset, kExact);
        const std::vector<std::string>& names = character.rig.names;
        controller = direct_layers(
            2, {{.name = "upper", .items = {{.joint = names[1]}, {.joint = names[3], .weight = 0}}}});
        controller.layers[1].mask = "upper";
        controller.layers[1].model_space_rotations = true;
    }
};

TEST(ModelRotations, AimedJointsKeepTheirDirectionWhenTheHipsTurn) {
    const AimingCharacter aiming;
    const Character& character = aiming.character;
    ASSERT_EQ(character.rig.parents, (std::vector<uint32_t>{kNone, 0, 1, 2}));
    Controller local = aiming.controller;
    local.layers[1].model_space_rotations = false;
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2, .controller = &aiming.controller},
                                     {.character = &character, .instance_count = 1, .controller = &local}},
                          .keep_model_matrices = true});
    EXPECT_FALSE(crowd.path(0)->is_fused);
    EXPECT_TRUE(crowd.path(0)->reason.ends_with("staged: layer '" + aiming.controller.layers[1].name +
                                                "' blends rotations in model space"))
        << crowd.path(0)->reason;
    EXPECT_TRUE(crowd.path(1)->is_fused);
    for (uint32_t i = 0; i < 3; ++i) {
        ASSERT_TRUE(crowd.play(InstanceHandle{i}, 0, {.clip = {.clip = 0}}));
        ASSERT_TRUE(crowd.play(InstanceHandle{i}, 1, {.clip = {.clip = 1}}));
        ASSERT_TRUE(crowd.set_layer(InstanceHandle{i}, 1, {.weight = i == 1 ? 0.5f : 1.0f, .mask = 0}));
    }
    ASSERT_TRUE(crowd.update(0.1f));
    const auto half = [](const Quaternion<double>& a, const Quaternion<double>& b) {
        return normalized(Quaternion<double>{a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w});
    };
    const Quaternion<double> spine = aiming.spine, head = spine * aiming.head;
    const std::vector<Affine> full = *crowd.read_model_matrices({0}), mixed = *crowd.read_model_matrices({1}),
                              in_parent = *crowd.read_model_matrices({2});
    for (const std::vector<Affine>* model : {&full, &mixed, &in_parent})
        EXPECT_LE(direction_error((*model)[0], aiming.turn), 1e-6) << "the hips";
    EXPECT_LE(direction_error(full[1], spine), 1e-6) << "as if the hips had not turned";
    EXPECT_LE(direction_error(full[2], head), 1e-6);
    EXPECT_LE(direction_error(full[3], head * aiming.charm), 1e-6) << "without weight: turned in its parent as below";
    EXPECT_LE(direction_error(mixed[1], half(spine, aiming.turn)), 1e-6);
    EXPECT_LE(direction_error(mixed[2], half(head, aiming.turn)), 1e-6) << "not half of each joint's turn on the other";
    EXPECT_LE(direction_error(in_parent[1], aiming.turn * spine), 1e-6) << "in its parent it turns with the hips";
}

// Random plays and blends in both kinds of layers.
void follow_rotations(const Character& character, uint32_t instances, uint32_t layer_count, UpdatePath path) {
    Random random(character.rig.joint_count());
    std::vector<JointMask> masks{
        {.name = "half", .items = {{.joint = character.rig.names[character.rig.joint_count() / 3], .ramp = 3}}},
        {.name = "rest",
         .items = {{.joint = character.rig.names[0], .weight = 0.6f},
                   {.joint = character.rig.names[character.rig.joint_count() / 2], .weight = 0}}}};
    Controller controller = direct_layers(layer_count, masks);
    for (uint32_t i = 0; i < layer_count; i += 2) controller.layers[layer_count - 1 - i].model_space_rotations = true;
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = instances, .controller = &controller}},
                          .path = path,
                          .keep_model_matrices = true});
    std::vector<ReferenceCharacter> wanted = references(character, controller, instances);
    double worst = 0;
    for (int update = 0; update < 6; ++update) {
        for (uint32_t i = 0; i < instances; ++i) {
            for (uint32_t layer = 0; layer < layer_count; ++layer) {
                if (update > 0 && random.chance(0.5)) continue;
                const LayerPlayback playback{
                    .clip = {.clip = random.below(3), .time_s = random.between(0, 2)},
                    .fade_s = random.chance(0.5) ? 0 : static_cast<float>(random.between(0, 0.3))};
                const std::array<float, 4> weights{0, 1, 0.5f, static_cast<float>(random.unit())};
                const LayerBlend blend{.weight = weights[random.below(4)],
                                       .mode = random.chance(0.2) ? LayerMode::kAdditive : LayerMode::kOverride,
                                       .mask = std::array{kNone, 0u, 1u}[random.below(3)]};
                ASSERT_TRUE(crowd.play(InstanceHandle{i}, layer, playback) && wanted[i].play(layer, playback));
                ASSERT_TRUE(crowd.set_layer(InstanceHandle{i}, layer, blend) && wanted[i].set_layer(layer, blend));
            }
        }
        ASSERT_TRUE(crowd.update(0.07f));
        for (uint32_t i = 0; i < instances; ++i) {
            ASSERT_TRUE(wanted[i].update(0.07f));
            worst = std::max(worst, model_error(crowd, i, wanted[i].pose(), character.size));
        }
    }
    EXPECT_LE(worst, 1e-4);
    std::printf("  %5u joints, %3u levels, %u layers, %s keys, %s: largest error %.1e of the size\n",
                character.rig.joint_count(), character.rig.level_count, layer_count,
                character.packed ? "packed" : "exact", crowd.path(0)->scan.method.c_str(), worst);
}

TEST(ModelRotations, CrowdsFollowTheReference) {
    follow_rotations(creature(60, 15), 70, 3, UpdatePath::kAuto);
    follow_rotations(creature(120, 120), 9, 4, UpdatePath::kStaged);
    follow_rotations(creature(120, 120, 0), 9, 2, UpdatePath::kStaged);
    follow_rotations(creature(300, 60, 0), 5, 6, UpdatePath::kAuto);
    follow_rotations(creature(1, 1), 3, 2, UpdatePath::kAuto);
}

// More joints than a software device can process in one dispatch.
TEST(ModelRotations, ManyJointsTakeSeveralDispatches) {
    follow_rotations(creature(8000, 60, 0), 2, 3, UpdatePath::kAuto);
}

// Inertial transitions and poses from the application are applied afterwards.
TEST(ModelRotations, AStateMachineFollowsTheReference) {
    constexpr uint32_t kInstances = 20;
    const Character character = creature(60, 15);
    Controller controller = std::move(*load_controller(source_file("examples/controllers/dragon.json")));
    size_t changed = 0;
    for (size_t i = 1; i < controller.layers.size(); ++i) {
        controller.layers[i].mode = LayerMode::kOverride;
        controller.layers[i].model_space_rotations = true;
        ++changed;
    }
    ASSERT_GT(changed, 0u);
    Crowd crowd = create(
        {.groups =
             {{.character = &character, .instance_count = kInstances, .controller = &controller, .pose_capacity = 3}},
         .keep_model_matrices = true});
    std::vector<ReferenceCharacter> wanted = references(character, controller, kInstances);
    for (uint32_t i = 0; i < 3; ++i) {
        ASSERT_TRUE(crowd.set_pose(InstanceHandle{i}, character.rig.rest, 2));
        ASSERT_TRUE(wanted[i].set_pose(character.rig.rest, 2));
    }
    Random random(9);
    double worst = 0;
    for (int update = 0; update < 40; ++update) {
        for (uint32_t i = 0; i < kInstances; ++i) {
            const auto [parameter, value] = random_change(random, controller);
            ASSERT_TRUE(crowd.set_parameter(InstanceHandle{i}, parameter, value) &&
                        wanted[i].set_parameter(parameter, value));
        }
        const auto step_s = static_cast<float>(random.between(0, 0.1));
        ASSERT_TRUE(crowd.update(step_s));
        for (ReferenceCharacter& one : wanted) ASSERT_TRUE(one.update(step_s));
        if (update % 5 != 4) continue;
        for (uint32_t i = 0; i < kInstances; ++i)
            worst = std::max(worst, model_error(crowd, i, wanted[i].pose(), character.size));
    }
    EXPECT_LE(worst, 1e-4);
    std::printf("  dragon, %zu layers in model space: largest error %.1e of the size\n", changed, worst);
}

TEST(ModelRotations, AreRefusedWhereTheyDoNotApply) {
    const AimingCharacter aiming;
    const Result<Crowd> fused = Crowd::create(
        test_device(),
        {.groups = {{.character = &aiming.character, .instance_count = 1, .controller = &aiming.controller}},
         .path = UpdatePath::kFused});
    ASSERT_FALSE(fused);
    EXPECT_EQ(fused.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(fused.error().text().find("blends rotations in model space"), std::string::npos) << fused.error().text();

    Controller additive = aiming.controller;
    additive.layers[1].mode = LayerMode::kAdditive;
    const Result<void> checked = check_controller(additive, aiming.character);
    ASSERT_FALSE(checked);
    EXPECT_NE(checked.error().text().find("layers[1].rotations"), std::string::npos) << checked.error().text();

    const Result<Controller> parsed = parse_controller(
        R"({"layers": [{"name": "body"}, {"name": "arms", "rotations": "model"}, {"name": "legs", "rotations": )"
        R"("local"}]})",
        "x.json");
    ASSERT_TRUE(parsed) << parsed.error().text();
    EXPECT_FALSE(parsed->layers[0].model_space_rotations);
    EXPECT_TRUE(parsed->layers[1].model_space_rotations);
    EXPECT_FALSE(parsed->layers[2].model_space_rotations);
    const Result<Controller> wrong = parse_controller(
        R"({"layers": [{"name": "arms", "mode": "additive", "rotations": "model"}]})", "x.json");
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().code, ErrorCode::kInvalidFile);
    EXPECT_FALSE(parse_controller(R"({"layers": [{"name": "arms", "rotations": "world"}]})", "x.json"));
}

}  // namespace
}  // namespace throng::test
