// Morph targets: the stage against its reference, and crowds' positions against the definition.
#include "control/controller_io.h"
#include "morph/morph.h"
#include "morph/morph_reference.h"
#include "skin/skin_reference.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/morph_cases.h"
#include "tests/shared.h"
#include "tests/subset.h"
#include "tests/upload_now.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace throng {
namespace {

const test::InSubset kMorphInSubsets({test::Subset::kGpuAssisted}, {"Morph.TwoClipsFollowTheReference"});
const test::InSubset kMorphNatively({test::Subset::kNative}, {"Morph.*"});

using namespace test;

constexpr double kWeightBound = 1e-5;

struct Instance {
    Playback two;  // of clips
    std::vector<MorphLayer> layers;
};

std::vector<MorphLayer> layers_of(const Character& character, const Playback& playback) {
    const auto active_clip = [&](const ClipPlayback& play, double weight) {
        return MorphActiveClip{play.clip == kNone ? static_cast<uint32_t>(character.clips.size()) : play.clip.number,
                               play.time_s, weight};
    };
    return {{.active_clips = {active_clip(playback.first, double{playback.weight}),
                              active_clip(playback.second, 1 - double{playback.weight})}}};
}

class Stage {
public:
    // `limit`: how many morphs an instance shows at most.
    explicit Stage(const Character& character, uint32_t limit = UINT32_MAX) : character_(character), limit_(limit) {
        upload_now([&](Uploads& uploads) { upload_morph_tables(uploads, character, tables_); });
    }

    std::vector<std::vector<io::ActiveMorph>> run_two(const std::vector<Playback>& playbacks) const {
        std::vector<io::InstancePlayback> states;
        const auto play = [&](const ClipPlayback& from) {
            return io::ClipPlay{from.clip == kNone ? static_cast<uint32_t>(character_.clips.size()) : from.clip.number,
                                from.loop, static_cast<float>(from.time_s), from.speed};
        };
        for (const Playback& playback : playbacks)
            states.push_back({play(playback.first), play(playback.second), playback.weight});
        const Guarded<io::InstancePlayback> buffer(states);
        const Guarded<io::vec4> none(std::vector<io::vec4>(1));
        return run(buffer, none, none, static_cast<uint32_t>(playbacks.size()), 0);
    }

    std::vector<std::vector<io::ActiveMorph>> run_layers(const std::vector<std::vector<MorphLayer>>& instances,
                                                         uint32_t active_clip_limit = 16) const {
        std::vector<io::ActiveClip> active_clips(instances.size() * active_clip_limit);
        std::vector<float> times_s(active_clips.size(), 0.5f);
        for (size_t i = 0; i < instances.size(); ++i) {
            size_t at = i * active_clip_limit;
            for (const MorphLayer& layer : instances[i]) {
                for (const MorphActiveClip& active_clip : layer.active_clips) {
                    times_s[at] = static_cast<float>(active_clip.time_s);
                    active_clips[at++] = {.first_track = active_clip.clip * character_.rig.joint_count(),
                                          .earlier = 0,
                                          .later = 0,
                                          .fraction = 0,
                                          .weight = static_cast<float>(active_clip.weight),
                                          .layer_weight = static_cast<float>(layer.weight),
                                          .reference_row = 0,
                                          .flags = layer.is_additive ? io::kActiveClipAdditive : 0};
                }
                active_clips[at - layer.active_clips.size()].flags |= io::kActiveClipBeginsLayer;
                active_clips[at - 1].flags |= io::kActiveClipEndsLayer;
            }
            active_clips[at - 1].flags |= io::kActiveClipEnds;
        }
        const Guarded<io::ActiveClip> buffer(active_clips);
        const Guarded<float> time_buffer(times_s);
        return run(time_buffer, buffer, time_buffer, static_cast<uint32_t>(instances.size()), active_clip_limit);
    }

private:
    std::vector<std::vector<io::ActiveMorph>> run(const BufferRange& playbacks, const BufferRange& active_clips,
                                                  const BufferRange& times, uint32_t count,
                                                  uint32_t active_clip_limit) const {
        const uint32_t limit = std::min(limit_, static_cast<uint32_t>(character_.morphs.size()));
        const Guarded<io::ActiveMorph> active(poison<io::ActiveMorph>(count * size_t{limit}));
        run_invocations(morph_kernel(test_gpu(), active_clip_limit > 0),
                        BufferTable{{io::kPlaybacksBuffer, playbacks},
                                    {io::kActiveClipsBuffer, active_clips},
                                    {io::kActiveClipTimesBuffer, times},
                                    {io::kMorphTimelineBuffer, tables_[io::kMorphTimelineBuffer]},
                                    {io::kMorphTimesBuffer, tables_[io::kMorphTimesBuffer]},
                                    {io::kMorphTracksBuffer, tables_[io::kMorphTracksBuffer]},
                                    {io::kMorphValuesBuffer, tables_[io::kMorphValuesBuffer]},
                                    {io::kActiveMorphsBuffer, active},
                                    {io::kBirthsBuffer, Guarded<uint32_t>({})}},
                        io::MorphPush{count, static_cast<uint32_t>(character_.morphs.size()),
                                      character_.rig.joint_count(), active_clip_limit, limit},
                        count);
        const std::vector<io::ActiveMorph> all = active.read();
        std::vector<std::vector<io::ActiveMorph>> out;
        for (size_t i = 0; i < all.size(); i += limit)
            out.emplace_back(all.begin() + static_cast<ptrdiff_t>(i), all.begin() + static_cast<ptrdiff_t>(i + limit));
        return out;
    }

