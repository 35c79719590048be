// What the records of all benchmarks have in common.
#pragma once

#include "tools/cli/statistics.h"

#include <throng/device.h>

#include <nlohmann/json.hpp>

#include <string>

namespace throng::bench {

using Json = nlohmann::json;

// device, driver, subgroup_size, commit (of THRONG_COMMIT, or empty), date.
Json where_and_when(const DeviceInfo& device);

// median, p5 and p95; `unit` is appended to the names.
Json spread_json(const Spread& spread, const std::string& unit = "");

}  // namespace throng::bench
