// Measures what a scan costs without memory: every character reads the same local transforms from shared memory and
// scans them again and again. The difference between two runs with different repeat counts is free of launching,
// loading and storing.
#include "bench/on_chip_kernel.h"
#include "bench/gpu_clock.h"
#include "bench/scan_cell.h"
#include "bench/scan_crowd.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace throng::bench {
namespace {

constexpr uint32_t kSoftwareCharacters = 256;  // more only take longer on a software device
constexpr double kRun_ms = 10;                 // how long the difference of two runs should be at least
constexpr uint32_t kMaxRepeats = 20'000;

// Iterations of an invocation's loops in `repeat_count` repeats, including those that fill shared memory.
uint64_t loop_iterations(const ScanPlan& plan, const ScanRig& rig, uint64_t repeat_count) {
    return on_chip_transforms(plan, rig) / plan.workgroup_size + 2 + repeat_count * (plan.counts.loop_iterations + 1);
}

// Empty if at least two repeats can run.
std::string unsupported_reason_of(const ScanPlan& plan, const ScanMethod& method, const ScanRig& rig,
                                  const ScanLimits& limits) {
    std::string reason = on_chip_unsupported_reason(plan, method, rig, limits);
    if (reason.empty() && loop_iterations(plan, rig, 2) > limits.loop_iterations)
        reason = "two repeats take more loop iterations than the device allows";
    return reason;
}

std::string unsupported_reason_of(const Candidate& candidate, const ScanRig& rig, const ScanLimits& limits) {
    std::string unsupported_reason;
    for (const ScanChoice& choice : candidate.choices) {
        unsupported_reason = unsupported_reason_of(plan_scan(*choice.method, rig, limits, choice.threads),
                                                   *choice.method, rig, limits);
        if (unsupported_reason.empty()) break;
    }
    return unsupported_reason;
}

// The largest joint count, up to the cell's, at which every candidate that can run at all can run. All candidates get
// the same count, so that they can be compared.
uint32_t common_joint_count(const ScanCell& cell, std::span<const Candidate> candidates, const ScanLimits& limits) {
    const auto rig_of = [&](uint32_t joints) {
        ScanCell smaller = cell;
        smaller.joints = joints;
        return smaller.rig();
    };
    uint32_t fitting = cell.shape == SkeletonShape::kRandom ? cell.levels : 1, too_many = cell.joints + 1;
    const ScanRig smallest = rig_of(fitting);
    std::vector<Candidate> able;
    for (const Candidate& candidate : candidates)
        if (unsupported_reason_of(candidate, smallest, limits).empty()) able.push_back(candidate);
    while (fitting + 1 < too_many) {
        const uint32_t middle = fitting + (too_many - fitting) / 2;
        const ScanRig rig = rig_of(middle);
        const bool fits = std::all_of(able.begin(), able.end(), [&](const Candidate& candidate) {
            return unsupported_reason_of(candidate, rig, limits).empty();
        });
        (fits ? fitting : too_many) = middle;
    }
    return fitting;
}

// One choice, as compiled for this measurement.
class OnChipRunner {
public:
    OnChipRunner(const std::shared_ptr<Gpu>& gpu, const GpuClock& clock, const ScanChoice& choice, ScanPlan plan,
                 const ScanRig& rig, uint32_t character_count, const PoseSet& pose)
        : gpu_(gpu),
          clock_(&clock),
          choice_(choice),
          plan_(std::move(plan)),
          rig_(rig),
          character_count_(character_count) {
        const auto storage = [&](const char* what, uint64_t size_bytes) {
            return Buffer(gpu, what, size_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        };
        links_ = upload(gpu, "scan links", plan_.links);
        // All characters read these
        local_ = upload(gpu, "local transforms", pose.bytes(0, 1, ScanLayout::kCharacterMajor, choice.method->format));
        model_ = storage("model matrices", matrix_count() * sizeof(Affine));
        scratch_ = storage("scratch", sizeof(Affine));
        for (const bool barriers_twice : {false, true})
            kernels_[barriers_twice] = on_chip_kernel(gpu, *choice.method, plan_, rig, barriers_twice);
        bindings_ = kernels_[0].bind(BufferTable{{io::kLocalBuffer, local_},
                                                 {io::kScanLinksBuffer, links_},
                                                 {io::kModelBuffer, model_},
                                                 {io::kScratchBuffer, scratch_}});
    }

    const ScanPlan& plan() const { return plan_; }

    // The error after `repeat_count` repeats; NaN if the run has ended early.
    double max_error(const PoseSet& pose, uint32_t repeat_count) const {
        gpu_->submit_and_wait([&](VkCommandBuffer commands) {
            gpu_->vk.vkCmdFillBuffer(commands, model_.handle(), 0, VK_WHOLE_SIZE, 0xFFFFFFFF);
        });
        run_ms(repeat_count, false);
        const std::vector<Affine> model = download<Affine>(gpu_, model_);
        return bench::max_error(model, pose, 0, character_count_, choice_.method->layout);
    }

    // The most repeats that are timed.
    uint32_t longest_run() const { return 2 * repeat_count_; }

    // Finds the repeat count, and warms up both kernels.
    void calibrate() {
        for (const bool barriers_twice : {false, true}) run_ms(1, barriers_twice);
        // The device silently ends loops after a limit of iterations: runs of twice the repeats must stay below it.
        const auto can_double = [&] {
            return 2 * repeat_count_ <= kMaxRepeats &&
                   loop_iterations(plan_, rig_, 4 * uint64_t{repeat_count_}) <= scan_limits(*gpu_).loop_iterations / 2;
        };
        while (can_double() && run_ms(repeat_count_, false) < kRun_ms) repeat_count_ *= 2;
    }

    double ns_per_joint(bool barriers_twice) const {
        const double once_ms = run_ms(repeat_count_, barriers_twice),
                     twice_ms = run_ms(2 * repeat_count_, barriers_twice);
        return (twice_ms - once_ms) * 1e6 / (static_cast<double>(matrix_count()) * repeat_count_);
    }

private:
    uint64_t matrix_count() const { return uint64_t{character_count_} * rig_.joint_count(); }

    double run_ms(uint32_t repeat_count, bool barriers_twice) const {
        const uint32_t workgroups = (character_count_ + plan_.instances_per_workgroup - 1) /
                                    plan_.instances_per_workgroup;
        return clock_->time_ms([&](VkCommandBuffer commands) {
            kernels_[barriers_twice].dispatch_workgroups(
                commands, bindings_, io::ScanPush{rig_.joint_count(), character_count_, repeat_count}, workgroups);
        });
    }

    std::shared_ptr<Gpu> gpu_;
    const GpuClock* clock_;
    ScanChoice choice_;
    ScanPlan plan_;
    ScanRig rig_;
    uint32_t character_count_, repeat_count_ = 1;
    Buffer links_, local_, model_, scratch_;
    std::array<Kernel, 2> kernels_;  // [barriers issued twice]
    Bindings bindings_;
};

struct CheckedOnChip : ScanCheck {
    std::optional<OnChipRunner> runner;
    std::vector<double> ns, barriers_twice_ns;  // a joint