    const Character& character_;
    uint32_t limit_;
    Buffers tables_;
};

// The set of active morphs may differ if weights are equal up to rounding. Each must have its weight, and none that was
// left out may have a larger weight than one that was not.
double compare(const std::vector<io::ActiveMorph>& got, const std::vector<double>& weights) {
    double worst = 0, least = 1e30;
    std::vector<bool> is_active(weights.size());
    for (size_t i = 0; i < got.size(); ++i) {
        least = std::min(least, std::abs(double{got[i].weight}));
        if (i > 0 && got[i].weight != 0 && got.size() < weights.size()) {
            EXPECT_LE(std::abs(got[i].weight), std::abs(got[i - 1].weight)) << "sorted, where not all may be shown";
        } else if (i > 0 && got[i].weight != 0) {
            EXPECT_GT(got[i].morph, got[i - 1].morph);
        }
        if (i > 0 && got[i - 1].weight == 0) {
            EXPECT_EQ(got[i].weight, 0);
        }
        if (got[i].weight == 0) continue;
        EXPECT_LT(got[i].morph, weights.size());
        if (got[i].morph >= weights.size()) return 1e9;
        EXPECT_FALSE(is_active[got[i].morph]) << "twice";
        is_active[got[i].morph] = true;
        worst = worse_of(worst, std::abs(got[i].weight - weights[got[i].morph]));
    }
    for (size_t morph = 0; morph < weights.size(); ++morph)
        if (!is_active[morph]) {
            EXPECT_LE(std::abs(weights[morph]), std::max(least, 1e-6) + kWeightBound)
                << "morph " << morph << " was left out";
        }
    return worst;
}

double as_float(double value) { return static_cast<float>(value); }

TEST(Morph, TwoClipsFollowTheReference) {
    // The layers make another block a loop's header, which no driver accepts. Without them, the module is valid by
    // SPIR-V's validator.
    if (const char* validation = std::getenv("THRONG_VALIDATION");
        validation && validation == std::string_view("gpu-assisted"))
        GTEST_SKIP() << "the instrumentation of Debian 12's validation layers breaks this kernel";
    double worst = 0;
    for (const auto& [morph_count, limit] : {std::pair{1u, 8u}, {2u, 1u}, {3u, 8u}, {5u, 8u}, {40u, 8u}, {40u, 100u}}) {
        const Character character = make_character(
            {.joint_count = 4, .seed = morph_count, .cubic = true, .morph_count = morph_count});
        const Stage stage(character, limit);
        Random random(morph_count);
        std::vector<Playback> playbacks;
        for (int i = 0; i < 100; ++i) {
            Playback playback = random_playback(random, character);
            for (ClipPlayback* play : {&playback.first, &playback.second})
                play->time_s = as_float(random.between(0, 3));
            playbacks.push_back(playback);
        }
        const auto got = stage.run_two(playbacks);
        for (size_t i = 0; i < playbacks.size(); ++i)
            worst = std::max(worst, compare(got[i], morphs_reference(character, layers_of(character, playbacks[i]))));
    }
    EXPECT_LE(worst, kWeightBound);
    std::printf("  largest error of a weight %.1e\n", worst);
}

TEST(Morph, LayersFollowTheReference) {
    double worst = 0;
    for (const auto& [morph_count, limit] : {std::pair{1u, 8u}, {4u, 8u}, {7u, 8u}, {30u, 8u}, {30u, 60u}}) {
        const Character character = make_character(
            {.joint_count = 4, .seed = morph_count + 50, .cubic = true, .morph_count = morph_count});
        const Stage stage(character, limit);
        Random random(morph_count);
        std::vector<std::vector<MorphLayer>> instances;
        for (int i = 0; i < 120; ++i) {
            std::vector<MorphLayer>& layers = instances.emplace_back();
            for (uint32_t k = 1 + random.below(4); k > 0; --k) {
                MorphLayer& layer = layers.emplace_back(
                    MorphLayer{.is_additive = random.chance(0.4),
                               .weight = random.chance(0.3) ? 1 : as_float(random.unit()),
                               .active_clips = {}});
                double rest = 1;
                for (uint32_t v = 1 + random.below(4); v > 0; --v) {
                    const double weight = v == 1 ? rest : as_float(rest * random.unit());
                    layer.active_clips.push_back({random.below(static_cast<uint32_t>(character.clips.size() + 1)),
                                                  as_float(random.between(0, 3)), as_float(weight)});
                    rest -= weight;
                }
            }
        }
        for (const uint32_t active_clip_limit : {16u, 19u}) {
            const auto got = stage.run_layers(instances, active_clip_limit);
            for (size_t i = 0; i < instances.size(); ++i)
                worst = std::max(worst, compare(got[i], morphs_reference(character, instances[i])));
        }
    }
    EXPECT_LE(worst, kWeightBound);
    std::printf("  largest error of a weight %.1e\n", worst);
}

// Clip 0 animates all three weights, clip 1 none: by hand.
TEST(Morph, LayersEqualValuesByHand) {
    const Character character = compiled(
        small_asset({{.node = 0, .times_s = {0, 1}, .values = {0.2f, 0, 0.4f, 1, 1, 0.4f}}}));
    const auto weights = [&](const std::vector<MorphLayer>& layers) {
        const std::vector<double> wanted = morphs_reference(character, layers);
        const std::vector<io::ActiveMorph> got = Stage(character).run_layers({layers})[0];
        EXPECT_LE(compare(got, wanted), kWeightBound);
        return wanted;
    };
    const auto expect = [](const std::vector<double>& got, const std::vector<double>& wanted) {
        for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(got[i], wanted[i], 1e-6) << "morph " << i;
    };
    const MorphActiveClip at_half{.clip = 0, .time_s = 0.5}, still{.clip = 1, .time_s = 0.3}, rest{.clip = 2};
    expect(weights({{.active_clips = {rest}}}), {0, 0.5, 0});
    expect(weights({{.active_clips = {still}}}), {0, 0.5, 0});
    expect(weights({{.active_clips = {at_half}}}), {0.6, 0.5, 0.4});
    // Targets that a clip does not animate count with their default weight
    expect(weights({{.active_clips = {{0, 1, 0.25}, {1, 0, 0.75}}}}), {0.25, 0.625, 0.1});
    // A layer does not change targets that none of its active clips animates
    expect(weights({{.active_clips = {{0, 1, 1}}}, {.weight = 0.5, .active_clips = {still}}}), {1, 1, 0.4});
    expect(weights({{.active_clips = {{0, 1, 1}}}, {.weight = 0.5, .active_clips = {{0, 0, 1}}}}), {0.6, 0.5, 0.4});
    expect(weights({{.active_clips = {rest}}, {.is_additive = true, .weight = 0.5, .active_clips = {{0, 1, 1}}}}),
           {0.4, 1, 0});
    expect(weights({{.active_clips = {rest}}, {.is_additive = true, .active_clips = {still}}}), {0, 0.5, 0});
}

TEST(Morph, TheLargestWeightsAreShown) {
    constexpr uint32_t kLimit = 8;
    Asset asset = make_asset({.joint_count = 3, .vertex_count = 6});
    const std::vector<float> defaults{0.1f, -0.5f, 0.5f, 1e-6f, 0, 0.3f, -0.9f, 0.3f, 0.3f, 2, 0.3f, 0.3f, -0.3f};
    asset.meshes[0].weights = defaults;
    asset.meshes[0].primitives[0].targets.resize(defaults.size());
    asset.mesh_instances[1].node = 1;
    const Character character = compiled(asset);
    const auto expect = [&](const std::vector<float>& weights, const std::vector<uint32_t>& order) {
        Character changed = character;
        for (size_t i = 0; i < weights.size(); ++i) changed.morphs[i].default_weight = weights[i];
        const std::vector<io::ActiveMorph> got = Stage(changed, kLimit).run_two({Playback{}})[0];
        const std::vector<WeightedMorph> wanted = active_morphs_reference(
            std::vector<double>(weights.begin(), weights.end()), kLimit);
        ASSERT_EQ(wanted.size(), order.size());
        for (size_t i = 0; i < kLimit; ++i) {
            EXPECT_EQ(got[i].morph, i < order.size() ? order[i] : 0) << i;
            EXPECT_EQ(got[i].weight, i < order.size() ? weights[order[i]] : 0) << i;
            if (i < order.size()) {
                EXPECT_EQ(wanted[i].morph, order[i]);
            }
        }
    };
    expect(defaults, {9, 6, 1, 2, 5, 7, 8, 10});
    expect(std::vector<float>(13, -0.25f), {0, 1, 2, 3, 4, 5, 6, 7});
    expect(std::vector<float>(13, 1e-6f), {});
    expect({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2e-6f}, {12});
    expect({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}, {12, 11, 10, 9, 8, 7, 6, 5});
}

// ---- Crowds

double position_error(Crowd& crowd, uint32_t instance, std::span<const Vec3<double>> wanted, double size) {
    const Result<std::vector<Vec3<float>>> got = crowd.read_positions({instance});
    EXPECT_TRUE(got && got->size() == wanted.size());
    double worst = 0;
    for (size_t v = 0; got && v < wanted.size(); ++v)
        worst = worse_of(worst, length((*got)[v].as<double>() - wanted[v]) / size);
    return worst;
}

TEST(Morph, CrowdsWithTwoClipsShowMorphs) {
    double worst = 0, moved = 0;
    for (const UpdatePath path : {UpdatePath::kStaged, UpdatePath::kFused})
        for (const double error : {0.0, 1e-4}) {
            const Character character = compiled(
                                make_asset({.joint_count = 9, .seed = 4, .cubic = true, .morph_count = 6}),
                                {.error = error}),
                            plain = make_character({.joint_count = 6});
            Crowd crowd = create({.groups = {{&plain, 3}, {&character, 40}}, .path = path});
            EXPECT_FALSE(has_output(crowd.outputs()[0], &OutputBlock::morph));
            Character unmorphed = character;
            unmorphed.morphs.clear(), unmorphed.morph_tracks.clear(), unmorphed.morph_deltas.clear();
            unmorphed.morph_times_s.clear(), unmorphed.morph_values.clear();
            for (MeshSection& section : unmorphed.sections) section.first_morph = section.morph_count = 0;
            for (Vertex& vertex : unmorphed.vertices) vertex.first_delta = 0;
            for (Clip& clip : unmorphed.clips) clip.first_morph_time = clip.morph_row_count = clip.morph_row_stride = 0;
            const Crowd other = create({.groups = {{&plain, 3}, {&unmorphed, 40}}, .path = path});
            EXPECT_GE(crowd.size_bytes(), other.size_bytes() + 40 * character.morphs.size() * sizeof(io::ActiveMorph) +
                                              character.morph_deltas.size() * sizeof(MorphDelta))
                << "its memory is counted";
            ASSERT_TRUE(has_output(crowd.outputs()[1], &OutputBlock::morph));
            Random random(3);
            const std::vector<Playback> playbacks = random_playbacks(random, character, 40);
            ASSERT_TRUE(crowd.set_playback(Instances::numbered(3, 40), playbacks));
            ASSERT_TRUE(crowd.update(0.2f));
            const uint32_t shown = crowd.outputs()[1].morph_count;
            EXPECT_EQ(shown, character.morphs.size());
            const auto active = output<io::ActiveMorph>(crowd.outputs()[1], &OutputBlock::morph, 40 * shown);
            for (uint32_t i = 0; i < 40; ++i) {
                const ReferencePose pose = *reference_pose(character, advanced(playbacks[i], character, 0.2f));
                ASSERT_EQ(pose.morph_weights.size(), 12u);
                const auto first = active.begin() + i * shown;
                EXPECT_LE(compare({first, first + shown}, pose.morph_weights), kWeightBound) << "instance " << i;
                worst = std::max(worst,
                                 position_error(crowd, 3 + i, reference_positions(character, pose), character.size));
                moved = std::max(moved, position_error(crowd, 3 + i, skin_reference(character, pose.model_from_bind),
                                                       character.size));
            }
            ASSERT_TRUE(crowd.stage_times());
        }
    EXPECT_LE(worst, kPoseBound);
    EXPECT_GT(moved, 0.01) << "morphs move vertices";
    std::printf("  largest error of a position %.1e of the size; morphs move by %.2f\n", worst, moved);
}

// A face uses dozens of targets at once. With a limit, a crowd shows those with the largest weights.
TEST(Morph, CrowdsShowAllMorphsOrUpToTheirLimit) {
    const Character character = compiled(make_asset({.joint_count = 9, .seed = 4, .cubic = true, .morph_count = 25}));
    ASSERT_EQ(character.morphs.size(), 50u);
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged, UpdatePath::kFused})
        for (const uint32_t limit : {0u, 3u, 49u, 50u, 1000u}) {
            Crowd crowd = create(
                {.groups = {{.character = &character, .instance_count = 20, .morph_limit = limit}}, .path = path});
            EXPECT_EQ(crowd.outputs()[0].morph_count, limit == 0 ? 50 : std::min(limit, 50u));
            Random random(3);
            const std::vector<Playback> playbacks = random_playbacks(random, character, 20);
            ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks) && crowd.update(0.2f));
            double worst = 0, without_limit = 0;
            for (uint32_t i = 0; i < 20; ++i) {
                const ReferencePose pose = *reference_pose(character, advanced(playbacks[i], character, 0.2f));
                const auto shown = active_morphs_reference(pose.morph_weights, limit == 0 ? SIZE_MAX : limit);
                worst = std::max(worst, position_error(crowd, i, skin_reference(character, pose.model_from_bind, shown),
                                                       character.size));
                without_limit = std::max(
                    without_limit, position_error(crowd, i, reference_positions(character, pose), character.size));
            }
            EXPECT_LE(worst, kPoseBound) << "limit " << limit;
            EXPECT_EQ(without_limit > 1e-3, limit > 0 && limit < 50) << without_limit << ", limit " << limit;
        }
}

