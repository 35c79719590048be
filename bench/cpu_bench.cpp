#include "bench/cpu_bench.h"

#include "base/processor.h"

#include "bench/cpu_threads.h"
#include "bench/updates.h"
#include "bench/value_of.h"
#include "blend/active_clips_reference.h"
#include "control/control_reference.h"
#include "reference/reference.h"
#include "sample/sample_reference.h"

#include <throng/reference.h>

#include <cstring>
#include <fstream>
#include <map>
#include <random>

#include <sys/mman.h>

namespace throng::bench {
namespace {

constexpr uint32_t kFrames = 4;               // sets of cursors, so that rows are not always the same
constexpr uint32_t kCharactersAtATime = 256;  // characters that a thread takes at a time
constexpr double kFrameStep_s = 0.1;          // rows further on in each frame

struct Scene {
    std::vector<Playback> playbacks;                       // [character], of the first frame
    std::vector<std::vector<io::InstanceCursor>> cursors;  // [frame][character]
    std::vector<std::vector<io::ActiveClip>> layers;       // [frame][character][kActiveClips]
    std::vector<float> mask;
    native::AlignedBytes ordered_mask;
};

// Three layers: both clips of the playback; both again, with swapped weights, on the joints of a mask; and, additively,
// the second clip's difference from its first row.
constexpr uint32_t kActiveClips = 5;
constexpr float kMaskedWeight = 0.7f, kAdditiveWeight = 0.3f;

std::array<io::ActiveClip, kActiveClips> layers_of(const Character& character, const io::InstanceCursor& cursor) {
    const auto active = [&](const io::ClipCursor& of, float weight, float layer_weight, uint32_t flags) {
        const Clip& clip = character.clips[of.first_track / character.rig.joint_count()];
        return io::ActiveClip{of.first_track, of.earlier,   of.later,       of.fraction,
                              weight,         layer_weight, clip.first_row, flags};
    };
    using namespace io;
    return {active(cursor.first, cursor.weight, 1, kActiveClipBeginsLayer),
            active(cursor.second, 1 - cursor.weight, 1, kActiveClipEndsLayer),
            active(cursor.second, cursor.weight, kMaskedWeight, kActiveClipBeginsLayer | kActiveClipMasked),
            active(cursor.first, 1 - cursor.weight, kMaskedWeight, kActiveClipEndsLayer | kActiveClipMasked),
            active(cursor.second, 1, kAdditiveWeight,
                   kActiveClipBeginsLayer | kActiveClipEndsLayer | kActiveClipEnds | kActiveClipAdditive)};
}

ReferencePose layers_reference(const Character& character, const Playback& playback, std::span<const float> mask) {
    const auto first_row = sample_reference(character, playback.second.clip, 0);
    const auto pose = [&](const ClipPlayback& of) {
        const double time_s = local_time_reference(of.time_s, character.clips[of.clip].duration_s, true);
        return sample_reference(character, of.clip, time_s);
    };
    const auto first = pose(playback.first), second = pose(playback.second);
    const double weight = playback.weight;
    std::vector<Trs<double>> local;
    for (size_t j = 0; j < first.size(); ++j) {
        const std::array<ReferenceLayer, 3> layers{
            ReferenceLayer{.active_clips = {{first[j], {}, weight}, {second[j], {}, 1 - weight}}},
            ReferenceLayer{.weight = double{kMaskedWeight} * mask[j],
                           .active_clips = {{second[j], {}, weight}, {first[j], {}, 1 - weight}}},
            ReferenceLayer{
                .is_additive = true, .weight = kAdditiveWeight, .active_clips = {{second[j], first_row[j], 1}}}};
        local.push_back(active_clips_reference(layers));
    }
    return pose_from_local(character, local);
}

io::ClipCursor cursor_of(const Character& character, const ClipPlayback& playback) {
    return cursor_reference(playback, character.clips, character.times_s, character.rig.joint_count());
}

Scene make_scene(const Character& character, uint32_t characters, uint32_t clips, uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    Scene scene;
    for (uint32_t i = 0; i < characters; ++i) {
        const auto any_clip = [&] {
            const auto clip = static_cast<uint32_t>(random() % character.clips.size());
            return ClipPlayback{.clip = clip, .time_s = unit() * character.clips[clip].duration_s};
        };
        Playback playback{
            .first = any_clip(), .second = any_clip(), .weight = static_cast<float>(0.01 + 0.98 * unit())};
        if (clips == 1) playback.weight = 1;
        scene.playbacks.push_back(playback);
    }
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        auto& cursors = scene.cursors.emplace_back();
        for (Playback playback : scene.playbacks) {
            playback.first.time_s += frame * kFrameStep_s;
            playback.second.time_s += frame * kFrameStep_s;
            cursors.push_back(
                {cursor_of(character, playback.first), cursor_of(character, playback.second), playback.weight});
        }
    }
    return scene;
}

// Memory in huge pages, like a crowd's; otherwise every cache line that is written would need its own address
// translation.
class Output {
public:
    explicit Output(size_t size) : size_((size + kPage - 1) / kPage * kPage) {
        bytes_ = static_cast<std::byte*>(std::aligned_alloc(kPage, size_));
        if (!bytes_) throw std::bad_alloc();
        ::madvise(bytes_, size_, MADV_HUGEPAGE);
        poison();
    }
    ~Output() { std::free(bytes_); }
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;
    std::byte* data() const { return bytes_; }
    void poison() { std::memset(bytes_, 0xFF, size_); }  // every float is NaN

private:
    static constexpr size_t kPage = 2 << 20;
    size_t size_;
    std::byte* bytes_ = nullptr;
};

class CpuMeasurement {
public:
    CpuMeasurement(const CpuCase& cpu_case, const Progress& progress) : case_(cpu_case), output_(max_bytes(cpu_case)) {
        for (const CpuVariant& variant : cpu_case.variants) {
            progress(cpu_case.configuration + ": preparing " + variant.name);
            if (!rigs_.contains(variant.character)) rigs_.emplace(variant.character, NativeRig(*variant.character));
            scenes_.push_back(make_scene(*variant.character, cpu_case.characters, variant.clips, cpu_case.seed));
            if (variant.layers) add_layers(variant, scenes_.back());
        }
        for (const uint32_t threads : cpu_case.threads) threads_.emplace(threads, threads);
    }

