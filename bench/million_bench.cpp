#include "bench/million_bench.h"

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

// On the diagonal of the crowd at eye level, at the fraction `along` of it, looking along it; or above, seeing all.
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
    // How far characters with own and with shared poses are off; none if none were compared
    std::optional<double> max_own_pixels{}, max_pixels{};
    UpdateTimes times;
};

class MillionMeasurement {
public:
    MillionMeasurement(const Device& device, const MillionCase& million)
        : device_(device), load_(device.gpu()), million_(million), crowd_(make(count())) {}

    // Characters with poses of their own must be correct, and the others as close as the view asks.
    void check(const Progress& progress) {
        const Bounds bounds = world_bounds(crowd_);
        for (const Viewpoint& viewpoint : kViewpoints) {
            progress(million_.configuration + ": checking " + viewpoint.name);
            Seen& seen = seen_.emplace_back();
            seen.viewpoint = &viewpoint;
            seen.view = view_of_crowd(viewpoint, bounds);
            value_of(crowd_.update(0, &seen.view));
            std::vector<DrawnInstance> own, shared;
            std::set<uint32_t> rows, cells;
            for (const DrawnInstance& one : value_of(crowd_.read_drawn())) {
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
        std::vector<Contestant> contestants;
        for (Seen& seen : seen_)
            if (!is_wrong(seen))
                contestants.push_back({million_.configuration + ": " + seen.viewpoint->name,
                                       [&] { seen.times.take(load_, crowd_, kFrame_s, &seen.view); }});
        run_rounds(contestants, samples, progress);
    }

    // How long the CPU takes to record a frame, for 1,000 characters, 10,000 and so on.
    void time_recording(uint32_t samples, const Progress& progress) {
        if (device_.gpu()->is_native()) return;
        for (uint64_t n = 1000;; n *= 10) {
            const auto of = static_cast<uint32_t>(std::min<uint64_t>(n, count()));
            progress(million_.configuration + ": recording " + std::to_string(of));
            Crowd crowd = make(of, UpdatePath::kDevice);
            const CrowdView view = view_of_crowd(kViewpoints[1], world_bounds(crowd));
            value_of(crowd.update(0, &view));
            std::vector<double> ms;
            for (uint32_t sample = 0; sample < samples; ++sample)
                device_.gpu()->submit_and_wait([&](VkCommandBuffer commands) {
                    const Stopwatch watch;
                    value_of(crowd.record(commands, kFrame_s, &view));
                    ms.push_back(watch.elapsed_s() * 1e3);
                });
            Json record = where_and_when(device_.info());
            record.update({{"bench", "million"},
                           {"configuration", million_.configuration},
                           {"characters", of},
                           {"samples", samples},
                           {"record_ms", spread_json(spread_of(ms))}});
            recordings_.push_back(record);
            if (of == count()) break;
        }
    }

    std::vector<Json> records(const Progress& progress) const {
        std::vector<Json> all;
        for (const Seen& seen : seen_) all.push_back(record_of(seen));
        all.insert(all.end(), recordings_.begin(), recordings_.end());
        std::vector<ViewToPredict> views;
        for (const Seen& seen : seen_) views.push_back({seen.viewpoint->name, seen.drawn});
        progress(million_.configuration + ": predicting");
        for (Json& prediction : predict_million(*million_.character, million_.pool, count(), views)) {
            prediction["configuration"] = million_.configuration;
            all.push_back(std::move(prediction));
        }
        return all;
    }

private:
    uint32_t count() const { return static_cast<uint32_t>(million_.playback.size()); }

    Crowd make(uint32_t of) const { return make(of, million_.path); }
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

    // In pixels, since some joints may be left out.
    double pixels_of(uint32_t instance, const CrowdView& view) {
        const ReferencePose pose = value_of(reference_pose(*million_.character, million_.playback[instance]));
        return pixels_off(value_of(crowd_.read_positions({instance})), reference_positions(*million_.character, pose),
                          million_.placement[instance], view);
    }

    bool is_full(const Seen& seen) const { return seen.drawn.own >= million_.pool.capacity; }

    bool is_wrong(const Seen& seen) const {
        const float most = seen.view.shared_pose_pixels + seen.view.lod_pixels;
        return !(seen.max_own_pixels.value_or(0) <= seen.view.lod_pixels && seen.max_pixels.value_or(0) <= most);
    }

    Json record_of(const Seen& seen) const {
        Json record = where_and_when(device_.info());
        const Rig& rig = million_.character->rig;
        const uint64_t own_bytes = uint64_t{million_.character->palette.size()} * sizeof(Affine);
        record.update({{"bench", "million"},
                       {"configuration", million_.configuration},
                       {"view", seen.viewpoint->name},
                       {"characters", count()},
                       {"joints", rig.joint_count()},
                       {"levels", rig.level_count},
                       {"path", path_name(crowd_)},
                       {"drawn", seen.drawn.own + seen.drawn.shared},
                       {"own_poses", seen.drawn.own},
                       {"pool_is_full", is_full(seen)},
                       {"distinct_poses", seen.drawn.own + seen.shared_poses},
                       {"memory_bytes", crowd_.size_bytes()},
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
    Crowd crowd_;
    std::vector<Seen> seen_;
    std::vector<Json> recordings_;
};

}  // namespace

std::vector<Json> measure_million(const Device& device, const MillionCase& million, uint32_t samples,
                                  const Progress& progress) {
    MillionMeasurement measurement(device, million);
    measurement.check(progress);
    measurement.time(samples, progress);
    measurement.time_recording(samples, progress);
    return measurement.records(progress);
}

}  // namespace throng::bench
