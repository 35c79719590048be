#include "bench/scan_cell.h"

#include "bench/record.h"
#include "bench/scan_crowd.h"

#include <nlohmann/json.hpp>

namespace throng::bench {

nlohmann::json describe_cell(const ScanCell& cell, const ScanRig& rig, const DeviceInfo& device) {
    nlohmann::json record = where_and_when(device);
    record.update({{"bench", "scan"},
                   {"experiment", cell.experiment},
                   {"shape", name_of(cell.shape)},
                   {"seed", cell.seed},
                   {"characters", cell.characters},
                   {"joints", rig.joint_count()},
                   {"levels", rig.level_count},
                   {"mean_depth", rig.mean_depth},
                   {"leaves", rig.leaf_count}});
    return record;
}

void add_choice(nlohmann::json& record, const ScanChoice& choice, const ScanCounts& counts) {
    record.update({{"threads", choice.threads},
                   {"multiplications", counts.multiplications},
                   {"longest_thread", counts.longest_thread},
                   {"barriers", counts.barriers},
                   {"shared_bytes", counts.shared_bytes}});
}

void add_error(nlohmann::json& record, double max_error) {
    record["max_error"] = max_error;  // null where it is not a number
    if (is_wrong(max_error)) record["wrong"] = true;
}

}  // namespace throng::bench