    std::vector<Json> measure(const Progress& progress) {
        for (const uint32_t threads : case_.threads)
            for (const NativeIsa isa : case_.isas) {
                add(threads, isa, nullptr, 0);
                for (size_t v = 0; v < case_.variants.size(); ++v) add(threads, isa, &case_.variants[v], v);
            }
        for (Candidate& candidate : candidates_)
            if (candidate.variant) {
                progress(name_of(candidate) + ": checking");
                candidate.error = error_of(candidate);
            }
        std::vector<TimedRun> timed_runs;
        for (Candidate& candidate : candidates_)
            if (!candidate.is_wrong()) timed_runs.push_back({name_of(candidate), [&] { take_sample(candidate); }});
        for (Candidate& candidate : candidates_) run(candidate, 0, false);  // warm
        run_rounds(timed_runs, case_.samples, progress);
        std::vector<Json> records;
        for (const Candidate& candidate : candidates_) records.push_back(record_of(candidate));
        return records;
    }

private:
    struct Candidate {
        uint32_t threads;
        NativeIsa isa;
        const CpuVariant* variant;  // null: the fill
        size_t scene;
        double error = 0;
        uint32_t frame = 0;
        std::vector<double> ms{}, wall_ms{}, decode_ms{};

        bool is_wrong() const { return !(error <= kSkinErrorBound); }
    };

