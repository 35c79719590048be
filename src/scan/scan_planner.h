// Chooses a scan method and its threads from the skeleton, the number of characters and the device, by a cost model:
// the time is a launch, plus the longest of what the units issue, what latency leaves unhidden, and what memory moves.
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

// Every method that can stand in the pipeline (character-major) and applies, with each number of threads; the fastest
// first.
std::vector<ScanPrediction> predict_scans(const ScanRig& rig, uint32_t instance_count, const ScanLimits& limits,
                                          const ScanCosts& costs);

// "subgroup:8", or the name alone where threads are no choice.
std::string name_of(const ScanChoice& choice);

// "subgroup" or "subgroup:8". Throws kInvalidArgument where there is no such method, or what follows the colon is no
// number.
struct ScanRequest {
    const ScanMethod* method = nullptr;
    std::optional<uint32_t> threads;
};
ScanRequest parse_scan_request(const std::string& wanted);

struct ExplainedChoice {
    ScanChoice choice;
    std::string reason;  // one line
};

// `wanted` is "auto", a method's name, or a name with threads: "subgroup:8". A name without threads gets its fastest
// ones. Throws kInvalidArgument where the name is unknown, kUnsupported where the method does not apply.
ExplainedChoice choose_scan(const std::string& wanted, const ScanRig& rig, uint32_t instance_count,
                            const ScanLimits& limits, const ScanCosts& costs);

}  // namespace throng