TEST(Morph, BatchesChangeNothing) {
    constexpr uint32_t kInstances = 10;
    const Character character = compiled(make_asset({.joint_count = 9, .seed = 4, .morph_count = 6}));
    const CrowdSettings settings{.groups = {{&character, kInstances}}, .path = UpdatePath::kStaged};
    Crowd whole = create(settings);
    Result<Crowd> parts = Crowd::create(device_of_workgroups(3), settings);
    ASSERT_TRUE(parts) << parts.error().text();
    EXPECT_EQ(parts->outputs().size(), 4u);
    Random random(8);
    const std::vector<Playback> playbacks = random_playbacks(random, character, kInstances);
    for (Crowd* crowd : {&whole, &*parts})
        ASSERT_TRUE(crowd->set_playback(crowd->instances(), playbacks) && crowd->update(0.1f));
    for (uint32_t i = 0; i < kInstances; ++i) EXPECT_EQ(*whole.read_positions({i}), *parts->read_positions({i})) << i;
}

TEST(Morph, CrowdsWithAControllerShowMorphs) {
    double worst = 0;
    for (const UpdatePath path : {UpdatePath::kStaged, UpdatePath::kFused}) {
        const Character character = compiled(make_asset({.joint_count = 9, .seed = 6, .morph_count = 6}),
                                             {.error = 1e-4});
        Controller controller;
        controller.layers = {{.name = "body"}, {.name = "face"}, {.name = "talk", .mode = LayerMode::kAdditive}};
        constexpr uint32_t kInstances = 30;
        Crowd crowd = create(
            {.groups = {{.character = &character, .instance_count = kInstances, .controller = &controller}},
             .path = path});
        std::vector<ReferenceCharacter> wanted = references(character, controller, kInstances);
        Random random(9);
        for (int update = 0; update < 12; ++update) {
            for (uint32_t i = 0; i < kInstances; ++i)
                for (uint32_t layer = 0; layer < 3; ++layer) {
                    if (!random.chance(0.4)) continue;
                    const LayerPlayback playback{
                        .clip = random_slot(random, character),
                        .fade_s = random.chance(0.3) ? 0 : static_cast<float>(random.between(0, 0.5))};
                    const LayerBlend blend{.weight = static_cast<float>(random.unit()),
                                           .fade_s = playback.fade_s,
                                           .mode = layer == 2 ? LayerMode::kAdditive : LayerMode::kOverride};
                    ASSERT_TRUE(crowd.play(InstanceHandle{i}, layer, playback) &&
                                crowd.set_layer(InstanceHandle{i}, layer, blend));
                    ASSERT_TRUE(wanted[i].play(layer, playback) && wanted[i].set_layer(layer, blend));
                }
            ASSERT_TRUE(crowd.update(0.07f));
            for (ReferenceCharacter& one : wanted) ASSERT_TRUE(one.update(0.07f));
            const uint32_t shown = crowd.outputs()[0].morph_count;
            const auto active = output<io::ActiveMorph>(crowd.outputs()[0], &OutputBlock::morph, kInstances * shown);
            for (uint32_t i = 0; i < kInstances; ++i) {
                const auto first = active.begin() + i * shown;
                EXPECT_LE(compare({first, first + shown}, wanted[i].pose().morph_weights), kWeightBound)
                    << "instance " << i << ", update " << update;
            }
        }
        // Skinned with the crowd's own matrices; how those follow the reference is tested elsewhere.
        for (uint32_t i = 0; i < kInstances; ++i) {
            std::vector<AffineT<double>> matrices;
            const std::vector<Affine> read = *crowd.read_skin_matrices({i});
            for (const Affine& matrix : read) matrices.push_back(matrix.as<double>());
            worst = std::max(
                worst, position_error(
                           crowd, i,
                           skin_reference(character, matrices, active_morphs_reference(wanted[i].pose().morph_weights)),
                           character.size));
        }
    }
    EXPECT_LE(worst, kPoseBound);
    std::printf("  largest error of a position %.1e of the size\n", worst);
}