    void add_layers(const CpuVariant& variant, Scene& scene) const {
        const uint32_t joints = variant.character->rig.joint_count();
        for (uint32_t joint = 0; joint < joints; ++joint) scene.mask.push_back(joint < joints / 2 ? 0.0f : 1.0f);
        scene.ordered_mask = rigs_.at(variant.character).masks_in_order(scene.mask);
        for (const auto& cursors : scene.cursors) {
            auto& layers = scene.layers.emplace_back();
            for (const io::InstanceCursor& cursor : cursors)
                for (const io::ActiveClip& clip : layers_of(*variant.character, cursor)) layers.push_back(clip);
        }
    }

    static size_t max_bytes(const CpuCase& cpu_case) {
        size_t most = 0;
        for (const CpuVariant& variant : cpu_case.variants)
            most = std::max(most, variant.character->palette.size() * sizeof(Affine) * cpu_case.characters);
        return most;
    }

    void add(uint32_t threads, NativeIsa isa, const CpuVariant* variant, size_t scene) {
        candidates_.push_back({.threads = threads, .isa = isa, .variant = variant, .scene = scene});
    }

    std::string name_of(const Candidate& candidate) const {
        return case_.configuration + ": " + std::string(throng::name_of(candidate.isa)) + ", " +
               (candidate.variant ? candidate.variant->name : "fill");
    }

    size_t instance_bytes(const Candidate& candidate) const {
        const Character& character = *(candidate.variant ? candidate.variant : &case_.variants.front())->character;
        return character.palette.size() * sizeof(Affine);
    }

    CpuThreads::Taken run(const Candidate& candidate, uint32_t frame, bool only_decode) {
        CpuThreads& threads = threads_.at(candidate.threads);
        const size_t stride = instance_bytes(candidate);
        if (!candidate.variant)
            return threads.run(case_.characters, kCharactersAtATime, [&](uint32_t first, uint32_t end) {
                const size_t begin = first * stride / 64 * 64, stop = end * stride / 64 * 64;
                stream_fill({output_.data() + begin, stop - begin}, candidate.isa);
            });
        const NativeRig& rig = rigs_.at(candidate.variant->character);
        const Scene& scene = scenes_[candidate.scene];
        NativeUpdate buffers{.cursors = scene.cursors[frame % kFrames].data(), .skin = output_.data()};
        if (candidate.variant->layers) {
            buffers.active_clips = scene.layers[frame % kFrames].data();
            buffers.active_clip_limit = kActiveClips;
            buffers.masks = reinterpret_cast<const float*>(scene.ordered_mask.get());
        }
        return threads.run(case_.characters, kCharactersAtATime, [&](uint32_t first, uint32_t end) {
            (only_decode ? decode_only : static_cast<decltype(&decode_only)>(update))(rig, buffers, first, end,
                                                                                      candidate.isa);
        });
    }

    double error_of(const Candidate& candidate) {
        // So that another candidate's results do not pass for this one's
        output_.poison();
        run(candidate, 0, false);
        const Character& character = *candidate.variant->character;
        return largest_error_of_some(case_.characters, [&](uint32_t instance) {
            const auto* skin = reinterpret_cast<const Affine*>(output_.data() + instance * instance_bytes(candidate));
            const Scene& scene = scenes_[candidate.scene];
            const Playback& playback = scene.playbacks[instance];
            const ReferencePose pose = candidate.variant->layers ? layers_reference(character, playback, scene.mask)
                                                                 : value_of(reference_pose(character, playback));
            return skin_error({skin, character.palette.size()}, pose.model_from_bind, character.size);
        });
    }

    void take_sample(Candidate& candidate) {
        const CpuThreads::Taken taken = run(candidate, candidate.frame, false);
        candidate.ms.push_back(taken.processor_s * 1e3);
        candidate.wall_ms.push_back(taken.wall_s * 1e3);
        if (candidate.variant) candidate.decode_ms.push_back(run(candidate, candidate.frame++, true).processor_s * 1e3);
    }

