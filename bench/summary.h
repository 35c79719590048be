// What a run has measured: a line for each time, beside the time that `throng bench isa` predicted for the device.
#pragma once

#include "bench/report/records.h"

#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace throng::bench {

struct MeasuredTime {
    std::string device, bench, what, variant;  // `what` and `variant` tell apart what one run on a device has measured
    double ms = std::nan(""), p5_ms = std::nan(""), p95_ms = std::nan("");
    double predicted_ms = std::nan("");  // NaN where nothing was
    std::string note;                    // why it has no time
};

// In the records' order; of the scan records only those of the experiment "levels". A prediction is for the record's
// device if the device's name has all the words with digits of the machine's name.
std::vector<MeasuredTime> measured_times(std::span<const Json> records, std::span<const Json> predictions);

// As Markdown: a heading for each device, a table for each of its benchmarks. Without predictions the tables have no
// column for them, and a sentence says so.
std::string summary_text(std::span<const Json> records, std::span<const Json> predictions);

// As HTML, for the benchmarks that have no section of their own; empty if there is no such record.
std::string summary_section(std::span<const Json> records);

}  // namespace throng::bench
