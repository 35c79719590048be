// Whether a group is updated in one pass or stage by stage, and by which scan.
#pragma once

#include "fused/fused.h"
#include "scan/scan_planner.h"

#include <throng/crowd.h>

#include <optional>

namespace throng {

struct PathChoice {
    std::optional<FusedPlan> fused;  // none: staged; on a native device it has no plan for kernels
    bool native = false;             // UpdatePath::kNative
    bool rows = false;  // kernels read rows in place of keys, where the character has them (crowd/group_rows.h)
    ScanChoice scan;
    std::string scan_reason, path_reason;
};

// The reason as GroupPath::reason gives it.
inline std::string shown_reason(bool is_native, const std::string& path_reason) {
    return (is_native ? "native, " : "") + path_reason;
}

// The scan method of an update stage by stage. Throws as choose_path() does.
ExplainedChoice choose_scan(const Gpu& gpu, const std::string& wanted, const Rig& rig, uint32_t instance_count);
// Throws kInvalidArgument for an unknown scan and kUnsupported where what is asked for does not apply.
PathChoice choose_path(const Gpu& gpu, const CrowdSettings& settings, const CrowdGroup& group);

}  // namespace throng
