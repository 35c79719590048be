// Layers of active clips in the native engine, against the reference.
#include "bind/skin_format.h"
#include "blend/active_clips_reference.h"
#include "reference/reference.h"
#include "sample/sample_reference.h"
#include "tests/host/native_cases.h"

#include <algorithm>
#include <optional>

namespace throng {
namespace {

using namespace test;

constexpr double kLayersBound = 1e-5;  // as a fraction of the character's size
constexpr uint32_t kLayersLimit = 9;   // active clips
constexpr uint32_t kLayersInstances = 21;

// An instance's random layers, as the control stage outputs them and as the reference takes them.
struct Layered {
    std::vector<io::ActiveClip> clips;
    ReferencePose wanted;
    bool has_two_ways = false;  // some rotations are so far apart that rounding decides
};

class LayerMaker {
public:
    LayerMaker(const Character& character, std::span<const float> masks, uint64_t seed)
        : character_(character), masks_(masks), random_(seed) {
        for (uint32_t clip = 0; clip < character.clips.size(); ++clip)
            first_poses_.push_back(sample_reference(character, clip, 0));
    }

    // Empty if the character turns too far for this: the small ones generated from random numbers.
    std::optional<Layered> make() {
        for (uint32_t tried = 0; tried < 100; ++tried) {
            Layered layered = try_once();
            if (!layered.has_two_ways) return layered;
        }
        return std::nullopt;
    }

private:
    Layered try_once() {
        const uint32_t joints = character_.rig.joint_count(), layer_count = 1 + random_.below(3);
        Layered out;
        std::vector<std::vector<ReferenceLayer>> of_joints(joints);
        for (uint32_t layer = 0; layer < layer_count; ++layer) {
            const uint32_t clip_count = 1 + random_.below(3);
            const bool is_additive = layer > 0 && random_.chance(0.5), is_masked = layer > 0 && random_.chance(0.5);
            const uint32_t mask = random_.below(static_cast<uint32_t>(masks_.size() / joints));
            const auto layer_weight = static_cast<float>(layer == 0 || random_.chance(0.2) ? 1 : random_.unit());
            double sum = 0;
            std::vector<double> weights;
            for (uint32_t k = 0; k < clip_count; ++k) sum += weights.emplace_back(random_.between(0.1, 1));
            for (uint32_t j = 0; j < joints; ++j)
                of_joints[j].push_back({.is_additive = is_additive,
                                        .weight = layer_weight * (is_masked ? double{masks_[mask * joints + j]} : 1)});
            for (uint32_t k = 0; k < clip_count; ++k) {
                const auto clip = random_.below(static_cast<uint32_t>(character_.clips.size()));
                const ClipPlayback playback{
                    .clip = clip, .time_s = random_.between(0, character_.clips[clip].duration_s), .loop = false};
                const io::ClipCursor cursor = cursor_of(character_, {.first = playback}).first;
                uint32_t flags = (k == 0 ? io::kActiveClipBeginsLayer : 0u) |
                                 (k + 1 == clip_count ? io::kActiveClipEndsLayer : 0u) |
                                 (is_additive ? io::kActiveClipAdditive : 0u);
                if (is_masked) flags |= io::kActiveClipMasked | mask << io::kActiveClipMaskShift;
                if (layer + 1 == layer_count && k + 1 == clip_count) flags |= io::kActiveClipEnds;
                const double weight = weights[k] / sum;
                out.clips.push_back({cursor.first_track, cursor.earlier, cursor.later, cursor.fraction,
                                     static_cast<float>(weight), layer_weight, character_.clips[clip].first_row,
                                     flags});
                const std::vector<Trs<double>> pose = sample_reference(character_, clip, playback.time_s),
                                               &first = first_poses_[clip];
                for (uint32_t j = 0; j < joints; ++j)
                    of_joints[j].back().active_clips.push_back({pose[j], first[j], weight});
            }
        }
        out.clips.resize(kLayersLimit);
        std::vector<Trs<double>> local;
        for (const auto& layers : of_joints) {
            local.push_back(active_clips_reference(layers));
            for (size_t k = 0; k < layers.size(); ++k)
                out.has_two_ways |= is_far(layers[k], active_clips_reference(std::span(layers).first(k)));
            if (out.has_two_ways) return out;  // the result is not used
        }
        out.wanted = pose_from_local(character_, local);
        return out;
    }

