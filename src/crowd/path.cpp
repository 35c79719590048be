#include "crowd/path.h"

#include "base/failure.h"
#include "scan/scan_planner.h"

namespace throng {
namespace {

// A method by name, with the threads asked for or the first ones that apply.
FusedPlan plan_named(const std::string& wanted, const FusedRig& rig, const ScanLimits& limits) {
    const ScanRequest request = parse_scan_request(wanted);
    if (request.threads) return plan_fused({request.method, *request.threads}, rig, limits);
    FusedPlan plan{.unsupported_reason = wanted + " does not apply on this device"};
    for (const uint32_t threads : request.method->thread_choices(limits)) {
        plan = plan_fused({request.method, threads}, rig, limits);
        if (plan.unsupported_reason.empty()) break;
    }
    return plan;
}

// Why a group cannot be fused, whatever its character and the device; empty where it can.
std::string staged_only(const CrowdGroup& group) {
    if (group.procedural) return "procedural rules need the local transforms in memory";
    if (group.controller)
        for (const ControllerLayer& layer : group.controller->layers)
            if (layer.model_space_rotations) return "layer '" + layer.name + "' blends rotations in model space";
    return {};
}

// A native device walks hierarchies in one way.
PathChoice native_path(const CrowdSettings& settings, const CrowdGroup& group) {
    const std::string serial = "serial";
    if (settings.scan != "auto" && settings.scan != serial)
        throw Failure(ErrorCode::kUnsupported, group.character->name + ": scan method '" + settings.scan + "'",
                      "on a native device there is only '" + serial + "'");
    return {.fused = {},
            .scan = {parse_scan_request(serial).method, 1},
            .scan_reason = "the one that a native device has",
            .path_reason = "staged: asked for"};
}

}  // namespace

PathChoice choose_path(const Gpu& gpu, const CrowdSettings& settings, const CrowdGroup& group) {
    if (gpu.is_native()) return native_path(settings, group);
    const Character& character = *group.character;
    const ScanLimits limits = scan_limits(gpu);
    const bool any_scan = settings.scan == "auto";
    std::string unsupported_reason = "asked for";
    if (const std::string reason = staged_only(group); settings.path != UpdatePath::kStaged && !reason.empty()) {
        if (settings.path == UpdatePath::kFused)
            throw Failure(ErrorCode::kUnsupported, character.name + ": fused update", reason);
        unsupported_reason = reason;
    } else if (settings.path != UpdatePath::kStaged) {
        const FusedRig rig(character);
        FusedPlan plan = any_scan ? choose_fused(rig, limits) : plan_named(settings.scan, rig, limits);
        if (plan.unsupported_reason.empty()) {
            const ScanChoice scan = plan.choice;
            return {.fused = std::move(plan),
                    .scan = scan,
                    .scan_reason = any_scan ? "the one that suits a fused update on this kind of device" : "asked for",
                    .path_reason = "fused: all stages in one pass"};
        }
        if (settings.path == UpdatePath::kFused)
            throw Failure(ErrorCode::kUnsupported, character.name + ": fused update", plan.unsupported_reason);
        unsupported_reason = plan.unsupported_reason;
    }
    const ExplainedChoice staged = choose_scan(settings.scan,
                                               ScanRig(character.rig.parents, character.rig.uniform_scale),
                                               group.instance_count, limits, scan_costs(gpu));
    return {.fused = {},
            .scan = staged.choice,
            .scan_reason = staged.reason,
            .path_reason = "staged: " + unsupported_reason};
}

}  // namespace throng
