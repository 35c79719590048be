#include "scan/scan_planner.h"

#include "base/failure.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace throng {
namespace {

std::string milliseconds_text(double ms) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g ms", ms);
    return text;
}

std::string join_names() {
    std::string names = "auto";
    for (const ScanMethod& row : scan_table()) names += ", " + std::string(row.name);
    return names;
}

// Predictions for one method, for each number of threads with which it applies.
std::vector<ScanPrediction> predict_method(const ScanMethod& method, const ScanRig& rig, uint32_t instance_count,
                                           const ScanLimits& limits, const ScanCosts& costs) {
    std::vector<ScanPrediction> out;
    for (const uint32_t threads : planned_choices(method, limits)) {
        const ScanPlan plan = plan_scan(method, rig, limits, threads);
        if (plan.unsupported_reason.empty())
            out.push_back({{&method, threads}, predict_ms(plan, rig, method, instance_count, limits, costs)});
    }
    return out;
}

}  // namespace

ScanRequest parse_scan_request(const std::string& wanted) {
    const std::string place = "scan method '" + wanted + "'";
    const size_t colon = wanted.find(':');
    ScanRequest request{find_scan_method(wanted.substr(0, colon)), std::nullopt};
    if (!request.method) throw Failure(ErrorCode::kInvalidArgument, place, "unknown; the methods are: " + join_names());
    if (colon == std::string::npos) return request;
    const char *first = wanted.data() + colon + 1, *end = wanted.data() + wanted.size();
    uint32_t threads = 0;
    const auto [stop, error] = std::from_chars(first, end, threads);
    if (error != std::errc() || stop != end)
        throw Failure(ErrorCode::kInvalidArgument, place,
                      "the colon must be followed by the number of invocations a character");
    request.threads = threads;
    return request;
}

double predict_ms(const ScanPlan& plan, const ScanRig& rig, const ScanMethod& method, uint32_t instance_count,
                  const ScanLimits& limits, const ScanCosts& costs) {
    const double workgroups = std::ceil(static_cast<double>(instance_count) / plan.instances_per_workgroup);
    // Per workgroup
    const double subgroups = std::ceil(static_cast<double>(plan.workgroup_size) / limits.subgroup_size);
    const ScanCounts& counts = plan.counts;

    const double row_ns = costs.row_ns * (counts.scattered ? costs.scattered_rows : 1);
    const double workgroup_ns = costs.workgroup_ns + counts.barriers * subgroups * costs.barrier_ns +
                                plan.instances_per_workgroup *
                                    (counts.issue_steps * costs.multiplication_ns + counts.issue_rows * row_ns);
    const double issue_ns = std::ceil(workgroups / costs.units) * workgroup_ns;
    // Subgroups wider than limits.subgroup_size take this many passes for each instruction
    const double passes = std::max(1.0, static_cast<double>(plan.subgroup_size) / limits.subgroup_size);
    const double latency_ns = std::ceil(workgroups * subgroups / costs.resident_subgroups) * counts.longest_thread *
                              passes * (kRowsOfAffine * row_ns + costs.latency_ns);
    const double bytes_a_joint = 16 * ((method.format == ScanFormat::kSimilarity ? kRowsOfSimilarity : kRowsOfAffine) +
                                       kRowsOfAffine) +
                                 counts.split_bytes();
    const double memory_ns = bytes_a_joint * rig.joint_count() * instance_count / costs.bytes_per_ns;
    // The three overlap, but not completely. This also makes the planner choose, of two methods that are equally bound
    // by memory, the one with less other work.
    constexpr double kNotOverlapped = 0.05;
    const double longest_ns = std::max({issue_ns, latency_ns, memory_ns});
    return costs.launch_ms + 1e-6 * (longest_ns + kNotOverlapped * (issue_ns + latency_ns + memory_ns - longest_ns));
}

std::vector<ScanPrediction> predict_scans(const ScanRig& rig, uint32_t instance_count, const ScanLimits& limits,
                                          const ScanCosts& costs) {
    std::vector<ScanPrediction> all;
    for (const ScanMethod& method : scan_table()) {
        if (method.layout != ScanLayout::kCharacterMajor) continue;
        const std::vector<ScanPrediction> of_method = predict_method(method, rig, instance_count, limits, costs);
        all.insert(all.end(), of_method.begin(), of_method.end());
    }
    std::ranges::stable_sort(all, {}, &ScanPrediction::milliseconds);
    return all;
}

std::string name_of(const ScanChoice& choice) {
    return std::string(choice.method->name) + (choice.threads == 0 ? "" : ":" + std::to_string(choice.threads));
}

ExplainedChoice choose_scan(const std::string& wanted, const ScanRig& rig, uint32_t instance_count,
                            const ScanLimits& limits, const ScanCosts& costs) {
    const std::string subject = std::to_string(instance_count) + " x " + std::to_string(rig.joint_count()) +
                                " joints, " + std::to_string(rig.level_count) + " levels";
    if (wanted != "auto") {
        const ScanRequest request = parse_scan_request(wanted);
        ScanChoice choice{request.method, request.threads.value_or(0)};
        if (choice.method->layout != ScanLayout::kCharacterMajor)
            throw Failure(
                ErrorCode::kUnsupported, "scan method '" + wanted + "'",
                "works on transposed poses, which no other stage writes; it runs in 'throng bench scan' only");
        if (!request.threads) {
            const std::vector<ScanPrediction> of_method = predict_method(*choice.method, rig, instance_count, limits,
                                                                         costs);
            const auto fastest = std::ranges::min_element(of_method, {}, &ScanPrediction::milliseconds);
            if (fastest != of_method.end()) choice = fastest->choice;
        }
        const ScanPlan plan = plan_scan(*choice.method, rig, limits, choice.threads);
        if (!plan.unsupported_reason.empty())
            throw Failure(ErrorCode::kUnsupported, "scan method '" + wanted + "'", plan.unsupported_reason);
        return {choice, "asked for; predicted " +
                            milliseconds_text(predict_ms(plan, rig, *choice.method, instance_count, limits, costs)) +
                            " for " + subject};
    }
    const std::vector<ScanPrediction> all = predict_scans(rig, instance_count, limits, costs);
    if (all.empty())
        throw Failure(ErrorCode::kUnsupported, "scan method 'auto'",
                      "no method applies to " + subject + " on this device");
    const auto next = std::find_if(
        all.begin(), all.end(), [&](const ScanPrediction& p) { return p.choice.method != all.front().choice.method; });
    const std::string comparison = next == all.end() ? "no other method applies"
                                                     : "next " + name_of(next->choice) + " with " +
                                                           milliseconds_text(next->milliseconds);
    return {all.front().choice, "predicted " + milliseconds_text(all.front().milliseconds) + " for " + subject + "; " +
                                    comparison + " (costs: " + costs.origin + ")"};
}

}  // namespace throng
