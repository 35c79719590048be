#include "bench/record.h"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <ctime>

namespace throng::bench {

nlohmann::json where_and_when(const DeviceInfo& device) {
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

}  // namespace throng::bench
