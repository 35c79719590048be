#include "crowd/path.h"

#include "base/failure.h"
#include "base/message_name.h"
#include "native/native.h"
#include "scan/scan_costs.h"
#include "scan/scan_shaders.h"

#include <throng/device.h>

#include <algorithm>

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

// As staged_only(), for native updates in one pass.
std::string natively_staged_only(const CrowdSettings& settings, const CrowdGroup& group) {
    if (std::string reason = staged_only(group); !reason.empty()) return reason;
    return native_unsupported_reason(*group.character, settings.skin_format);
}

// Why a software device's work cannot be done natively; empty if it can.
std::string natively_unsupported_reason(const PathChoice& choice, const CrowdSettings& settings,
                                        const CrowdGroup& group) {
    if (choice.fused) return natively_staged_only(settings, group);
    if (scan_shaders(choice.scan.method->name).native) return {};
    return "scan method " + std::string(choice.scan.method->name) + " runs only on Vulkan";
}

// On a native device.
PathChoice native_path(const Gpu& gpu, const CrowdSettings& settings, const CrowdGroup& group) {
    const Character& character = *group.character;
    const ExplainedChoice scan = choose_scan(gpu, settings.scan, character.rig, group.instance_count);
    PathChoice choice{.fused = {}, .native = true, .scan = scan.choice, .scan_reason = scan.reason, .path_reason = {}};
    const std::string reason = settings.path == UpdatePath::kStaged ? "asked for"
                                                                    : natively_staged_only(settings, group);
    if (reason.empty()) {
        choice.fused.emplace(FusedPlan{.unsupported_reason = {}, .choice = choice.scan});
        choice.path_reason = "fused: all stages in one pass, by " + std::string(name_of(native_isas().back()));
    } else {
        if (settings.path == UpdatePath::kFused)
            throw Failure(ErrorCode::kUnsupported, message_name(character.name) + ": fused update", reason);
        choice.path_reason = "staged: " + reason;
    }
    return choice;
}

PathChoice device_path(const Gpu& gpu, const CrowdSettings& settings, const CrowdGroup& group) {
    const Character& character = *group.character;
    const ScanLimits limits = scan_limits(gpu);
    const bool any_scan = settings.scan == "auto";
    std::string unsupported_reason = "asked for";
    if (const std::string reason = staged_only(group); settings.path != UpdatePath::kStaged && !reason.empty()) {
        if (settings.path == UpdatePath::kFused)
            throw Failure(ErrorCode::kUnsupported, message_name(character.name) + ": fused update", reason);
        unsupported_reason = reason;
    } else if (settings.path != UpdatePath::kStaged) {
        const FusedRig rig(character);
        const double subgroups_a_character = built_in_scan_costs(gpu).resident_subgroups /
                                             std::max({group.instance_count, group.capacity, 1u});
        FusedPlan plan = any_scan ? choose_fused(rig, limits, subgroups_a_character)
                                  : plan_named(settings.scan, rig, limits);
        // Poses that the application sets may have any scale, which rows cannot hold. Without rows, the form for
        // similarities ("stream_quaternion") is faster than "stream"
        const bool may_have_rows = group.pose_capacity == 0;
        if (any_scan && !may_have_rows && plan.unsupported_reason.empty() && plan.choice.method->name == "stream") {
            FusedPlan similar = plan_fused({find_scan_method("stream_quaternion"), plan.choice.threads}, rig, limits);
            if (similar.unsupported_reason.empty()) plan = std::move(similar);
        }
        if (plan.unsupported_reason.empty()) {
            const ScanChoice scan = plan.choice;
            const bool rows = !scan_shaders(scan.method->name).fused_rows.empty() && may_have_rows;
            return {.fused = std::move(plan),
                    .native = false,
                    .rows = rows,
                    .scan = scan,
                    .scan_reason = any_scan ? "the one that suits a fused update on this kind of device" : "asked for",
                    .path_reason = "fused: all stages in one pass"};
        }
        if (settings.path == UpdatePath::kFused)
            throw Failure(ErrorCode::kUnsupported, message_name(character.name) + ": fused update",
                          plan.unsupported_reason);
        unsupported_reason = plan.unsupported_reason;
    }
    const ExplainedChoice staged = choose_scan(gpu, settings.scan, character.rig, group.instance_count);
    return {.fused = {},
            .native = false,
            .scan = staged.choice,
            .scan_reason = staged.reason,
            .path_reason = "staged: " + unsupported_reason};
}

