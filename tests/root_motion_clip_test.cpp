// Root motion extracted from clips: the extracted motion and the remaining clip together give the original, and
// instances on the GPU move by it.
#include "control/controller_reference.h"
#include "control/layer_commands.h"
#include "crowd/crowd_state.h"
#include "sample/sample_reference.h"
#include "tests/crowd_cases.h"
#include "tests/files.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace throng {
namespace {

const test::InSubset kRootMotionClipInSubsets({test::Subset::kNative}, {"RootMotionOnTheGpu.*"});

using namespace test;
using std::numbers::pi;

constexpr Vec3<double> kUp{0, 1, 0};

struct ModelPose {
    Quaternion<double> rotation;
    Vec3<double> position;
};
using Motion = std::function<ModelPose(double time_s)>;

// A left circle at 1.2 m/s and 50 degrees/s, with the sway of a walk: two steps per second.
ModelPose walk(double time_s) {
    const double yaw = 50 * pi / 180 * time_s, radius = 1.2 / (50 * pi / 180), phase = 2 * pi * time_s;
    const Quaternion<double> swing = axis_angle(normalized(Vec3<double>{1, 0, 0.4}), 0.15 * std::sin(phase));
    return {axis_angle(kUp, yaw) * swing,
            {0.1 + radius * (1 - std::cos(yaw)), 0.9 + 0.04 * std::sin(2 * phase), -0.2 + radius * std::sin(yaw)}};
}

// A walker: hips with a leg, under an armature that is turned and scaled as exporters do. The armature may be a joint
// or not.
struct Walker {
    Asset asset{.name = "walker"};
    Trs<double> armature{
        axis_angle(normalized(Vec3<double>{1, 0.1, 0}), -pi / 2), {0.3, -0.1, 0.2}, {0.01, 0.01, 0.01}};
    enum : uint32_t { kArmature, kHips, kLeg };

    explicit Walker(bool armature_is_joint) {
        asset.nodes.push_back({.name = "armature", .parent_from_node = armature});
        asset.nodes.push_back({.name = "hips", .parent = kArmature, .parent_from_node = {.translation = {0, 90, 0}}});
        asset.nodes.push_back({.name = "leg", .parent = kHips, .parent_from_node = {.translation = {10, -40, 0}}});
        Affine large;
        for (size_t i = 0; i < 3; ++i) large.row[i][i] = 100;
        asset.skins.push_back({.name = "skin", .joints = {kHips, kLeg}, .inverse_binds = {large, large}});
        if (armature_is_joint) {
            asset.skins[0].joints.push_back(kArmature);
            asset.skins[0].inverse_binds.push_back(large);
        }
        AssetPrimitive primitive{.positions = {{0, 0, 0},
                                               {0.3f, 0.9f, 0.1f},
                                               {-0.2f, 0.4f, 0.3f},
                                               {0, -0.8f, 0},
                                               {0.1f, -0.4f, 0.2f},
                                               {0.1f, 0.2f, -0.5f}},
                                 .indices = {0, 1, 2, 3, 4, 5}};
        primitive.influence_count = 4;
        for (uint16_t v = 0; v < 6; ++v) {
            const auto joint = static_cast<uint16_t>(v / 3);
            primitive.influence_joints.insert(primitive.influence_joints.end(), {joint, 0, 0, 0});
            primitive.influence_weights.insert(primitive.influence_weights.end(), {1, 0, 0, 0});
        }
        asset.meshes.push_back({.name = "mesh", .primitives = {primitive}});
        asset.mesh_instances.push_back({.node = kHips, .mesh = 0, .skin = 0});
    }

    void clip(const char* name, double duration_s) { asset.clips.push_back({.name = name, .duration_s = duration_s}); }
    void track(uint32_t node, TrackTarget target, const std::vector<float>& times_s, const std::vector<float>& values,
               Interpolation interpolation = Interpolation::kLinear) {
        asset.clips.back().tracks.push_back(
            {.node = node, .target = target, .interpolation = interpolation, .times_s = times_s, .values = values});
    }

