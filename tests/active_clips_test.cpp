// Poses made of layers of active clips, against the reference.
#include "blend/blend_reference.h"
#include "blend/layered.h"
#include "blend/active_clips_reference.h"
#include "control/control_reference.h"
#include "sample/sample_reference.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace throng {
namespace {

// Under GPU-assisted validation the excluded test takes too long.
const test::InSubset kActiveClipsInSubsets({test::Subset::kGpuAssisted},
                                           {"ActiveClips.*", "-ActiveClips.FollowTheReference"});
const test::InSubset kActiveClipsNatively({test::Subset::kNative}, {"ActiveClips.*"});

using namespace test;

// Of an element, relative where it exceeds 1. Tests multiply it by amplification() of their inputs' errors.
constexpr double kActiveClipsBound = 2e-6;

// A clip at one time.
struct ClipPart {
    uint32_t clip = 0;
    double time_s = 0;
    float weight = 1;
};

struct Layer {
    bool is_additive = false;
    float weight = 1;
    uint32_t mask = kNone;
    std::vector<ClipPart> parts;
};

using Layers = std::vector<Layer>;

// The cursor's fraction is a float, so the reference samples at the time that the rounded fraction gives.
double rounded_time(const Character& character, const ClipPart& part, const RowCursor& rows) {
    const float* times_s = &character.times_s[character.clips[part.clip].first_time];
    return times_s[rows.earlier] +
           (double{times_s[rows.later]} - times_s[rows.earlier]) * static_cast<float>(rows.fraction);
}

struct Rows {
    io::ActiveClip active_clip{};
    double time_s = 0, first_s = 0;
};

Rows rows_of(const Character& character, const ClipPart& part) {
    Rows out{.active_clip = {.first_track = part.clip * character.rig.joint_count(),
                             .earlier = 0,
                             .later = 0,
                             .fraction = 0,
                             .weight = part.weight,
                             .layer_weight = 1,
                             .reference_row = 0,
                             .flags = 0}};
    if (part.clip == character.clips.size()) return out;
    const Clip& clip = character.clips[part.clip];
    const RowCursor rows = find_rows_reference(std::span(character.times_s).subspan(clip.first_time, clip.row_count),
                                               part.time_s);
    out.active_clip.earlier = clip.first_row + rows.earlier * clip.row_stride;
    out.active_clip.later = clip.first_row + rows.later * clip.row_stride;
    out.active_clip.fraction = static_cast<float>(rows.fraction);
    out.active_clip.reference_row = clip.first_row;
    out.time_s = rounded_time(character, part, rows);
    out.first_s = character.times_s[clip.first_time];
    return out;
}

std::vector<io::ActiveClip> active_clips_of(const Character& character, const Layers& layers) {
    std::vector<io::ActiveClip> out;
    for (const Layer& layer : layers) {
        for (size_t i = 0; i < layer.parts.size(); ++i) {
            io::ActiveClip active_clip = rows_of(character, layer.parts[i]).active_clip;
            active_clip.layer_weight = layer.weight;
            if (i == 0) active_clip.flags |= io::kActiveClipBeginsLayer;
            if (i + 1 == layer.parts.size()) active_clip.flags |= io::kActiveClipEndsLayer;
            if (layer.is_additive) active_clip.flags |= io::kActiveClipAdditive;
            if (layer.mask != kNone)
                active_clip.flags |= io::kActiveClipMasked | layer.mask << io::kActiveClipMaskShift;
            out.push_back(active_clip);
        }
    }
    out.back().flags |= io::kActiveClipEnds;
    return out;
}

// A character and its masks, on the device and in the reference.
class ActiveClipsRun {
public:
    explicit ActiveClipsRun(Character character, std::vector<float> masks = {})
        : character_(std::move(character)),
          masks_(std::move(masks)),
          tracks_(character_.tracks),
          keys_(character_.keys),
          words_(character_.words),
          mask_buffer_(masks_) {}

    const Character& character() const { return character_; }
    uint32_t joint_count() const { return character_.rig.joint_count(); }