    void sample() {
        ns.push_back(runner->ns_per_joint(false));
        if (counts.barriers > 0) barriers_twice_ns.push_back(runner->ns_per_joint(true));
    }
};

CheckedOnChip check(const std::shared_ptr<Gpu>& gpu, const GpuClock& clock, const Candidate& candidate,
                    const ScanRig& rig, uint32_t character_count, const PoseSet& pose) {
    CheckedOnChip checked;
    double best_ns = std::numeric_limits<double>::infinity();
    for (const ScanChoice& choice : candidate.choices) {
        ScanPlan plan = plan_scan(*choice.method, rig, scan_limits(*gpu), choice.threads);
        if (const std::string unsupported_reason = unsupported_reason_of(plan, *choice.method, rig, scan_limits(*gpu));
            !unsupported_reason.empty()) {
            checked.unsupported_reason = unsupported_reason;
            continue;
        }
        OnChipRunner runner(gpu, clock, choice, std::move(plan), rig, character_count, pose);
        double max_error = runner.max_error(pose, 2), ns = 0;
        if (!is_wrong(max_error)) {
            runner.calibrate();
            max_error = runner.max_error(pose, runner.longest_run());
        }
        if (!is_wrong(max_error)) {
            ns = runner.ns_per_joint(false);
            if (ns >= best_ns) continue;
        }
        best_ns = ns;
        checked.choice = choice;
        checked.counts = runner.plan().counts;
        checked.workgroup_size = runner.plan().workgroup_size;
        checked.max_error = max_error;
        checked.runner = std::move(runner);
        if (is_wrong(max_error)) break;
    }
    return checked;
}

Json record_of(const Candidate& candidate, const CheckedOnChip& checked, const Json& cell_record) {
    Json record = describe_check(cell_record, candidate, checked);
    if (!checked.runs()) return record;
    const Spread ns = spread_of(checked.ns), barriers_twice_ns = spread_of(checked.barriers_twice_ns);
    record.update({{"samples", checked.ns.size()},
                   {"on_chip_ns_per_joint", ns.median},
                   {"on_chip_p5", ns.p5},
                   {"on_chip_p95", ns.p95},
                   {"barrier_share",
                    checked.barriers_twice_ns.empty() ? 0 : (barriers_twice_ns.median - ns.median) / ns.median}});
    return record;
}

}  // namespace

std::vector<Json> measure_on_chip(const std::shared_ptr<Gpu>& gpu, ScanCell cell, std::span<const Candidate> candidates,
                                  const Sampling& sampling, const Progress& progress) {
    const Stopwatch watch;
    const GpuClock clock(gpu);
    cell.joints = common_joint_count(cell, candidates, scan_limits(*gpu));
    if (gpu->is_cpu()) cell.characters = std::min(cell.characters, kSoftwareCharacters);
    const ScanRig rig = cell.rig();
    const PoseSet pose(rig, 1, cell.seed);

    std::vector<CheckedOnChip> checked = check_all(candidates, progress, [&](const Candidate& candidate) {
        return check(gpu, clock, candidate, rig, cell.characters, pose);
    });

    std::vector<TimedRun> timed_runs;
    for (size_t i = 0; i < candidates.size(); ++i)
        if (checked[i].runs()) timed_runs.push_back({candidates[i].name, [&one = checked[i]] { one.sample(); }});
    run_rounds(timed_runs, sampling, sampling.budget_s - watch.elapsed_s(), progress);

    const Json cell_record = describe_cell(cell, rig, gpu->info);
    std::vector<Json> records;
    for (size_t i = 0; i < candidates.size(); ++i) records.push_back(record_of(candidates[i], checked[i], cell_record));
    return records;
}

}  // namespace throng::bench
