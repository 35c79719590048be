#include "bench/million_bench.h"

#include "base/failure.h"
#include "bench/million_prediction.h"
#include "bench/pixels_off.h"
#include "bench/updates.h"
#include "bench/value_of.h"
#include "cull/cull_io.h"

#include <throng/reference.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

namespace throng::bench {
namespace {

// At eye level on the crowd's diagonal, at the fraction `along` of it, looking along it. Without `along`: above the
// crowd, seeing all of it.
struct Viewpoint {
    const char* name;
    std::optional<float> along{};  // 0..1
};
constexpr std::array kViewpoints{Viewpoint{"at 97 %", 0.97f}, Viewpoint{"at 90 %", 0.9f}, Viewpoint{"at 70 %", 0.7f},
                                 Viewpoint{"corner", 0.0f}, Viewpoint{"from above"}};

Camera camera_at(const Viewpoint& at, const Bounds& bounds) {
    const Vec3<float> middle = (bounds.min + bounds.max) * 0.5f, extent = bounds.max - bounds.min;
    if (!at.along)
        return {.eye = {middle.x, bounds.max.y + length(extent), middle.z + 0.01f * extent.z}, .target = middle};
    constexpr float kHeights = 1.5f;
    const auto on_diagonal = [&](float part, float y) {
        return Vec3<float>{bounds.min.x + part * extent.x, y, bounds.min.z + part * extent.z};
    };
    return {.eye = on_diagonal(*at.along, bounds.min.y + kHeights * extent.y), .target = on_diagonal(1.01f, middle.y)};
}

struct Seen {
    const Viewpoint* viewpoint = nullptr;
    CrowdView view;
    DrawnCounts drawn;
    uint32_t shared_poses = 0;  // rows that are drawn at least once
    // The largest errors of characters with own and with shared poses, in pixels; none if none were compared
    std::optional<double> max_own_pixels{}, max_pixels{};
    UpdateTimes times;
};

class MillionMeasurement {
public:
    MillionMeasurement(const Device& device, const MillionCase& million)
        : device_(device), load_(device.gpu()), million_(million), crowd_(make(count(), million_.path)) {}

    // Characters with poses of their own must be correct, and the others as close as the view asks.
    void check(const Progress& progress) {
        const Bounds bounds = world_bounds(*crowd_);
        for (const Viewpoint& viewpoint : kViewpoints) {
            progress(million_.configuration + ": checking " + viewpoint.name);
            Seen& seen = seen_.emplace_back();
            seen.viewpoint = &viewpoint;
            seen.view = view_of_crowd(viewpoint, bounds);
            value_of(crowd_->update(0, &seen.view));
            std::vector<DrawnInstance> own, shared;
            std::set<uint32_t> rows, cells;
            for (const DrawnInstance& one : value_of(crowd_->read_drawn())) {
                (one.shares_pose ? shared : own).push_back(one);
                if (one.shares_pose) rows.insert(one.skin_row);
                cells.insert(one.instance / io::kCullWorkgroupSize);
            }
            seen.drawn = {static_cast<uint32_t>(own.size()), static_cast<uint32_t>(shared.size()),
                          static_cast<uint32_t>(cells.size())};
            seen.shared_poses = static_cast<uint32_t>(rows.size());
            const auto most = [&](const std::vector<DrawnInstance>& of) {
                return largest_error_of_some(static_cast<uint32_t>(of.size()),
                                             [&](uint32_t i) { return pixels_of(of[i].instance, seen.view); });
            };
            if (!own.empty()) seen.max_own_pixels = most(own);
            // If rows were left over, poses are shared only because they are close enough
            if (!is_full(seen) && !shared.empty()) seen.max_pixels = most(shared);
        }
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<TimedRun> timed_runs;
        for (Seen& seen : seen_)
            if (!is_wrong(seen))
                timed_runs.push_back({million_.configuration + ": " + seen.viewpoint->name,
                                      [&] { seen.times.take(load_, *crowd_, kFrame_s, &seen.view); }});
        run_rounds(timed_runs, samples, progress);
    }

    std::vector<Json> view_records() const {
        std::vector<Json> records;
        for (const Seen& seen : seen_) records.push_back(record_of(seen));
        return records;
    }

    // How long the CPU takes to record a frame, for 1,000 characters, 10,000 and so on. The crowd that was timed gives
    // up its memory first.
    std::vector<Json> recording_records(uint32_t samples, const Progress& progress) {
        crowd_.reset();
        std::vector<Json> records;
        if (device_.gpu()->is_native()) return records;
        for (uint64_t n = 1000;; n *= 10) {
            const auto character_count = static_cast<uint32_t>(std::min<uint64_t>(n, count()));
            progress(million_.configuration + ": recording " + std::to_string(character_count));
            Json& record = records.emplace_back(
                new_record(device_, "million", million_.configuration, *million_.character));
            record["characters"] = character_count;
            Result<Crowd> crowd = as_result([&] { return make(character_count, UpdatePath::kDevice); });
            if (!crowd) {  // what was timed before is kept
                record["unsupported_reason"] = crowd.error().text();
                break;
            }
            record["record_ms"] = spread_json(spread_of(recording_ms(*crowd, samples)));
            record["samples"] = samples;
            if (character_count == count()) break;
        }
        return records;
    }

