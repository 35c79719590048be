#include "bench/frame_bench.h"

#include "bench/frame_crowds.h"
#include "bench/frame_floors.h"
#include "bench/frame_traffic.h"
#include "scan/scan_planner.h"

#include <algorithm>
#include <array>

namespace throng::bench {
namespace {

struct FrameVariant {
    const char* name;
    UpdatePath path = UpdatePath::kFused;
    bool one_clip = false;
    SkinFormat format = SkinFormat::kAffine;
    bool exact_keys = false;
};
constexpr std::array kFrameVariants{FrameVariant{.name = "staged", .path = UpdatePath::kStaged},
                                    FrameVariant{.name = "fused"},
                                    FrameVariant{.name = "fused, one clip", .one_clip = true},
                                    FrameVariant{.name = "fused, 24 bytes", .format = SkinFormat::kHalfAffine},
                                    FrameVariant{.name = "fused, 32 bytes", .format = SkinFormat::kSimilarity},
                                    FrameVariant{.name = "fused, exact keys", .exact_keys = true}};
constexpr std::array kFormats{std::pair{SkinFormat::kAffine, "affine"},
                              std::pair{SkinFormat::kHalfAffine, "half_affine"},
                              std::pair{SkinFormat::kSimilarity, "similarity"}};

constexpr const char* kByKernel = "kernel";

const char* name_of(SkinFormat format) {
    return std::find_if(kFormats.begin(), kFormats.end(), [&](const auto& row) { return row.first == format; })->second;
}

// Half floats have 11 significant bits, and a translation may be as long as the character is large, or a few times
// that.
double error_bound(SkinFormat format) { return format == SkinFormat::kHalfAffine ? 2e-3 : kSkinErrorBound; }

struct FrameCandidate {
    const FrameVariant* variant = nullptr;
    const Character* character = nullptr;
    const std::vector<Playback>* playback = nullptr;
    std::shared_ptr<const FrameCrowd> made;
    double max_error = 0;
    UpdateTimes times;

    bool is_wrong() const { return !(max_error <= error_bound(variant->format)); }
    Crowd* crowd() const { return made->crowd.get(); }
    bool runs() const { return crowd() && !is_wrong(); }
};

struct Floor {
    Json record;  // what it is
    std::function<void(VkCommandBuffer)> work;
    UpdateTimes times;
};

class FrameMeasurement {
public:
    FrameMeasurement(const Device& device, const FrameCase& frame, const SkinReference& reference)
        : device_(device),
          clock_(device.gpu()),
          frame_(frame),
          reference_(reference),
          two_clips_(frame.playback.begin(), frame.playback.end()),
          one_clip_(two_clips_),
          crowds_(device, static_cast<uint32_t>(frame.playback.size())) {
        for (Playback& playback : one_clip_) playback.weight = 1;
    }

    void check(const Progress& progress) {
        for (const FrameVariant& variant : kFrameVariants) {
            if (variant.exact_keys && !frame_.exact) continue;
            progress(frame_.configuration + ": checking " + variant.name);
            const Character* character = variant.exact_keys ? frame_.exact : frame_.character;
            FrameCandidate candidate{
                .variant = &variant, .character = character, .playback = variant.one_clip ? &one_clip_ : &two_clips_};
            candidate.made = crowds_.get({character, variant.path, variant.format});
            if (candidate.crowd()) candidate.max_error = error_of(candidate);
            candidates_.push_back(std::move(candidate));
        }
        progress(frame_.configuration + ": memory alone");
        for (const auto& [format, name] : kFormats) add_fill(format);
        add_copy();
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<TimedRun> timed_runs;
        for (FrameCandidate& candidate : candidates_)
            if (candidate.runs())
                timed_runs.push_back(
                    {frame_.configuration + ": " + candidate.variant->name, [&] { take_sample(candidate); }});
        for (Floor& floor : floors_)
            if (floor.work)
                timed_runs.push_back({frame_.configuration + ": " + std::string(floor.record["variant"]),
                                      [&] { floor.times.take(clock_.read(floor.work)); }});
        run_rounds(timed_runs, samples, progress);
    }

    std::vector<Json> records() const {
        std::vector<Json> records;
        for (const FrameCandidate& candidate : candidates_) records.push_back(record_of(candidate));
        for (const Floor& floor : floors_) {
            records.push_back(case_record());
            records.back().update(floor.record);
            add_times(records.back(), floor.times);
        }
        for (Json& record : records) add_times_fill_floor(record, records);
        return records;
    }

private:
    uint64_t instance_count() const { return frame_.playback.size(); }
    uint64_t joint_count() const { return frame_.character->rig.joint_count(); }

    // The largest error of some instances, at the times of their playbacks.
    double error_of(const FrameCandidate& candidate) const {
        value_of(candidate.crowd()->set_playback(candidate.crowd()->instances(), *candidate.playback));
        value_of(candidate.crowd()->update(0));
        return largest_error_of_some(static_cast<uint32_t>(instance_count()), [&](uint32_t instance) {
            return skin_error(value_of(candidate.crowd()->read_skin_matrices({instance})),
                              reference_(*candidate.character, (*candidate.playback)[instance]),
                              candidate.character->size);
        });
    }

    // All variants begin at the same playback times in every round, so that they do the same work.
    void take_sample(FrameCandidate& candidate) const {
        value_of(candidate.crowd()->set_playback(candidate.crowd()->instances(), *candidate.playback));
        candidate.times.take(clock_.load(), *candidate.crowd());
    }