    // Adds keys at these times so that the hips move like `motion` in model space; the leg swings.
    void move(const char* name, const std::vector<float>& times_s, const Motion& motion,
              Interpolation interpolation = Interpolation::kLinear) {
        clip(name, times_s.back());
        const Quaternion<double> back{-armature.rotation.x, -armature.rotation.y, -armature.rotation.z,
                                      armature.rotation.w};
        std::vector<float> rotations, translations, swings;
        const auto append = [](std::vector<float>& to, std::initializer_list<double> values) {
            for (const double value : values) to.push_back(static_cast<float>(value));
        };
        for (const float time_s : times_s) {
            const ModelPose pose = motion(time_s);
            const Quaternion<double> q = back * pose.rotation,
                                     swing = axis_angle(Vec3<double>{1, 0, 0}, 0.5 * std::sin(2 * pi * double{time_s}));
            const Vec3<double> p = transform_vector(to_affine(Trs<double>{.rotation = back}),
                                                    pose.position - armature.translation) *
                                   (1 / armature.scale.x);
            append(rotations, {q.x, q.y, q.z, q.w});
            append(translations, {p.x, p.y, p.z});
            append(swings, {swing.x, swing.y, swing.z, swing.w});
        }
        track(kHips, TrackTarget::kRotation, times_s, rotations, interpolation);
        track(kHips, TrackTarget::kTranslation, times_s, translations, interpolation);
        track(kLeg, TrackTarget::kRotation, times_s, swings);
    }
};

std::vector<float> times(double duration_s, double rate) {
    std::vector<float> out;
    for (int key = 0; key / rate < duration_s - 1e-6; ++key) out.push_back(static_cast<float>(key / rate));
    out.push_back(static_cast<float>(duration_s));
    return out;
}

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

// ---- On the GPU

// A crowd of walkers with a layer to play clips on, and the reference's result for each.
class Walking {
public:
    Walking(const Character& character, uint32_t count, bool moves_placements, UpdatePath path = UpdatePath::kAuto,
            Controller controller = direct_layers(1))
        : controller_(std::move(controller)),
          crowd_(create({.groups = {{.character = &character,
                                     .instance_count = count,
                                     .controller = &controller_,
                                     .moves_placements = moves_placements}},
                         .path = path})),
          references_(count, ControllerReference(controller_, character)),
          moves_placements_(moves_placements),
          base_(count),
          place_(count),
          moved_m_(count) {
        for (const Clip& clip : character.clips) durations_s_.push_back(clip.duration_s);
        EXPECT_TRUE(crowd_.watch(InstanceHandle{count - 1}));
    }

    void play(uint32_t instance, const LayerPlayback& playback) {
        const Result<void> played = crowd_.play(InstanceHandle{instance}, 0, playback);
        ASSERT_TRUE(played) << played.error().text();
        references_[instance].apply(play_command(std::vector<LayerKind>(1), durations_s_, 0, playback, "reference"));
    }

    void stand(uint32_t instance, const Affine& world_from_model) {
        ASSERT_TRUE(crowd_.set_placement(InstanceHandle{instance}, world_from_model));
        base_[instance] = world_from_model;
        place_[instance] = {};
        moved_m_[instance] = 0;
    }