// A clip that moves no joint has one row of keys. Its weights are still animated.
TEST(Morph, AClipWithOnlyMorphWeightsIsPlayed) {
    Asset asset = small_asset({{.node = 0, .times_s = {0, 1}, .values = {0, 0, 0, 1, 0, 0}}});
    asset.clips[0].tracks.clear();
    const Character character = compiled(asset, {.error = 1e-4});
    Controller controller;
    controller.layers = {{.name = "body"}};
    Crowd crowd = create(
        {.groups = {{&character, 1}, {.character = &character, .instance_count = 1, .controller = &controller}}});
    ASSERT_TRUE(crowd.set_playback(InstanceHandle{0}, Playback{.first = {.clip = 0}}));
    ASSERT_TRUE(crowd.play(InstanceHandle{1}, 0, {.clip = {.clip = 0}}));
    for (int update = 1; update <= 3; ++update) {
        ASSERT_TRUE(crowd.update(0.25f));
        for (const OutputBlock& block : crowd.outputs()) {
            const auto active = output<io::ActiveMorph>(block, &OutputBlock::morph, block.morph_count);
            EXPECT_EQ(active[0].morph, 0u);
            EXPECT_NEAR(active[0].weight, 0.25 * update, 1e-6);
        }
    }
}

// A real character against its file: weights, differences and skinning implemented a second time. Its clips keep all
// weights at 0, so the test sets some.
TEST(Morph, ARealCharacterMatchesItsFile) {
    const std::filesystem::path file = shared_folder("characters") / "robot_expressive/RobotExpressive.glb";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing";
    Asset asset = *load_asset(file);
    const Character as_it_is = compiled(asset);
    EXPECT_EQ(as_it_is.morphs.size(), 9u);
    EXPECT_EQ(as_it_is.morphs[4].name, "Surprised");
    EXPECT_TRUE(as_it_is.morph_times_s.empty()) << "constants have no rows";
    Random random(2);
    for (AssetClip& clip : asset.clips) {
        EXPECT_EQ(clip.morph_tracks.size(), 3u);
        for (AssetMorphTrack& track : clip.morph_tracks)
            for (float& value : track.values) value = static_cast<float>(random.unit());
    }
    const Character character = compiled(asset, {.error = 0, .lods = false});
    Crowd staged = create({.groups = {{&character, 1}}, .path = UpdatePath::kStaged}),
          fused = create({.groups = {{&character, 1}}});
    double worst = 0, moved = 0;
    for (uint32_t clip = 0; clip < asset.clips.size(); ++clip)
        for (const float part : {0.0f, 0.3f, 0.55f, 0.9f}) {
            const Playback playback{
                .first = {.clip = clip, .time_s = part * asset.clips[clip].duration_s, .speed = 0, .loop = false}};
            const ReferencePose pose = *reference_pose(character, playback);
            std::vector<Vec3<double>> wanted(character.vertices.size());
            for (const MeshSection& section : character.sections) {
                const AssetMesh& mesh = asset.meshes[section.mesh];
                const AssetPrimitive& primitive = mesh.primitives[section.primitive];
                const AssetMorphTrack* track = track_of(asset.clips[clip], section.node);
                for (uint32_t v = 0; v < section.vertex_count; ++v) {
                    Vec3<double> position = primitive.positions[v].as<double>();
                    for (size_t t = 0; t < primitive.targets.size(); ++t) {
                        const double weight = track ? weight_of_track(*track, mesh.weights.size(), t,
                                                                      playback.first.time_s)
                                                    : double{mesh.weights[t]};
                        if (!primitive.targets[t].positions.empty())
                            position = position + primitive.targets[t].positions[v].as<double>() * weight;
                    }
                    Vec3<double>& sum = wanted[section.first_vertex + v];
                    for (uint32_t i = 0; i < section.influence_sets * 4; ++i) {
                        const Influences& influences =
                            character.influences[section.first_influences + v * section.influence_sets + i / 4];
                        sum = sum + transform_point(pose.model_from_bind[influences.entries[i % 4]], position) *
                                        double{influences.weights[i % 4]};
                    }
                }
            }
            for (Crowd* crowd : {&staged, &fused}) {
                ASSERT_TRUE(crowd->set_playback(InstanceHandle{0}, playback) && crowd->update(0));
                worst = std::max(worst, position_error(*crowd, 0, wanted, character.size));
                moved = std::max(
                    moved, position_error(*crowd, 0, skin_reference(character, pose.model_from_bind), character.size));
            }
        }
    EXPECT_LE(worst, kPoseBound);
    EXPECT_GT(moved, 1e-3);
    std::printf("  largest error of a position %.1e of the size; morphs move by %.3f\n", worst, moved);
}

}  // namespace
}  // namespace throng
