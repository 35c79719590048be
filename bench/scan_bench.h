// `throng bench scan`: the methods of the Hierarchy-Scan, checked against the reference and timed side by side.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"
#include "bench/skeletons.h"

#include <throng/device.h>

namespace throng::bench {

// The names that ScanBenchSettings::experiments takes.
std::vector<std::string> scan_experiments();
std::vector<std::string> default_scan_experiments();

struct ScanBenchSettings {
    // Names of scan_methods(), "name:threads" to fix the invocations a character; empty: all
    std::vector<std::string> methods;
    std::vector<std::string> experiments = default_scan_experiments();
    // What the experiments "levels" and "on_chip" measure.
    uint32_t characters = 10'000, joints = 300;
    std::vector<uint32_t> levels{15, 30, 45, 60, 90, 120};
    SkeletonShape shape = SkeletonShape::kRandom;
    uint64_t seed = 1;
    Sampling sampling{.budget_s = 420};  // its budget is for the whole run
    bool quick = false;                  // the other experiments have fewer cells
};

// Runs cell after cell. `progress` gets a line whenever something begins, `cell_done` the records of a cell
// (bench/README.md lists their fields). If the settings make no sense, throws before anything runs.
void run_scan_bench(const Device& device, const ScanBenchSettings& settings, const Progress& progress,
                    const std::function<void(std::span<const Json>)>& cell_done);

}  // namespace throng::bench