    // The entries behind an instance's active clips hold other clips, which would change its pose if they were read.
    std::vector<io::ActiveClip> active_clips(const std::vector<Layers>& instances, uint32_t active_clip_limit) const {
        io::ActiveClip other = rows_of(character_, {.clip = 0, .time_s = 0.9}).active_clip;
        other.flags = io::kActiveClipBeginsLayer | io::kActiveClipEndsLayer;
        std::vector<io::ActiveClip> out(instances.size() * active_clip_limit, other);
        for (size_t i = 0; i < instances.size(); ++i)
            std::ranges::copy(active_clips_of(character_, instances[i]),
                              out.begin() + static_cast<ptrdiff_t>(i * active_clip_limit));
        return out;
    }

    template <class Local = Affine>
    std::vector<Local> run(const std::vector<io::ActiveClip>& active_clips, uint32_t active_clip_limit) const {
        const Guarded<io::ActiveClip> active_clip_buffer(active_clips);
        std::vector<Local> local = run<Local>(BufferRange(active_clip_buffer), active_clips.size() / active_clip_limit,
                                              active_clip_limit);
        EXPECT_TRUE(same_bits(active_clip_buffer.read(), active_clips)) << "the stage wrote its input";
        return local;
    }
    template <class Local = Affine>
    std::vector<Local> run(const BufferRange& active_clips, size_t count, uint32_t active_clip_limit) const {
        constexpr BlendOutput kOutput = sizeof(Local) == sizeof(Affine) ? BlendOutput::kAffine
                                                                        : BlendOutput::kSimilarity;
        const Guarded<Local> local(poison<Local>(count * joint_count()));
        run_workgroups(layered_kernel(test_gpu(), {.packed = character_.packed, .output = kOutput}),
                       BufferTable{{io::kActiveClipsBuffer, active_clips},
                                   {io::kMasksBuffer, mask_buffer_},
                                   {io::kTracksBuffer, tracks_},
                                   {io::kKeysBuffer, keys_},
                                   {io::kWordsBuffer, words_},
                                   {io::kLocalBuffer, local},
                                   {io::kInertiasBuffer, local},
                                   {io::kInertiaStatesBuffer, local},
                                   {io::kPoseOverridesBuffer, words_},
                                   {io::kSetPosesBuffer, keys_},
                                   {io::kBirthsBuffer, words_}},
                       io::LayeredPush{joint_count(), active_clip_limit}, static_cast<uint32_t>(count));
        return local.read();
    }
    std::vector<Affine> run(const std::vector<Layers>& instances, uint32_t active_clip_limit = 12) const {
        return run(active_clips(instances, active_clip_limit), active_clip_limit);
    }

