// Chooses a scan method and its number of threads for a skeleton, a number of characters and a device, by a cost model:
// the time is that of a launch plus the longest of issue time, exposed latency, and memory time.
#pragma once

#include "scan/scan.h"
#include "scan/scan_costs.h"

#include <optional>
#include <string>
#include <vector>

namespace throng {

struct ScanPrediction {
    ScanChoice choice;
    double milliseconds = 0;
};

double predict_ms(const ScanPlan& plan, const ScanRig& rig, const ScanMethod& method, uint32_t instance_count,
                  const ScanLimits& limits, const ScanCosts& costs);

// Predictions for every method that applies and that the pipeline can use (character-major), with each number of
// threads; the fastest first.
std::vector<ScanPrediction> predict_scans(const ScanRig& rig, uint32_t instance_count, const ScanLimits& limits,
                                          const ScanCosts& costs);

// "subgroup:8", or the name alone if the method has no choice of threads.
std::string name_of(const ScanChoice& choice);

// "subgroup" or "subgroup:8". Throws kInvalidArgument if there is no such method, or if no number follows the colon.
struct ScanRequest {
    const ScanMethod* method = nullptr;
    std::optional<uint32_t> threads;
};
ScanRequest parse_scan_request(const std::string& wanted);

struct ExplainedChoice {
    ScanChoice choice;
    std::string reason;  // one line
};

// `wanted` is "auto", a method's name, or a name with threads: "subgroup:8". For a name without threads, chooses the
// fastest number of threads. Throws kInvalidArgument if the name is unknown, kUnsupported if the method does not apply.
ExplainedChoice choose_scan(const std::string& wanted, const ScanRig& rig, uint32_t instance_count,
                            const ScanLimits& limits, const ScanCosts& costs);

}  // namespace throng