    void step(float time_step_s) {
        ASSERT_TRUE(crowd_.update(time_step_s));
        const OutputBlock& block = crowd_.outputs()[0];
        const uint64_t count = references_.size();
        const std::vector<Affine> placements = output<Affine>(block, &OutputBlock::placement, count,
                                                              crowd_.state().gpu);
        ASSERT_EQ(crowd_.state().batches[0][io::kRootsBuffer].size_bytes(), count * sizeof(io::RootState));
        const std::vector<io::RootState> roots = output<io::RootState>(block, &OutputBlock::root, count,
                                                                       crowd_.state().gpu);
        const std::vector<Feedback> feedback = *crowd_.feedback();
        ASSERT_TRUE(feedback.size() == 1 && feedback[0].watched.size() == 1);
        const WatchedInstance& watched = feedback[0].watched[0];
        EXPECT_EQ(watched.world_from_model, placements.back());
        const io::vec4& told = roots.back().move;
        EXPECT_EQ(watched.move.row, (std::array<std::array<float, 4>, 3>{
                                        {{told.z, 0, told.w, told.x}, {0, 1, 0, 0}, {-told.w, 0, told.z, told.y}}}));
        for (uint32_t i = 0; i < count; ++i) {
            const GroundMove move = references_[i].update(time_step_s).move;
            place_[i] = turned_to_length_one(place_[i] * move);
            moved_m_[i] += std::hypot(move.x, move.z);
            const double bound = 1e-4 * moved_m_[i] + 1e-6;
            EXPECT_NEAR(roots[i].move.x, move.x, 1e-5 * (1 + std::hypot(move.x, move.z)));
            EXPECT_NEAR(roots[i].move.y, move.z, 1e-5 * (1 + std::hypot(move.x, move.z)));
            EXPECT_NEAR(roots[i].move.z, move.cos, 1e-5);
            EXPECT_NEAR(roots[i].move.w, move.sin, 1e-5);
            const AffineT<double> wanted = moves_placements_ ? base_[i].as<double>() * affine_of(place_[i])
                                                             : base_[i].as<double>();
            for (size_t row = 0; row < 3; ++row)
                for (size_t column = 0; column < 4; ++column) {
                    const double tolerance = moves_placements_ ? 2 * (column == 3 ? bound : 1e-4) : 0;
                    EXPECT_NEAR(placements[i].row[row][column], wanted.row[row][column], tolerance)
                        << "instance " << i << ": " << row << ", " << column;
                }
        }
    }

    // Odd time steps, some over several cycles and some backwards.
    void steps(uint32_t count, uint64_t seed) {
        Random random(seed);
        for (uint32_t i = 0; i < count && !::testing::Test::HasFailure(); ++i)
            step(static_cast<float>(random.below(20) == 0 ? random.between(-1, 7) : random.between(0, 0.05)));
    }

    double distance_m(uint32_t instance) const { return moved_m_[instance]; }

private:
    static AffineT<double> affine_of(const GroundMove& move) {
        AffineT<double> out;
        out.row = {{{move.cos, 0, move.sin, move.x}, {0, 1, 0, 0}, {-move.sin, 0, move.cos, move.z}}};
        return out;
    }

    Controller controller_;
    Crowd crowd_;
    std::vector<ControllerReference> references_;
    std::vector<float> durations_s_;
    bool moves_placements_;
    std::vector<Affine> base_;
    std::vector<GroundMove> place_;
    std::vector<double> moved_m_;
};

Character walkers(double error) {
    Walker walker(true);
    walker.move("walk", times(2, 30), walk);
    walker.move("stroll", times(1.5, 24), [](double time_s) {
        return ModelPose{axis_angle(kUp, -0.3 * time_s), {0, 0.9, 0.8 * time_s}};
    });
    walker.move("idle", times(1, 30), [](double) { return ModelPose{{}, {0, 0.9, 0}}; });
    return compiled(walker.asset, {.error = error, .root_motion_joint = "hips"});
}

const Affine kSomewhere =
    to_affine(Trs<double>{axis_angle(normalized(Vec3<double>{0.1, 1, 0.2}), 1.1), {5, 1, -3}, {2, 2, 2}}).as<float>();

TEST(RootMotionOnTheGpu, PlacementsFollowTheClips) {
    for (const double error : {0.0, 1e-4})
        for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged}) {
            const Character character = walkers(error);
            Walking walking(character, 2, true, path);
            walking.play(0, {.clip = {.clip = 0}});
            walking.play(1, {.clip = {.clip = 1, .time_s = 0.7}});
            walking.stand(1, kSomewhere);
            walking.steps(200, 1);
            EXPECT_GT(walking.distance_m(0), 10);
        }
}

TEST(RootMotionOnTheGpu, AStateWithoutClipsDoesNotMove) {
    const Character character = walkers(0);
    Controller controller{.name = "stop and go"};
    controller.layers = {{.name = "body",
                          .states = {{.name = "stand"}, {.name = "stroll", .points = {{"stroll"}}}},
                          .transitions = {{.from = "stand", .to = "stroll", .fade_s = 0.5f},
                                          {.from = "stroll", .to = "stand", .exit = 0.5f, .fade_s = 0.5f}}}};
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged}) {
        Walking walking(character, 2, true, path, controller);
        walking.stand(1, kSomewhere);
        walking.steps(200, 9);
        EXPECT_GT(walking.distance_m(0), 2);
    }
}

