// Morphs and skinned vertices as devices without Vulkan compute them, against the references.
#include "bind/bind_io.h"
#include "control/control_io.h"
#include "control/controller_io.h"
#include "cull/cull_io.h"
#include "gpu/glsl.h"
#include "morph/morph.h"
#include "morph/morph.kernel.h"
#include "morph/morph_reference.h"
#include "skin/skin.h"
#include "skin/skin.kernel.h"
#include "skin/skin_reference.h"
#include "tests/host/native_runner.h"
#include "tests/test_rig.h"

#include <throng/draw.h>

#include <array>
#include <bit>
#include <cmath>
#include <map>

namespace throng {
namespace {

using namespace test;

constexpr uint32_t kMorphs = 7;

void expect_morphs(std::span<const io::ActiveMorph> got, const std::vector<double>& wanted) {
    std::map<uint32_t, float> weights;
    for (const io::ActiveMorph& morph : got)
        if (morph.weight != 0) weights[morph.morph] = morph.weight;
    for (uint32_t morph = 0; morph < wanted.size(); ++morph)
        ASSERT_NEAR(weights.contains(morph) ? weights[morph] : 0, wanted[morph], 1e-5) << "morph " << morph;
    for (size_t i = 1; i < got.size() && got.size() < wanted.size(); ++i)
        EXPECT_LE(std::abs(got[i].weight), std::abs(got[i - 1].weight));
}

TEST(NativeMesh, MorphFollowsTheReference) {
    constexpr uint32_t kInstances = 100, kLimit = 6;
    Character character = make_character({.joint_count = 4, .seed = 3, .cubic = true, .morph_count = kMorphs});
    const auto morph_count = static_cast<uint32_t>(character.morphs.size());
    ASSERT_LE(morph_count, 2 * kMorphs);
    MorphTables tables = make_morph_tables(character);
    Random random(4);
    const auto any_clip = [&] { return random.below(static_cast<uint32_t>(character.clips.size()) + 1); };
    const auto rounded = [](double value) { return double{static_cast<float>(value)}; };
    std::vector<io::InstancePlayback> playbacks;
    std::vector<std::vector<MorphLayer>> of_two, of_layers;
    std::vector<io::ActiveClip> active_clips(kInstances * kLimit);
    std::vector<float> times_s(active_clips.size());
    for (uint32_t i = 0; i < kInstances; ++i) {
        const auto play = [&] { return io::ClipPlay{any_clip(), 1, static_cast<float>(random.between(0, 2)), 1}; };
        playbacks.push_back({play(), play(), static_cast<float>(random.unit())});
        const auto part = [&](const io::ClipPlay& of, double weight) {
            return MorphActiveClip{of.clip, double{of.time_s}, weight};
        };
        const io::InstancePlayback& two = playbacks.back();
        of_two.push_back(
            {{.active_clips = {part(two.first, double{two.weight}), part(two.second, 1 - double{two.weight})}}});
        std::vector<MorphLayer>& layers = of_layers.emplace_back();
        for (uint32_t at = i * kLimit; at < i * kLimit + 2 * (1 + random.below(kLimit / 2)); at += 2) {
            MorphLayer& layer = layers.emplace_back();
            layer.is_additive = random.chance(0.5);
            layer.weight = rounded(random.unit());
            const double weight = rounded(random.unit());
            for (uint32_t k = 0; k < 2; ++k) {
                layer.active_clips.push_back(
                    {any_clip(), rounded(random.between(0, 2)), k == 0 ? weight : rounded(1 - weight)});
                times_s[at + k] = static_cast<float>(layer.active_clips[k].time_s);
                active_clips[at + k] = {.first_track = layer.active_clips[k].clip * 4,
                                        .earlier = 0,
                                        .later = 0,
                                        .fraction = 0,
                                        .weight = static_cast<float>(layer.active_clips[k].weight),
                                        .layer_weight = static_cast<float>(layer.weight),
                                        .reference_row = 0,
                                        .flags = (layer.is_additive ? io::kActiveClipAdditive : 0) |
                                                 (k == 1 ? io::kActiveClipEndsLayer : 0)};
            }
        }
        active_clips[i * kLimit + 2 * layers.size() - 1].flags |= io::kActiveClipEnds;
    }
    for (const bool layered : {false, true})
        for (const uint32_t shown : {morph_count, 4u, 1u}) {
            auto active = unwritten<io::ActiveMorph>(kInstances * shown);
            NativeRun run(kernels::morph.native, {layered});
            run.bind(io::kPlaybacksBuffer, playbacks).bind(io::kActiveClipsBuffer, active_clips);
            run.bind(io::kActiveClipTimesBuffer, times_s).bind(io::kMorphTimelineBuffer, tables.timelines);
            run.bind(io::kMorphTimesBuffer, character.morph_times_s).bind(io::kMorphTracksBuffer, tables.tracks);
            run.bind(io::kMorphValuesBuffer, tables.values).bind(io::kActiveMorphsBuffer, active);
            run.invocations(io::MorphPush{kInstances, morph_count, 4, kLimit, shown}, kInstances);
            for (uint32_t i = 0; i < kInstances; ++i) {
                const std::vector<double> all = morphs_reference(character, layered ? of_layers[i] : of_two[i]);
                std::vector<double> wanted(morph_count);
                for (const WeightedMorph& morph : active_morphs_reference(all, shown))
                    wanted[morph.morph] = morph.weight;
                expect_morphs(std::span(active).subspan(i * shown, shown), wanted);
            }
        }
}

// Appends a skin matrix in the given format.
void add_skin_matrix(std::vector<uint32_t>& skin, SkinFormat format, const Trs<double>& trs) {
    const auto add = [&](double number) { skin.push_back(std::bit_cast<uint32_t>(static_cast<float>(number))); };
    const Affine m = to_affine(trs).as<float>();
    if (format == SkinFormat::kSimilarity) {
        const Quaternion<double>& q = trs.rotation;
        for (const double number :
             {q.x, q.y, q.z, q.w, trs.translation.x, trs.translation.y, trs.translation.z, trs.scale.x})
            add(number);
    } else if (format == SkinFormat::kAffine) {
        for (const auto& row : m.row)
            for (size_t k = 0; k < 4; ++k) add(double{row[k]});
    } else {
        for (const auto& row : m.row)
            for (size_t k = 0; k < 4; k += 2) skin.push_back(io::half_of(row[k]) | io::half_of(row[k + 1]) << 16);
    }
}

// All instances, or those listed at a coarser level of detail.
TEST(NativeMesh, SkinFollowsTheReference) {
    constexpr uint32_t kInstances = 3;
    Character character = make_character({.joint_count = 20, .seed = 5, .morph_count = 3});
    const auto vertex_count = static_cast<uint32_t>(character.vertices.size()),
               palette_count = static_cast<uint32_t>(character.palette.size()),
               section_count = static_cast<uint32_t>(character.sections.size());
    SkinTables tables = make_skin_tables(character, std::array{0u});
    for (uint32_t lod = 1; lod < io::kLodCount; ++lod)  // all levels are equal
        for (uint32_t s = 0; s < section_count; ++s) tables.sections.push_back(tables.sections[s]);
    std::vector<uint32_t> list{2, 0, 1, 2, 2, 2, 0}, verdicts{io::kVerdictAnimated, 0, 0};
    constexpr uint32_t kShown = 2;
    std::vector<io::ActiveMorph> active(kInstances * kShown);
    std::vector<std::vector<WeightedMorph>> morphs(kInstances);
    for (uint32_t i = 0; i < kInstances; ++i) {
        active[i * kShown] = {i, 0.5f};
        morphs[i] = {{i, 0.5}};
    }
    for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine, SkinFormat::kSimilarity})
        for (const SkinBlend blend : {SkinBlend::kLinear, SkinBlend::kDualQuaternion}) {
            Random random(6);
            std::vector<uint32_t> skin;
            std::vector<std::vector<AffineT<double>>> matrices(kInstances);
            for (uint32_t i = 0; i < kInstances * palette_count; ++i) {
                Trs<double> trs = random.trs(0.5, 0);
                trs.rotation = axis_angle(random.direction(), random.between(0, 0.7));
                trs.scale = Vec3<double>{1, 1, 1} * random.between(0.8, 1.25);
                add_skin_matrix(skin, format, trs);
                matrices[i / palette_count].push_back(to_affine(trs));
            }
            for (const bool listed : {false, true}) {
                auto skinned = unwritten<SkinnedVertex>(kInstances * vertex_count);
                NativeRun run(kernels::skin.native,
                              {static_cast<uint32_t>(format), static_cast<uint32_t>(blend), listed});
                run.bind(io::kVerticesBuffer, character.vertices).bind(io::kInfluencesBuffer, character.influences);
                run.bind(io::kSkinBuffer, skin).bind(io::kMorphDeltasBuffer, character.morph_deltas);
                run.bind(io::kActiveMorphsBuffer, active).bind(io::kSkinSectionsBuffer, tables.sections);
                run.bind(io::kListedVerticesBuffer, tables.vertices).bind(io::kListBuffer, list);
                run.bind(io::kVerdictsBuffer, verdicts).bind(io::kSkinnedBuffer, skinned);
                run.workgroups(io::SkinPush{section_count, vertex_count, palette_count, 0, 0, 1, 0, kShown},
                               listed ? list[io::kListCount] : kInstances);
                for (uint32_t i = 0; i < kInstances; ++i) {
                    if (listed && i > 0) {  // not listed, or skipped
                        EXPECT_TRUE(std::isnan(skinned[i * vertex_count].position.x));
                        continue;
                    }
                    const auto wanted = skin_reference(character, matrices[i], morphs[i], blend);
                    for (uint32_t v = 0; v < vertex_count; ++v)
                        ASSERT_LE(length(skinned[i * vertex_count + v].position.as<double>() - wanted[v]),
                                  (format == SkinFormat::kHalfAffine ? 2e-3 : 5e-6) * (1 + length(wanted[v])))
                            << "vertex " << v << ", format " << static_cast<int>(format);
                }
            }
        }
}

TEST(NativeMesh, NormalsGoThroughFractionsOf16Bits) {
    for (const float x : {-1.0f, -0.5f, 0.0f, 0.3f, 1.0f}) {
        const io::vec2 got = io::unpackSnorm2x16(io::packSnorm2x16(io::vec2(x, -x)));
        EXPECT_NEAR(got.x, x, 0.5 / 32767);
        EXPECT_NEAR(got.y, -x, 0.5 / 32767);
    }
    EXPECT_EQ(io::unpackSnorm2x16(0x8000u).x, -1);
}

}  // namespace
}  // namespace throng
