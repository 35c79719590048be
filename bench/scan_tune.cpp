#include "bench/scan_tune.h"

#include "base/failure.h"
#include "bench/scan_cell.h"

#include <algorithm>
#include <limits>

namespace throng::bench {
namespace {

// A method far behind the fastest of its cell is never chosen, so its error matters less.
void weigh(std::span<ScanObservation> of_cell) {
    double fastest = std::numeric_limits<double>::infinity();
    for (const ScanObservation& o : of_cell) fastest = std::min(fastest, o.milliseconds);
    for (ScanObservation& o : of_cell) o.weight = fastest / o.milliseconds;
}

}  // namespace

std::vector<ScanObservation> observe_scans(const std::shared_ptr<Gpu>& gpu, bool quick, const Progress& progress) {
    const ScanLimits limits = scan_limits(*gpu);
    std::vector<Candidate> candidates;
    for (const ScanMethod& method : scan_table())
        if (method.layout == ScanLayout::kCharacterMajor)
            for (const uint32_t threads : planned_choices(method, limits))
                candidates.push_back({name_of(ScanChoice{&method, threads}), {{&method, threads}}});

    // Crowds limited by the launch, by latency, and by throughput; fewer than `many` do not fill a GPU.
    const uint32_t many = limits.is_cpu ? 1'000 : 20'000;
    std::vector<std::pair<uint32_t, uint32_t>> rigs{{32, 8}, {300, 15}, {300, 100}, {1'000, 60}};  // joints, levels
    std::vector<uint32_t> crowds{1, 20, 300, many};
    if (quick) rigs = {{32, 8}, {300, 60}}, crowds = {1, 100};
    std::vector<ScanObservation> observations;
    for (const auto& [joints, levels] : rigs) {
        for (const uint32_t characters : crowds) {
            const ScanCell cell{.experiment = "tune", .characters = characters, .joints = joints, .levels = levels};
            const auto cell_progress = [&](const std::string& text) {
                progress(std::to_string(joints) + " joints, " + std::to_string(characters) + " characters: " + text);
            };
            const std::vector<Json> records = measure_scans(
                gpu, cell, candidates, {.samples = quick ? 3u : 7u, .min_samples = 2, .budget_s = quick ? 2.0 : 6.0},
                cell_progress);
            const size_t first = observations.size();
            for (size_t i = 0; i < candidates.size(); ++i) {
                if (records[i].contains("wrong"))
                    throw Failure(ErrorCode::kVulkan, "scan method '" + candidates[i].name + "'",
                                  "gives wrong results on this device; nothing was kept");
                const double median_ms = records[i].value("median_ms", 0.0);
                if (median_ms > 0)
                    observations.push_back({candidates[i].choices.front(), cell.rig(), characters, median_ms});
            }
            weigh(std::span(observations).subspan(first));
        }
    }
    return observations;
}

}  // namespace throng::bench