    static bool is_far(const ReferenceLayer& layer, const Trs<double>& below) {
        std::vector<Quaternion<double>> turns;
        for (const ReferenceActiveClip& clip : layer.active_clips)
            turns.push_back(
                (layer.is_additive ? pose_difference_reference(clip.pose, clip.first) : clip.pose).rotation);
        turns.push_back(layer.is_additive ? Quaternion<double>{} : below.rotation);
        for (size_t a = 0; a < turns.size(); ++a)
            for (size_t b = 0; b < a; ++b)
                if (std::abs(dot(turns[a], turns[b])) < 0.1) return true;
        return false;
    }

    const Character& character_;
    std::span<const float> masks_;
    Random random_;
    std::vector<std::vector<Trs<double>>> first_poses_;  // [clip][joint]
};

TEST(NativeLayers, FollowTheReference) {
    double worst_of_all = 0;
    size_t character_count = 0;
    for (const NamedCharacter& named : native_characters()) {
        const Character& character = named.character;
        if (character.clips.empty()) continue;
        Random random(7);
        std::vector<float> masks;
        for (uint32_t k = 0; k < 2 * character.rig.joint_count(); ++k)
            masks.push_back(random.chance(0.3) ? 0 : random.chance(0.3) ? 1 : static_cast<float>(random.unit()));
        std::fill_n(masks.begin(), character.rig.joint_count() / 2, 0.0f);  // whole blocks without weight
        LayerMaker maker(character, masks, 8);
        std::vector<Layered> instances;
        std::vector<io::ActiveClip> clips;
        for (uint32_t i = 0; i < kLayersInstances; ++i) {
            std::optional<Layered> layered = maker.make();
            if (!layered) break;
            clips.insert(clips.end(), layered->clips.begin(), layered->clips.end());
            instances.push_back(*std::move(layered));
        }
        if (instances.size() < kLayersInstances) continue;
        ++character_count;
        const NativeRig rig(character);
        const native::AlignedBytes ordered = rig.masks_in_order(masks);
        const size_t stride = character.palette.size();
        for (const NativeIsa isa : native_isas()) {
            GuardedBytes skin(kLayersInstances * stride * 48);
            const NativeUpdate buffers{.active_clips = clips.data(),
                                       .active_clip_limit = kLayersLimit,
                                       .masks = reinterpret_cast<const float*>(ordered.get()),
                                       .skin = skin.data()};
            update(rig, buffers, 0, kLayersInstances, isa);
            GuardedBytes in_parts(kLayersInstances * stride * 48);
            NativeUpdate of_parts = buffers;
            of_parts.skin = in_parts.data();
            for (uint32_t first = 0; first < kLayersInstances; first += 5)
                update(rig, of_parts, first, std::min(kLayersInstances, first + 5), isa);
            EXPECT_TRUE(std::ranges::equal(skin.content(), in_parts.content())) << named.name << " " << name_of(isa);
            const std::vector<Affine> got = unpack_skin(SkinFormat::kAffine, skin.content());
            double worst = 0;
            for (size_t i = 0; i < kLayersInstances; ++i)
                worst = std::max(
                    worst, displacement(character, std::span(got).subspan(i * stride, stride), instances[i].wanted));
            EXPECT_LT(worst, kLayersBound) << named.name << " " << name_of(isa);
            worst_of_all = std::max(worst_of_all, worst);
        }
    }
    std::printf("%zu characters, largest displacement %.1e\n", character_count, worst_of_all);
    EXPECT_GE(character_count, 6u);
}

}  // namespace
}  // namespace throng
