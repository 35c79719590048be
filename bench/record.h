// What every record of a benchmark says of where and when it was made.
#pragma once

#include <throng/device.h>

#include <nlohmann/json_fwd.hpp>

namespace throng::bench {

// device, driver, subgroup_size, commit (of THRONG_COMMIT, or empty), date.
nlohmann::json where_and_when(const DeviceInfo& device);

}  // namespace throng::bench