// Each step is rounded to the float precision at such a distance. Those errors alone would add up to fifteen times the
// bound.
TEST(RootMotionOnTheGpu, ManyShortStepsAddUpPrecisely) {
    constexpr float kStep_s = 1 / 30.0f, kSpeed = 1.5f;
    constexpr int kSteps = 3000;
    Walker walker(true);
    walker.move("run", times(1, 30), [](double time_s) { return ModelPose{{}, {0, 0.9, double{kSpeed} * time_s}}; });
    const Character character = compiled(walker.asset, {.error = 0, .root_motion_joint = "hips"});
    const Controller controller = direct_layers(1);
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged}) {
        Crowd crowd = create(
            {.groups = {{.character = &character, .instance_count = 2, .controller = &controller}}, .path = path});
        ASSERT_TRUE(crowd.play(crowd.instances(), 0, LayerPlayback{.clip = {.clip = 0}}));
        const Affine far_away = to_affine(Trs<float>{.translation = {700, 2, -300}});
        ASSERT_TRUE(crowd.set_placement(InstanceHandle{1}, far_away));
        for (int step = 0; step < kSteps; ++step) ASSERT_TRUE(crowd.update(kStep_s));
        const std::vector<Affine> placements = output<Affine>(crowd.outputs()[0], &OutputBlock::placement, 2,
                                                              crowd.state().gpu);
        const double way = double{kSpeed} * kSteps * double{kStep_s};
        EXPECT_NEAR(placements[0].row[2][3], way, 2e-6 * way);
        EXPECT_NEAR(placements[1].row[2][3], far_away.row[2][3] + way, 2e-6 * way);
        EXPECT_NEAR(placements[1].row[0][3], far_away.row[0][3], 2e-6 * way);
    }
}

TEST(RootMotionOnTheGpu, IsOnlyReportedWithoutMovesPlacements) {
    const Character character = walkers(0);
    Walking walking(character, 2, false);
    walking.play(0, {.clip = {.clip = 0}});
    walking.stand(1, kSomewhere);
    walking.play(1, {.clip = {.clip = 1}});
    walking.steps(200, 2);
    EXPECT_GT(walking.distance_m(1), 5);
}

TEST(RootMotionOnTheGpu, MovementContinuesFromASetPlacement) {
    const Character character = walkers(0);
    Walking walking(character, 2, true);
    walking.play(0, {.clip = {.clip = 0}});
    walking.play(1, {.clip = {.clip = 0, .time_s = 1}});
    walking.steps(50, 3);
    walking.stand(0, kSomewhere);
    walking.steps(100, 4);
    walking.stand(1, kSomewhere);
    walking.steps(50, 5);
}

TEST(RootMotionOnTheGpu, FollowsBackwardAndNonLoopingClips) {
    const Character character = walkers(0);
    Walking walking(character, 2, true);
    walking.play(0, {.clip = {.clip = 0, .time_s = 0.3, .speed = -0.7f}});
    walking.play(1, {.clip = {.clip = 1, .speed = 1.3f, .loop = false}});
    walking.steps(200, 6);
    EXPECT_GT(walking.distance_m(0), 5);
    EXPECT_LT(walking.distance_m(1), 5);
}

TEST(RootMotionOnTheGpu, CrossFadingClipsBlendTheirMovement) {
    const Character character = walkers(0);
    Walking walking(character, 2, true);
    Random random(7);
    for (int round = 0; round < 10; ++round) {
        for (uint32_t i = 0; i < 2; ++i)
            walking.play(i, {.clip = {.clip = random.below(3),
                                      .time_s = random.unit(),
                                      .speed = static_cast<float>(random.between(-1, 2))},
                             .fade_s = static_cast<float>(random.between(0.1, 0.8))});
        walking.steps(20, 8 + static_cast<uint64_t>(round));
    }
}

}  // namespace
}  // namespace throng
