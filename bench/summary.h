// What a run has measured: a line for each time, beside the one that `throng bench isa` predicted for the device.
#pragma once

#include "bench/report/records.h"

#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace throng::bench {

struct MeasuredTime {
    std::string bench, what, variant;
    double ms = std::nan(""), p5_ms = std::nan(""), p95_ms = std::nan("");
    double predicted_ms = std::nan("");  // NaN where nothing was
    std::string note;                    // why it has no time
};

// In the records' order; of scans those of the experiment "levels". Predictions are for a machine, which is the
// record's device if that has all words of the machine's name that have digits.
std::vector<MeasuredTime> measured_times(std::span<const Json> records, std::span<const Json> predictions);

// As Markdown. Without predictions the table has no column for them, and a sentence says so.
std::string summary_text(std::span<const Json> records, std::span<const Json> predictions);

// As HTML, of benchmarks that have no section of their own; empty where there is no such record.
std::string summary_section(std::span<const Json> records);

}  // namespace throng::bench