// On a Vulkan device, or natively beside it.
PathChoice vulkan_path(const Gpu& gpu, const CrowdSettings& settings, const CrowdGroup& group) {
    const bool is_native = settings.path == UpdatePath::kNative;
    if (is_native && !gpu.processor)
        throw Failure(ErrorCode::kUnsupported, message_name(group.character->name) + ": native update",
                      gpu.info.name + " is not a software device");
    if (is_native && settings.scan != "auto")
        throw Failure(ErrorCode::kUnsupported, message_name(group.character->name) + ": native update",
                      "it uses no scan method, but CrowdSettings::scan asks for '" + settings.scan + "'");
    PathChoice choice = device_path(gpu, settings, group);
    const bool may_be_native = settings.path == UpdatePath::kAuto && settings.scan == "auto";
    if (!gpu.processor || !(is_native || may_be_native)) return choice;
    if (!choice.fused && settings.scan == "auto" && !scan_shaders(choice.scan.method->name).native) {
        const ScanChoice serial{parse_scan_request("serial").method, 0};
        const Rig& rig = group.character->rig;
        if (plan_scan(*serial.method, ScanRig(rig.parents, rig.uniform_scale), scan_limits(gpu), serial.threads)
                .unsupported_reason.empty()) {
            choice.scan = serial;
            choice.scan_reason = "the one that also runs natively";
        }
    }
    const std::string reason = natively_unsupported_reason(choice, settings, group);
    if (is_native && !reason.empty())
        throw Failure(ErrorCode::kUnsupported, message_name(group.character->name) + ": native update", reason);
    choice.native = reason.empty();
    if (!choice.native) choice.path_reason += "; not native: " + reason;
    return choice;
}

// Throws where the chosen path cannot compute sockets alone.
void check_sockets_only(const PathChoice& choice, const CrowdGroup& group) {
    const std::string place = message_name(group.character->name) + ": sockets only";
    if (group.sockets.empty()) throw Failure(ErrorCode::kInvalidArgument, place, "CrowdGroup::sockets is empty");
    if (!choice.native || !choice.fused)
        throw Failure(ErrorCode::kUnsupported, place,
                      "only a native update in one pass can compute sockets alone, but this one is " +
                          shown_reason(choice.native, choice.path_reason));
}

}  // namespace

ExplainedChoice choose_scan(const Gpu& gpu, const std::string& wanted, const Rig& rig, uint32_t instance_count) {
    const bool is_first_native = gpu.is_native() && wanted == "auto";
    if (gpu.is_native() && !is_first_native && !scan_shaders(parse_scan_request(wanted).method->name).native)
        throw Failure(ErrorCode::kUnsupported, "scan method '" + wanted + "'",
                      "a native device does not have it; use 'serial'");
    ExplainedChoice chosen = choose_scan(is_first_native ? "serial" : wanted, ScanRig(rig.parents, rig.uniform_scale),
                                         instance_count, scan_limits(gpu), scan_costs(gpu));
    if (gpu.is_native())  // the costs in the reason are those of GPUs
        chosen.reason = is_first_native ? "the fastest on one thread a character" : "asked for";
    return chosen;
}

PathChoice choose_path(const Gpu& gpu, const CrowdSettings& settings, const CrowdGroup& group) {
    PathChoice choice = gpu.is_native() ? native_path(gpu, settings, group) : vulkan_path(gpu, settings, group);
    if (group.sockets_only) check_sockets_only(choice, group);
    return choice;
}

std::string native_instruction_set() {
    return native_isas().empty() ? std::string() : std::string(name_of(native_isas().back()));
}

}  // namespace throng