    // The reference's input, for each joint.
    std::vector<std::vector<ReferenceLayer>> reference_layers(const Layers& layers) const {
        std::vector<std::vector<ReferenceLayer>> out(joint_count());
        for (const Layer& layer : layers) {
            for (uint32_t joint = 0; joint < joint_count(); ++joint)
                out[joint].push_back({layer.is_additive,
                                      layer.mask == kNone
                                          ? layer.weight
                                          : double{layer.weight} * masks_[layer.mask * joint_count() + joint],
                                      {}});
            for (const ClipPart& part : layer.parts) {
                const Rows rows = rows_of(character_, part);
                const std::vector<Trs<double>> pose = sample_reference(character_, part.clip, rows.time_s),
                                               first = sample_reference(character_, part.clip, rows.first_s);
                for (uint32_t joint = 0; joint < joint_count(); ++joint)
                    out[joint].back().active_clips.push_back({pose[joint], first[joint], part.weight});
            }
        }
        return out;
    }

private:
    Character character_;
    std::vector<float> masks_;
    Guarded<JointTracks> tracks_;
    Guarded<std::array<float, 4>> keys_;
    Guarded<uint32_t> words_;
    Guarded<float> mask_buffer_;
};

// Two masks: one with zeros, ones and a ramp between them; one of ones only.
std::vector<float> make_masks(uint32_t joint_count) {
    std::vector<float> out;
    for (uint32_t joint = 0; joint < joint_count; ++joint)
        out.push_back(std::clamp(3 * static_cast<float>(joint) / static_cast<float>(joint_count) - 1, 0.0f, 1.0f));
    out.resize(2 * joint_count, 1.0f);
    return out;
}

Layers random_layers(Random& random, const Character& character, uint32_t active_clip_count) {
    Layers out;
    const uint32_t layer_count = 1 + random.below(std::min(active_clip_count, 4u));
    for (uint32_t i = 0; i < layer_count; ++i) {
        const bool is_lowest = i == 0;
        Layer layer{.is_additive = !is_lowest && random.chance(0.5),
                    .weight = random.chance(0.3) ? 1.0f : static_cast<float>(random.unit()),
                    .mask = is_lowest ? kNone : std::array{kNone, 0u, 1u}[random.below(3)],
                    .parts = {}};
        const uint32_t rest = layer_count - 1 - i,
                       part_count = rest == 0 ? active_clip_count : 1 + random.below(active_clip_count - rest);
        active_clip_count -= part_count;
        double sum = 0;
        for (uint32_t k = 0; k < part_count; ++k) {
            const uint32_t clip = random.below(static_cast<uint32_t>(character.clips.size() + 1));
            const double duration_s = clip < character.clips.size() ? character.clips[clip].duration_s : 0;
            layer.parts.push_back({clip, random.between(0, duration_s), static_cast<float>(random.between(0.05, 1))});
            sum += layer.parts.back().weight;
        }
        for (ClipPart& part : layer.parts) part.weight = static_cast<float>(part.weight / sum);
        out.push_back(layer);
    }
    return out;
}

double error_of(const Affine& got, const Trs<double>& wanted) {
    return matrix_error(got, to_affine(wanted), std::max(1.0, length(wanted.translation)));
}

// By what factor errors of the inputs grow in the result. It is large where rotations nearly cancel, or lie a quarter
// turn apart on S3, where rounding decides which way round is shorter.
double amplification(const std::vector<ReferenceLayer>& layers, const Trs<double>& result, Random& random) {
    constexpr double kError = 1e-5;
    const auto about = [&](double x) { return x + random.between(-kError, kError); };
    const auto moved = [&](const Trs<double>& t) {
        return Trs<double>{{about(t.rotation.x), about(t.rotation.y), about(t.rotation.z), about(t.rotation.w)},
                           {about(t.translation.x), about(t.translation.y), about(t.translation.z)},
                           {about(t.scale.x), about(t.scale.y), about(t.scale.z)}};
    };
    double worst = 1;
    for (int draw = 0; draw < 4; ++draw) {
        std::vector<ReferenceLayer> others = layers;
        for (ReferenceLayer& layer : others)
            for (ReferenceActiveClip& active_clip : layer.active_clips)
                active_clip.pose = moved(active_clip.pose), active_clip.first = moved(active_clip.first);
        worst = std::max(worst, error_of(to_affine(active_clips_reference(others)).as<float>(), result) / kError);
    }
    return worst;
}

void expect_reference_clips(Character character) {
    std::vector<float> masks = make_masks(character.rig.joint_count());
    const ActiveClipsRun stage(std::move(character), std::move(masks));
    Random random(stage.joint_count());
    std::vector<Layers> instances;
    for (uint32_t active_clip_count = 1; active_clip_count <= 10; ++active_clip_count)
        for (int i = 0; i < 4; ++i) instances.push_back(random_layers(random, stage.character(), active_clip_count));
    const std::vector<Affine> local = stage.run(instances, 11);
    double worst = 0;
    size_t undecided = 0;
    for (size_t i = 0; i < instances.size(); ++i) {
        const std::vector<std::vector<ReferenceLayer>> layers = stage.reference_layers(instances[i]);
        for (size_t joint = 0; joint < stage.joint_count(); ++joint) {
            const Trs<double> wanted = active_clips_reference(layers[joint]);
            const double factor = amplification(layers[joint], wanted, random);
            if (factor > 100) {
                ++undecided;
                continue;
            }
            const double error = error_of(local[i * stage.joint_count() + joint], wanted) / factor;
            EXPECT_LE(error, kActiveClipsBound)
                << "instance " << i << ", joint " << joint << ", amplified " << factor << " times";
            worst = std::max(worst, error);
        }
    }
    EXPECT_LE(undecided, local.size() / 50 + 1);
    std::printf("  %3u joints, %s keys, %zu instances: largest error %.1e, %zu of %zu left out\n", stage.joint_count(),
                stage.character().packed ? "packed" : "exact", instances.size(), worst, undecided, local.size());
}

TEST(ActiveClips, FollowTheReference) {
    for (const uint32_t joint_count : {1u, 63u, 65u, 300u}) {
        const AssetSettings settings{
            .joint_count = joint_count, .seed = joint_count, .clip_count = 4, .cubic = joint_count == 65};
        expect_reference_clips(make_character(settings));
        const Character packed = compiled(make_asset(settings), {.error = 1e-4});
        ASSERT_TRUE(packed.packed);
        expect_reference_clips(packed);
    }
}

TEST(ActiveClips, GiveSimilaritiesForUniformScale) {
    const ActiveClipsRun stage(make_character({.joint_count = 70, .scale_spread = 0}), make_masks(70));
    Random random(7);
    std::vector<Layers> instances;
    for (int i = 0; i < 20; ++i) instances.push_back(random_layers(random, stage.character(), 6));
    const std::vector<io::ActiveClip> active_clips = stage.active_clips(instances, 6);
    const std::vector<Affine> affines = stage.run(active_clips, 6);
    struct Similarity {
        io::vec4 rotation, translation_scale;
    };
    const std::vector<Similarity> similarities = stage.run<Similarity>(active_clips, 6);
    for (size_t i = 0; i < affines.size(); ++i) {
        const auto& [q, t] = similarities[i];
        EXPECT_LE(matrix_error(to_affine(Trs<float>{{q.x, q.y, q.z, q.w}, {t.x, t.y, t.z}, {t.w, t.w, t.w}}),
                               affines[i].as<double>(), 1),
                  kActiveClipsBound);
    }
}

// Two clips in one layer that fade into each other give the blend stage's result.
TEST(ActiveClips, TwoInOneLayerAreABlend) {
    const ActiveClipsRun stage(make_character({.joint_count = 70}));
    for (const float weight : {0.25f, 0.5f, 0.9f}) {
        const Layers layers{{.parts = {{0, 0.4, weight}, {1, 1.3, 1 - weight}}}};
        const std::vector<Affine> local = stage.run({layers});
        const std::vector<std::vector<ReferenceLayer>> references = stage.reference_layers(layers);
        for (size_t joint = 0; joint < stage.joint_count(); ++joint) {
            const std::vector<ReferenceActiveClip>& active_clips = references[joint][0].active_clips;
            const Trs<double> wanted = blend_reference(active_clips[0].pose, active_clips[1].pose, weight),
                              got = active_clips_reference(references[joint]);
            EXPECT_LE(error_of(to_affine(got).as<float>(), wanted), 1e-7);  // float's rounding
            EXPECT_LE(error_of(local[joint], wanted), kActiveClipsBound);
        }
    }
}

// A layer with weight 0 at a joint leaves the pose below unchanged to the bit; one with weight 1 replaces it exactly.
TEST(ActiveClips, LayerWeightsZeroAndOneAreExact) {
    const ActiveClipsRun stage(make_character({.joint_count = 65, .clip_count = 4}), make_masks(65));
    const Layer base{.parts = {{0, 0.3, 0.5f}, {1, 0.2, 0.5f}}}, wave{.parts = {{2, 0.7, 0.25f}, {3, 0.1, 0.75f}}};
    const auto with = [](Layer layer, bool is_additive, float weight, uint32_t mask) {
        layer.is_additive = is_additive;
        layer.weight = weight;
        layer.mask = mask;
        return layer;
    };
    const std::vector<Layers> instances{{base},
                                        {base, with(wave, false, 0, kNone)},
                                        {base, with(wave, true, 0, kNone)},
                                        {base, with(wave, false, 1, 0)},
                                        {base, with(wave, true, 1, 0)},
                                        {wave},
                                        {base, wave},
                                        {base, with(wave, false, 1, 1)},
                                        {with(wave, false, 0.5f, kNone)},
                                        {base, with(wave, true, 0, kNone), wave}};
    const std::vector<Affine> local = stage.run(instances);
    const auto of = [&](size_t instance, size_t first, size_t end) {
        const auto begin = local.begin() + static_cast<ptrdiff_t>(instance * 65);
        return std::vector<Affine>(begin + static_cast<ptrdiff_t>(first), begin + static_cast<ptrdiff_t>(end));
    };
    const auto whole = [&](size_t instance) { return of(instance, 0, 65); };
    EXPECT_TRUE(same_bits(whole(1), whole(0))) << "override of weight 0";
    EXPECT_TRUE(same_bits(whole(2), whole(0))) << "additive of weight 0";
    EXPECT_TRUE(same_bits(of(3, 0, 22), of(0, 0, 22)) && same_bits(of(4, 0, 22), of(0, 0, 22)))
        << "where the mask is 0";
    EXPECT_TRUE(same_bits(of(3, 44, 65), of(5, 44, 65))) << "where the mask is 1";
    EXPECT_FALSE(same_bits(of(3, 22, 23), of(0, 22, 23)) || same_bits(of(3, 43, 44), of(5, 43, 44)))
        << "the ramp is open at both ends";
    EXPECT_FALSE(same_bits(of(4, 44, 65), of(0, 44, 65))) << "the additive layer does something";
    EXPECT_TRUE(same_bits(whole(6), whole(5))) << "override of weight 1";
    EXPECT_TRUE(same_bits(whole(7), whole(5))) << "mask of ones";
    EXPECT_TRUE(same_bits(whole(8), whole(5))) << "the lowest layer covers, whatever its weight";
    EXPECT_TRUE(same_bits(whole(9), whole(5))) << "three layers";
}

// A clip's difference from its first row is zero in that row, up to rounding.
TEST(ActiveClips, AnAdditiveFirstRowAddsNothing) {
    const ActiveClipsRun stage(make_character({.joint_count = 65, .clip_count = 4}));
    const Layer base{.parts = {{0, 0.3}}};
    const std::vector<Affine> local = stage.run({{base},
                                                 {base, {.is_additive = true, .parts = {{1, 0, 0.5f}, {2, 0, 0.5f}}}},
                                                 {base, {.is_additive = true, .parts = {{4}}}}});
    for (size_t joint = 0; joint < 65; ++joint) {
        EXPECT_LE(matrix_error(local[65 + joint], local[joint].as<double>(), 1), 1e-6) << "joint " << joint;
        EXPECT_LE(matrix_error(local[130 + joint], local[joint].as<double>(), 1), 1e-6)
            << "the rest pose adds nothing to joint " << joint;
    }
}

// Clips of two rows, from the first pose to the second; one joint.
Character two_row_clips(const std::vector<std::array<Trs<float>, 2>>& clips) {
    Character character;
    character.rig.parents = {kNone};
    for (const auto& [first, last] : clips) {
        const auto position = static_cast<uint32_t>(character.keys.size());
        character.clips.push_back({.duration_s = 1,
                                   .first_time = static_cast<uint32_t>(character.times_s.size()),
                                   .row_count = 2,
                                   .row_stride = 3});
        character.times_s.insert(character.times_s.end(), {0, 1});
        for (const Trs<float>& t : {first, last})
            character.keys.insert(character.keys.end(), {{t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w},
                                                         {t.translation.x, t.translation.y, t.translation.z, 0},
                                                         {t.scale.x, t.scale.y, t.scale.z, 0}});
        character.tracks.push_back({.rotation = position | kTrackAnimated,
                                    .translation = (position + 1) | kTrackAnimated,
                                    .scale = (position + 2) | kTrackAnimated});
    }
    return character;
}

// Two half turns in opposite directions, weighted by half each, sum to a zero quaternion: the last rotation wins.
TEST(ActiveClips, CancellingRotationsUseTheLastOne) {
    const Trs<float> still{}, half{.rotation = {1, 0, 0, 0}, .translation = {1, 0, 0}},
        other_half{.rotation = {-1, 0, 0, 0}, .translation = {3, 0, 0}};
    const ActiveClipsRun stage(two_row_clips({{still, half}, {still, other_half}, {still, still}}));
    const Layer base{.parts = {{2, 0}}};
    const std::vector<ClipPart> both{{0, 1, 0.5f}, {1, 1, 0.5f}};
    const std::vector<Layers> instances{{base, {.is_additive = true, .parts = both}},
                                        {base, {.is_additive = true, .weight = 0.5f, .parts = both}},
                                        {{.parts = both}}};
    const std::vector<Affine> local = stage.run(instances);
    // About x. For an override, both are the same half turn
    const std::array<double, 3> angles_rad{std::numbers::pi, -std::numbers::pi / 2, std::numbers::pi};
    for (size_t i = 0; i < instances.size(); ++i) {
        const Trs<double> wanted{.rotation = axis_angle(Vec3<double>{1, 0, 0}, angles_rad[i]),
                                 .translation = {i == 1 ? 1.0 : 2.0, 0, 0}};
        EXPECT_LE(error_of(local[i], wanted), kActiveClipsBound) << "instance " << i;
        EXPECT_LE(
            error_of(to_affine(active_clips_reference(stage.reference_layers(instances[i])[0])).as<float>(), wanted),
            1e-7)
            << "the reference, instance " << i;
    }
}

// A scale that starts at zero has no ratio, so it is left unchanged.
TEST(ActiveClips, AdditiveScalesFromZeroAddNothing) {
    const ActiveClipsRun stage(two_row_clips(
        {{Trs<float>{.scale = {1, 2, 4}}, {}}, {Trs<float>{.scale = {0, 1, 2}}, Trs<float>{.scale = {5, 3, 1}}}}));
    const std::vector<Affine> local = stage.run({{{.parts = {{0, 0}}}, {.is_additive = true, .parts = {{1, 1}}}}});
    EXPECT_LE(error_of(local[0], {.rotation = {}, .translation = {}, .scale = {1, 6, 2}}), kActiveClipsBound);
}

// The reference against numbers worked out by hand.
TEST(ActiveClips, TheReferenceAddsInParentSpace) {
    const auto about_z = [](double angle_rad) { return axis_angle(Vec3<double>{0, 0, 1}, angle_rad); };
    const ReferenceActiveClip base{.pose = {about_z(0.3), {1, 0, 0}, {1, 2, 1}}, .first = {}};
    const ReferenceActiveClip lean{.pose = {-about_z(0.9), {0, 5, 0}, {2, 2, 3}},
                                   .first = {about_z(0.5), {0, 3, 0}, {1, 4, 3}}};
    const Trs<double> half = active_clips_reference(std::vector<ReferenceLayer>{
        {.active_clips = {base}}, {.is_additive = true, .weight = 0.5, .active_clips = {lean}}});
    EXPECT_NEAR(std::abs(dot(half.rotation, about_z(0.5))), 1, 1e-12);
    EXPECT_LE(length(half.translation - Vec3<double>{1, 1, 0}) + length(half.scale - Vec3<double>{1.5, 1.5, 1}), 1e-12);

    // The difference is multiplied from the left: the pose below applies first.
    const Quaternion<double> x = axis_angle(Vec3<double>{1, 0, 0}, 1.0);
    const Trs<double> turned = active_clips_reference(std::vector<ReferenceLayer>{
        {.active_clips = {{.pose = {x, {}, {1, 1, 1}}, .first = {}}}}, {.is_additive = true, .active_clips = {lean}}});
    EXPECT_NEAR(std::abs(dot(turned.rotation, about_z(0.4) * x)), 1, 1e-12);
}

// A list that fills all its slots ends there, even without the flag that marks the end.
TEST(ActiveClips, AFullListNeedsNoEndFlag) {
    const ActiveClipsRun stage(make_character({.joint_count = 65}));
    std::vector<Layers> instances;
    for (const double time_s : {0.1, 0.3, 0.5})
        instances.push_back({{.parts = {{0, time_s, 0.5f}, {1, 0.4, 0.5f}}}, {.weight = 0.5f, .parts = {{2, time_s}}}});
    std::vector<io::ActiveClip> active_clips = stage.active_clips(instances, 3);
    const std::vector<Affine> wanted = stage.run(active_clips, 3);
    for (io::ActiveClip& active_clip : active_clips) active_clip.flags &= ~io::kActiveClipEnds;
    EXPECT_TRUE(same_bits(stage.run(active_clips, 3), wanted));
    EXPECT_TRUE(same_bits(stage.run(instances, 9), wanted)) << "room to spare";
}

TEST(ActiveClips, CanBeReadFromATableWrittenByTheDevice) {
    const ActiveClipsRun stage(make_character({.joint_count = 65}), make_masks(65));
    Random random(5);
    const std::vector<io::ActiveClip> active_clips = stage.active_clips(
        {random_layers(random, stage.character(), 5), random_layers(random, stage.character(), 8)}, 8);
    const Buffer table = make_table<io::ActiveClip>(test_gpu(), "active clips", active_clips.size());
    test_gpu()->submit_and_wait(
        [&](VkCommandBuffer commands) { record_update(*test_gpu(), commands, table, 0, std::span(active_clips)); });
    EXPECT_TRUE(same_bits(stage.run(BufferRange(table), 2, 8), stage.run(active_clips, 8)));
}

}  // namespace
}  // namespace throng
