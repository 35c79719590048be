#include "bench/record.h"

#include <cstdlib>
#include <ctime>

namespace throng::bench {

Json where_and_when(const DeviceInfo& device) {
    const std::time_t now = std::time(nullptr);
    char date[16];
    std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
    const char* commit = std::getenv("THRONG_COMMIT");
    return {{"device", device.name},
            {"driver", device.driver},
            {"subgroup_size", device.subgroup_size},
            {"commit", commit ? commit : ""},
            {"date", date}};
}

Json spread_json(const Spread& spread, const std::string& unit) {
    return {{"median" + unit, spread.median}, {"p5" + unit, spread.p5}, {"p95" + unit, spread.p95}};
}

}  // namespace throng::bench