    void add_fill(SkinFormat format) {
        const auto written = std::find_if(candidates_.begin(), candidates_.end(), [&](const FrameCandidate& candidate) {
            return candidate.runs() && candidate.variant->format == format;
        });
        if (written == candidates_.end()) return;
        const auto fill = std::make_shared<FillFloor>(device_.gpu(), *written->crowd(), format);
        const std::string bytes = std::to_string(skin_format_bytes(format)) + " bytes";
        const auto add = [&](const std::string& variant, const char* by, std::function<void(VkCommandBuffer)> work) {
            clock_.time_ms(work);  // compiles the kernel
            floors_.push_back({.record = {{"variant", variant},
                                          {"path", "fill"},
                                          {"skin_format", name_of(format)},
                                          {"bytes", fill->size_bytes()},
                                          {"by", by}},
                               .work = std::move(work)});
        };
        add("fill, " + bytes, kByKernel, [fill](VkCommandBuffer commands) { fill->record_kernel(commands); });
        // Shows how much of the kernel's time is due to memory: on a software device very little.
        if (format == SkinFormat::kAffine)
            add("vkCmdFillBuffer", "vkCmdFillBuffer",
                [fill](VkCommandBuffer commands) { fill->record_transfer(commands); });
    }

    // A copy of the bytes that the staged update moves.
    void add_copy() {
        Floor floor{
            .record = {{"variant", "copy as staged"}, {"path", "copy"}, {"bytes", bytes_of(candidates_.front())}}};
        if (const std::string unsupported_reason = crowds_.memory_unsupported_reason(
                2 * crowds_.arena_buffer_bytes(*frame_.character));
            unsupported_reason.empty()) {
            const auto copy = std::make_shared<CopyFloor>(device_.gpu(), bytes_of(candidates_.front()),
                                                          crowds_.arena_buffer_bytes(*frame_.character));
            floor.record["by"] = copy->choose(clock_);
            floor.work = [copy](VkCommandBuffer commands) { copy->record(commands); };
        } else {
            floor.record["unsupported_reason"] = unsupported_reason;
        }
        floors_.push_back(std::move(floor));
    }

    uint64_t bytes_of(const FrameCandidate& candidate) const {
        const bool staged = candidate.variant->path == UpdatePath::kStaged;
        const ScanFormat format = staged && candidate.crowd()
                                      ? parse_scan_request(candidate.crowd()->path(0)->scan.method).method->format
                                      : ScanFormat::kAffine;
        const FrameTraffic traffic{.fused = !staged,
                                   .clip_count = candidate.variant->one_clip ? 1u : 2u,
                                   .joint_count = candidate.character->rig.joint_count(),
                                   .palette_count = static_cast<uint32_t>(candidate.character->palette.size()),
                                   .local_bytes = throng::bytes_of(format),
                                   .skin_bytes = skin_format_bytes(candidate.variant->format)};
        return instance_count() * traffic.bytes_per_instance();
    }

    Json case_record() const {
        Json record = new_record(device_, "frame", frame_.configuration, *frame_.character);
        record.update({{"characters", instance_count()},
                       {"mean_depth", frame_.character->rig.mean_depth},
                       {"palette_entries", frame_.character->palette.size()}});
        return record;
    }

    Json record_of(const FrameCandidate& candidate) const {
        const FrameVariant& variant = *candidate.variant;
        Json record = case_record();
        record.update({{"variant", variant.name},
                       {"path", variant.path == UpdatePath::kStaged ? "staged" : "fused"},
                       {"clips", variant.one_clip ? 1 : 2},
                       {"skin_format", name_of(variant.format)},
                       {"keys", variant.exact_keys ? "exact" : frame_.keys},
                       {"bytes", bytes_of(candidate)}});
        if (!candidate.crowd()) {
            record["unsupported_reason"] = candidate.made->unsupported_reason;
            return record;
        }
        record["scan"] = candidate.crowd()->path(0)->scan.method;
        record["max_error"] = candidate.max_error;
        if (candidate.is_wrong()) record["wrong"] = true;
        add_times(record, candidate.times);
        return record;
    }

    void add_times(Json& record, const UpdateTimes& times) const {
        if (times.count() == 0) return;
        times.add_to(record);
        const double ms = times.total().median;
        record["host_samples"] = times.count_by_host();
        record["ns_per_joint"] = ms * 1e6 / static_cast<double>(instance_count() * joint_count());
        record["gb_per_s"] = record["bytes"].get<double>() / ms * 1e-6;
    }

    // Adds the ratio of the record's time to the time for only writing the same result.
    static void add_times_fill_floor(Json& record, const std::vector<Json>& records) {
        if (!record.contains("ms") || !record.contains("clips")) return;
        const auto fill = std::find_if(records.begin(), records.end(), [&](const Json& other) {
            return other["path"] == "fill" && other["by"] == kByKernel && other["skin_format"] == record["skin_format"];
        });
        if (fill != records.end())
            record["times_fill_floor"] = record["ms"]["median"].get<double>() / (*fill)["ms"]["median"].get<double>();
    }

    const Device& device_;
    GpuClock clock_;
    const FrameCase& frame_;
    const SkinReference& reference_;
    std::vector<Playback> two_clips_, one_clip_;
    FrameCrowds crowds_;
    std::vector<FrameCandidate> candidates_;
    std::vector<Floor> floors_;
};

}  // namespace

std::vector<Json> measure_frame(const Device& device, const FrameCase& frame, uint32_t samples,
                                const Progress& progress, const SkinReference& reference) {
    FrameMeasurement measurement(device, frame, reference);
    measurement.check(progress);
    measurement.time(samples, progress);
    return measurement.records();
}

}  // namespace throng::bench
