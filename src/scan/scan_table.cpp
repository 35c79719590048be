#include "scan/scan_table.h"

#include "scan/stream_plan.h"

#include <throng/scan.h>

#include <algorithm>
#include <array>
#include <bit>

namespace throng {

#include "scan/scan_method_rows.inc"

namespace {

constexpr uint32_t kFewThreads = 256;  // the default limit: more may lower the occupancy of a GPU

}  // namespace

std::span<const ScanMethod> scan_table() {
    static const auto methods = [] {
        auto rows = scan_method_rows();
        std::ranges::sort(rows, {}, &ScanMethod::order);
        return rows;
    }();
    return methods;
}

const ScanMethod* find_scan_method(std::string_view name) {
    const auto methods = scan_table();
    const auto found = std::ranges::find(methods, name, &ScanMethod::name);
    return found == methods.end() ? nullptr : &*found;
}

std::string threads_unsupported_reason(const ScanMethod& method, const ScanLimits& limits, uint32_t threads) {
    const std::vector<uint32_t> choices = method.thread_choices(limits);
    if (choices.empty()) return "the device lacks subgroup shuffles, or its subgroups or workgroups are too small";
    if (std::find(choices.begin(), choices.end(), threads) != choices.end()) return {};
    std::string text;
    for (const uint32_t choice : choices) text += (text.empty() ? "" : ", ") + std::to_string(choice);
    return std::to_string(threads) + " invocations a character is not among the choices on this device (" + text + ")";
}

ScanPlan plan_scan(const ScanMethod& method, const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    if (method.format == ScanFormat::kSimilarity && !rig.uniform_scale)
        return {.unsupported_reason =
                    "the method needs uniform scales, and a joint of the rig has a scale that differs between axes"};
    if (std::string unsupported_reason = threads_unsupported_reason(method, limits, threads);
        !unsupported_reason.empty())
        return {.unsupported_reason = std::move(unsupported_reason)};
    ScanPlan plan = method.plan(rig, limits, threads);
    const uint64_t iterations = plan.counts.loop_iterations;
    if (iterations <= limits.loop_iterations) return plan;
    return {.unsupported_reason = std::to_string(iterations) +
                                  " loop iterations of an invocation exceed the device's " +
                                  std::to_string(limits.loop_iterations)};
}

SharedJoints::SharedJoints(uint32_t joint_count, const ScanLimits& limits) {
    const uint64_t needed_bytes = uint64_t{joint_count} * 2 * bytes_of(ScanFormat::kAffine);
    fit = needed_bytes <= limits.shared_memory_bytes;
    bytes = fit ? static_cast<uint32_t>(needed_bytes) : 0;
    constants = {fit ? joint_count : 1u, fit ? 1u : 0u};
}

uint32_t strided_workgroup_size(uint32_t joint_count, const ScanLimits& limits, uint32_t threads) {
    constexpr uint32_t kWarp = 32;
    const uint32_t step = std::max(kWarp, limits.subgroup_size), most = threads == 0 ? kFewThreads : threads;
    return std::min(std::clamp((joint_count + step - 1) / step * step, step, most), limits.workgroup_size);
}

std::vector<uint32_t> planned_choices(const ScanMethod& method, const ScanLimits& limits) {
    return (method.planned_choices ? method.planned_choices : method.thread_choices)(limits);
}

std::vector<uint32_t> strided_choices(const ScanLimits& limits) {
    std::vector<uint32_t> choices{0};
    if (limits.workgroup_size > kFewThreads) choices.push_back(limits.workgroup_size);
    return choices;
}

std::string memory_unsupported_reason(uint64_t shared_bytes, const std::string& what_for, const ScanLimits& limits) {
    if (shared_bytes <= limits.shared_memory_bytes) return {};
    return std::to_string(shared_bytes) + " bytes of shared memory" + what_for + " exceed the device's " +
           std::to_string(limits.shared_memory_bytes);
}

std::vector<uint32_t> no_thread_choice(const ScanLimits&) { return {0}; }

std::vector<ScanMethodInfo> scan_methods() {
    std::vector<ScanMethodInfo> methods;
    for (const ScanMethod& method : scan_table())
        methods.push_back({std::string(method.name), std::string(method.summary), std::string(method.source),
                           method.layout == ScanLayout::kCharacterMajor});
    return methods;
}

StreamOrder stream_order(const Rig& rig, uint32_t lanes) {
    const StreamPlan plan = plan_stream(ScanRig(rig.parents), {.lanes = std::bit_floor(std::clamp(lanes, 4u, 64u))});
    return {.lanes = plan.lanes,
            .characters = plan.characters,
            .chunks = static_cast<uint32_t>(plan.chunks.size()),
            .rounds = plan.round_count,
            .slots = plan.slots};
}

}  // namespace throng