    Json record_of(const Candidate& candidate) const {
        const Character& character = *(candidate.variant ? candidate.variant : &case_.variants.front())->character;
        Json record = where_and_when({.name = processor_name(), .driver = std::string(throng::name_of(candidate.isa))});
        record.update({{"bench", "cpu"},
                       {"configuration", case_.configuration},
                       {"variant", candidate.variant ? candidate.variant->name : "fill"},
                       {"isa", throng::name_of(candidate.isa)},
                       {"threads", candidate.threads},
                       {"characters", case_.characters},
                       {"joints", character.rig.joint_count()},
                       {"levels", character.rig.level_count},
                       {"palette_entries", character.palette.size()},
                       {"bytes", instance_bytes(candidate) * case_.characters},
                       {"samples", candidate.ms.size()}});
        if (candidate.variant) {
            record["clips"] = candidate.variant->clips;
            record["rows_bytes"] = rigs_.at(candidate.variant->character).row_bytes();
            record["max_error"] = candidate.error;
            if (candidate.is_wrong()) record["wrong"] = true;
        }
        if (candidate.ms.empty()) return record;
        const Spread ms = spread_of(candidate.ms);
        const double quiet_ms = ms.p5;
        const double joints = double{character.rig.joint_count() * 1.0} * case_.characters;
        record["ms"] = spread_json(ms);
        record["ns_per_joint"] = quiet_ms * 1e6 / joints;
        record["gb_per_s"] = record["bytes"].get<double>() / quiet_ms * 1e-6;
        const Spread wall_ms = spread_of(candidate.wall_ms);
        record["wall_ms"] = spread_json(wall_ms);
        if (const Candidate* one = find(candidate, candidate.variant, 1); one && one != &candidate && !one->ms.empty())
            record["times_one_thread"] = spread_of(one->wall_ms).p5 / wall_ms.p5;
        if (!candidate.variant) return record;
        record["decode_share"] = spread_of(candidate.decode_ms).p5 / quiet_ms;
        const Candidate& fill = *find(candidate, nullptr, candidate.threads);
        record["times_fill_floor"] = quiet_ms / spread_of(fill.ms).p5;
        return record;
    }

    // The candidate with the instruction set of `beside` and this variant, or the fill floor if `variant` is null. Null
    // if there is none.
    const Candidate* find(const Candidate& beside, const CpuVariant* variant, uint32_t threads) const {
        const auto found = std::ranges::find_if(candidates_, [&](const Candidate& candidate) {
            return candidate.variant == variant && candidate.isa == beside.isa && candidate.threads == threads;
        });
        return found == candidates_.end() ? nullptr : &*found;
    }

    const CpuCase& case_;
    Output output_;
    std::map<const Character*, NativeRig> rigs_;
    std::vector<Scene> scenes_;  // [variant]
    std::map<uint32_t, CpuThreads> threads_;
    std::vector<Candidate> candidates_;
};

}  // namespace

Asset with_moving_translations(const Asset& asset) {
    Asset moving = asset;
    for (AssetClip& clip : moving.clips) {
        std::vector<AssetTrack> added;
        for (const AssetTrack& track : clip.tracks) {
            if (track.target != TrackTarget::kRotation) continue;
            AssetTrack moves{.node = track.node, .times_s = track.times_s};
            const Vec3<double> rest = asset.nodes[track.node].parent_from_node.translation;
            for (const float time_s : track.times_s)
                for (uint32_t axis = 0; axis < 3; ++axis) {
                    const double turn = 6.283185 * time_s / clip.duration_s * (1 + (track.node + axis) % 3);
                    const double at = axis == 0 ? rest.x : axis == 1 ? rest.y : rest.z;
                    moves.values.push_back(
                        static_cast<float>(at + 0.01 * length(rest) * std::sin(turn + 1.7 * track.node + axis)));
                }
            added.push_back(std::move(moves));
        }
        std::erase_if(clip.tracks, [](const AssetTrack& track) { return track.target == TrackTarget::kTranslation; });
        clip.tracks.insert(clip.tracks.end(), added.begin(), added.end());
    }
    return moving;
}

std::vector<Json> measure_cpu(const CpuCase& cpu_case, const Progress& progress) {
    return CpuMeasurement(cpu_case, progress).measure(progress);
}

}  // namespace throng::bench
