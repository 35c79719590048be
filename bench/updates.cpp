#include "bench/updates.h"

#include "tools/cli/path_name.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng::bench {

double skin_error(std::span<const Affine> got, std::span<const AffineT<double>> wanted, double size) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (got.size() != wanted.size()) return kInfinity;
    double worst = 0;
    for (size_t entry = 0; entry < got.size(); ++entry)
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 4; ++column) {
                const double difference = std::abs(got[entry].row[row][column] - wanted[entry].row[row][column]);
                if (!(difference >= 0)) return kInfinity;
                worst = std::max(worst, column == 3 ? difference / std::max(size, 1e-30) : difference);
            }
    return worst;
}

std::vector<AffineT<double>> skin_reference_of(const Character& character, const Playback& playback) {
    return value_of(reference_pose(character, playback)).model_from_bind;
}

double largest_error_of_some(uint32_t instance_count, const std::function<double(uint32_t instance)>& error_of) {
    const uint32_t checked = std::min(16u, instance_count);
    double worst = 0;
    for (uint32_t i = 1; i <= checked; ++i)
        worst = std::max(worst, error_of(static_cast<uint32_t>(uint64_t{instance_count} * i / checked - 1)));
    return worst;
}

std::string path_name(const Crowd& crowd) {
    std::string name;
    for (const uint32_t group : crowd.groups()) {
        const std::string of_group = tools::path_name(value_of(crowd.path(group)));
        if (name.empty()) name = of_group;
        if (name != of_group) return "both";
    }
    return name;
}

Json new_record(const Device& device, const char* bench, const std::string& configuration, const Character& character) {
    Json record = where_and_when(device.info());
    record.update({{"bench", bench},
                   {"configuration", configuration},
                   {"joints", character.rig.joint_count()},
                   {"levels", character.rig.level_count}});
    return record;
}

void UpdateTimes::take(const GpuLoad& load, Crowd& crowd, float time_step_s, const CrowdView* view) {
    load.run();
    const Stopwatch watch;
    value_of(crowd.update(time_step_s, view));
    const double host_ms = watch.elapsed_s() * 1e3;
    const StageTimes times = value_of(crowd.stage_times());
    take(credible_reading(load.gpu(), times.total(), host_ms));
    for (size_t s = 0; s < stage_names().size(); ++s) stage_ms_[s].push_back(times.ms[s]);
}

size_t UpdateTimes::count_by_host() const {
    return static_cast<size_t>(std::ranges::count(readings_, true, &Reading::by_host));
}

Spread UpdateTimes::total() const {
    std::vector<double> total_ms;
    for (const Reading& reading : readings_) total_ms.push_back(reading.ms);
    return spread_of(total_ms);
}

void UpdateTimes::add_to(Json& record) const {
    if (readings_.empty()) return;
    record["samples"] = count();
    record["ms"] = spread_json(total());
    for (size_t s = 0; s < stage_names().size(); ++s)
        if (const double ms = stage(s).median; ms > 0) record["stages"][stage_names()[s]] = ms;
}

}  // namespace throng::bench
