#include "bench/view_bench.h"

#include "bench/pixels_off.h"
#include "bench/updates.h"
#include "tools/cli/drawn.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace throng::bench {
namespace {

struct ViewVariant {
    const char* name;
    bool culls = true, reduces_joints = false, skips_updates = false;
};
constexpr std::array kViewVariants{
    ViewVariant{.name = "everything", .culls = false}, ViewVariant{.name = "culled"},
    ViewVariant{.name = "and fewer joints", .reduces_joints = true},
    ViewVariant{.name = "and fewer updates", .reduces_joints = true, .skips_updates = true}};

// Updates in which no time passes, after which all characters that wait for a new pose have it
constexpr uint32_t kSettling = 17;
constexpr uint32_t kCheckedOfEachLevel = 16;  // characters of each level of detail

struct ViewCandidate {
    const ViewVariant* variant = nullptr;
    std::optional<Crowd> crowd;
    std::string unsupported_reason;
    std::vector<uint32_t> drawn;  // of each level of detail
    double max_error = 0, max_pixels = 0;
    UpdateTimes times;

    const CrowdView* view(const CrowdView& seen) const { return variant->culls ? &seen : nullptr; }
};

class ViewMeasurement {
public:
    ViewMeasurement(const Device& device, const ViewCase& seen) : device_(device), load_(device.gpu()), seen_(seen) {}

    void check(const Progress& progress) {
        for (const ViewVariant& variant : kViewVariants) {
            progress(seen_.configuration + ": checking " + variant.name);
            ViewCandidate& candidate = candidates_.emplace_back();
            candidate.variant = &variant;
            Result<Crowd> made = Crowd::create(
                device_, {.groups = {{.character = seen_.character, .instance_count = count()}},
                          .path = seen_.path,
                          .culling = variant.culls ? std::optional(Culling{.skips_updates = variant.skips_updates,
                                                                           .reduces_joints = variant.reduces_joints})
                                                   : std::nullopt});
            if (!made) {
                candidate.unsupported_reason = made.error().text();
                continue;
            }
            candidate.crowd = std::move(*made);
            value_of(candidate.crowd->set_placement(candidate.crowd->instances(), seen_.placement));
            value_of(candidate.crowd->set_playback(candidate.crowd->instances(), seen_.playback));
            if (!view_) view_ = seen_.view_of(world_bounds(*candidate.crowd));
            for (uint32_t i = 0; i < kSettling; ++i) value_of(candidate.crowd->update(0, candidate.view(*view_)));
            compare(candidate);
            if (!candidate.drawn.empty()) continue;
            candidate.unsupported_reason = "the camera sees none of the characters";  // so nothing has been checked
            candidate.crowd.reset();
        }
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<TimedRun> timed_runs;
        for (ViewCandidate& candidate : candidates_)
            if (candidate.crowd && !is_wrong(candidate))
                timed_runs.push_back(
                    {seen_.configuration + ": " + candidate.variant->name,
                     [&] { candidate.times.take(load_, *candidate.crowd, kFrame_s, candidate.view(*view_)); }});
        run_rounds(timed_runs, samples, progress);
    }

    std::vector<Json> records() const {
        std::vector<Json> records;
        for (const ViewCandidate& candidate : candidates_) records.push_back(record_of(candidate));
        return records;
    }

private:
    // Fewer joints may move a vertex by at most the error that the view allows for levels of detail.
    bool is_wrong(const ViewCandidate& candidate) const {
        return !(candidate.max_error <= kSkinErrorBound && candidate.max_pixels <= view_->lod_pixels);
    }

    uint32_t count() const { return static_cast<uint32_t>(seen_.playback.size()); }

    std::vector<DrawnInstance> drawn_by(ViewCandidate& candidate) const {
        if (candidate.variant->culls) return value_of(candidate.crowd->read_drawn());
        std::vector<DrawnInstance> all;
        for (uint32_t i = 0; i < count(); ++i) all.push_back({.instance = i});
        return all;
    }

    // Checks some instances of each level of detail that is drawn: their skin matrices, or, if they have fewer joints,
    // how far the vertices are off as seen in the view.
    void compare(ViewCandidate& candidate) const {
        std::vector<DrawnInstance> drawn = drawn_by(candidate);
        std::ranges::stable_sort(drawn, {}, &DrawnInstance::lod);  // large crowds are listed batch by batch
        candidate.drawn = tools::count_by_lod(drawn);
        auto first = drawn.begin();
        for (const uint32_t of_level : candidate.drawn) {
            const uint32_t checked = std::min(kCheckedOfEachLevel, of_level);
            for (uint32_t i = 0; i < checked; ++i) compare(candidate, first[int64_t{of_level} * i / checked]);
            first += of_level;
        }
    }

    void compare(ViewCandidate& candidate, const DrawnInstance& one) const {
        const ReferencePose pose = value_of(reference_pose(*seen_.character, seen_.playback[one.instance]));
        if (candidate.variant->reduces_joints && one.lod > 0)
            candidate.max_pixels = std::max(
                candidate.max_pixels,
                pixels_off(value_of(candidate.crowd->read_positions({one.instance})),
                           reference_positions(*seen_.character, pose), seen_.placement[one.instance], *view_));
        else
            candidate.max_error = std::max(candidate.max_error,
                                           skin_error(value_of(candidate.crowd->read_skin_matrices({one.instance})),
                                                      pose.model_from_bind, seen_.character->size));
    }

    Json record_of(const ViewCandidate& candidate) const {
        Json record = new_record(device_, "view", seen_.configuration, *seen_.character);
        record.update({{"variant", candidate.variant->name}, {"characters", count()}});
        if (!candidate.crowd) {
            record["unsupported_reason"] = candidate.unsupported_reason;
            return record;
        }
        record.update({{"path", path_name(*candidate.crowd)},
                       {"drawn", candidate.drawn},
                       {"memory_bytes", candidate.crowd->size_bytes()},
                       {"max_error", candidate.max_error}});
        if (candidate.variant->culls) record["lod_pixels"] = view_->lod_pixels;
        if (candidate.variant->reduces_joints) record["max_pixels"] = candidate.max_pixels;
        if (candidate.variant->skips_updates) record["full_rate_pixels"] = view_->full_rate_pixels;
        if (is_wrong(candidate)) record["wrong"] = true;
        candidate.times.add_to(record);
        if (const double all_ms = candidates_.front().times.total().median; all_ms > 0 && candidate.times.count() > 0)
            record["times_faster"] = all_ms / candidate.times.total().median;
        return record;
    }

    const Device& device_;
    GpuLoad load_;
    const ViewCase& seen_;
    std::optional<CrowdView> view_;
    std::vector<ViewCandidate> candidates_;
};

}  // namespace

std::vector<Json> measure_view(const Device& device, const ViewCase& seen, uint32_t samples, const Progress& progress) {
    ViewMeasurement measurement(device, seen);
    measurement.check(progress);
    measurement.time(samples, progress);
    return measurement.records();
}

}  // namespace throng::bench
