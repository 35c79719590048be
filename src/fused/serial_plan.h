// The walk of fused/serial.comp.
#pragma once

#include "scan/scan_table.h"

#include <vector>

namespace throng {

// `fixed`: [joint_count], fused/fixed_joints.h.
ScanPlan plan_fused_serial(const ScanRig& rig, const std::vector<bool>& fixed, const ScanLimits& limits);

}  // namespace throng
