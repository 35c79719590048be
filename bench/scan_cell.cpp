#include "bench/scan_cell.h"

#include "bench/scan_crowd.h"

namespace throng::bench {

Json describe_cell(const ScanCell& cell, const ScanRig& rig, const DeviceInfo& device) {
    Json record = where_and_when(device);
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

bool ScanCheck::runs() const { return choice && !is_wrong(max_error); }

Json describe_check(const Json& cell_record, const Candidate& candidate, const ScanCheck& check) {
    Json record = cell_record;
    record["method"] = candidate.name;
    if (!check.choice) {
        record["unsupported_reason"] = check.unsupported_reason;
        return record;
    }
    record.update({{"threads", check.choice->threads},
                   {"multiplications", check.counts.multiplications},
                   {"longest_thread", check.counts.longest_thread},
                   {"barriers", check.counts.barriers},
                   {"shared_bytes", check.counts.shared_bytes},
                   {"workgroup_size", check.workgroup_size},
                   {"max_error", check.max_error}});  // null where it is not a number
    if (is_wrong(check.max_error)) record["wrong"] = true;
    return record;
}

}  // namespace throng::bench