    std::vector<Json> predictions(const Progress& progress) const {
        std::vector<ViewToPredict> views;
        for (const Seen& seen : seen_) views.push_back({seen.viewpoint->name, seen.drawn});
        progress(million_.configuration + ": predicting");
        std::vector<Json> records;
        for (const Json& prediction : predict_million(*million_.character, million_.pool, count(), views))
            records.emplace_back(new_record(device_, "million", million_.configuration, *million_.character))
                .update(prediction);
        return records;
    }

private:
    uint32_t count() const { return static_cast<uint32_t>(million_.playback.size()); }

    std::vector<double> recording_ms(Crowd& crowd, uint32_t samples) const {
        const CrowdView view = view_of_crowd(kViewpoints[1], world_bounds(crowd));
        value_of(crowd.update(0, &view));
        std::vector<double> ms;
        for (uint32_t sample = 0; sample < samples; ++sample)
            device_.gpu()->submit_and_wait([&](VkCommandBuffer commands) {
                const Stopwatch watch;
                value_of(crowd.record(commands, kFrame_s, &view));
                ms.push_back(watch.elapsed_s() * 1e3);
            });
        return ms;
    }

    Crowd make(uint32_t of, UpdatePath path) const {
        Crowd crowd = value_of(Crowd::create(
            device_, {.groups = {{.character = million_.character, .instance_count = of, .skin_pool = million_.pool}},
                      .path = path,
                      .culling = Culling{.reduces_joints = true}}));
        value_of(crowd.set_placement(crowd.instances(), million_.placement.first(of)));
        value_of(crowd.set_playback(crowd.instances(), million_.playback.first(of)));
        return crowd;
    }

    CrowdView view_of_crowd(const Viewpoint& at, const Bounds& bounds) const {
        return value_of(view_of(camera_at(at, bounds), million_.width, million_.height, bounds,
                                {.shadows = false, .shared_pose_pixels = million_.shared_pose_pixels}));
    }

    // The error of an instance, in pixels, since some joints may be left out.
    double pixels_of(uint32_t instance, const CrowdView& view) {
        const ReferencePose pose = value_of(reference_pose(*million_.character, million_.playback[instance]));
        return pixels_off(value_of(crowd_->read_positions({instance})), reference_positions(*million_.character, pose),
                          million_.placement[instance], view);
    }

    bool is_full(const Seen& seen) const { return seen.drawn.own >= million_.pool.capacity; }

    bool is_wrong(const Seen& seen) const {
        const float most = seen.view.shared_pose_pixels + seen.view.lod_pixels;
        return !(seen.max_own_pixels.value_or(0) <= seen.view.lod_pixels && seen.max_pixels.value_or(0) <= most);
    }

    Json record_of(const Seen& seen) const {
        Json record = new_record(device_, "million", million_.configuration, *million_.character);
        const uint64_t own_bytes = uint64_t{million_.character->palette.size()} * sizeof(Affine);
        record.update({{"view", seen.viewpoint->name},
                       {"characters", count()},
                       {"path", path_name(*crowd_)},
                       {"drawn", seen.drawn.own + seen.drawn.shared},
                       {"own_poses", seen.drawn.own},
                       {"pool_is_full", is_full(seen)},
                       {"distinct_poses", seen.drawn.own + seen.shared_poses},
                       {"memory_bytes", crowd_->size_bytes()},
                       {"matrices_of_all_bytes", own_bytes * count()}});
        if (seen.max_own_pixels) record["max_pixels_own"] = *seen.max_own_pixels;
        if (seen.max_pixels) record["max_pixels"] = *seen.max_pixels;
        if (is_wrong(seen)) record["wrong"] = true;
        seen.times.add_to(record);
        return record;
    }

    const Device& device_;
    GpuLoad load_;
    const MillionCase& million_;
    std::optional<Crowd> crowd_;
    std::vector<Seen> seen_;
};

}  // namespace

std::vector<Json> measure_million(const Device& device, const MillionCase& million, uint32_t samples,
                                  const Progress& progress) {
    MillionMeasurement measurement(device, million);
    measurement.check(progress);
    measurement.time(samples, progress);
    std::vector<Json> records = measurement.view_records();
    for (const std::vector<Json>& more :
         {measurement.recording_records(samples, progress), measurement.predictions(progress)})
        records.insert(records.end(), more.begin(), more.end());
    return records;
}

}  // namespace throng::bench
