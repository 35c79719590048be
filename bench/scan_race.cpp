// Measures the scan as a stage: local transforms from memory, model transforms to memory.
#include "bench/frame_floors.h"
#include "bench/scan_cell.h"
#include "bench/scan_crowd.h"

#include <limits>
#include <optional>

namespace throng::bench {
namespace {

// A method's kernel, bound to each batch.
struct Runner {
    ScanStage stage;
    std::vector<Bindings> bindings;

    Runner(const std::shared_ptr<Gpu>& gpu, const ScanChoice& choice, const ScanRig& rig, ScanCrowd& crowd)
        : stage(gpu, choice, rig, scan_limits(*gpu)) {
        for (uint32_t batch = 0; batch < crowd.batch_count(); ++batch)
            bindings.push_back(stage.bind(crowd.buffers(batch, *choice.method, stage.links())));
    }
    // Records the scan of all characters, or of one in `part`.
    void record(VkCommandBuffer commands, const ScanCrowd& crowd, uint32_t part = 1) const {
        for (uint32_t batch = 0; batch < crowd.batch_count(); ++batch)
            stage.record(commands, bindings[batch], (crowd.batch(batch).instance_count + part - 1) / part);
    }
};

struct CheckedRun : ScanCheck {
    std::optional<Runner> runner;
    std::vector<double> times_ms;
};

class CopyRunner {
public:
    CopyRunner(const std::shared_ptr<Gpu>& gpu, ScanCrowd& crowd) : kernel_(copy_kernel(gpu, 64, 3)) {
        for (uint32_t batch = 0; batch < crowd.batch_count(); ++batch)
            bindings_.push_back(kernel_.bind({{0, crowd.local(batch, ScanLayout::kCharacterMajor, ScanFormat::kAffine)},
                                              {1, crowd.batch(batch).model}}));
    }
    void record(VkCommandBuffer commands, const ScanCrowd& crowd) const {
        for (uint32_t batch = 0; batch < crowd.batch_count(); ++batch)
            kernel_.dispatch(commands, bindings_[batch], static_cast<uint32_t>(crowd.row_count(batch)));
    }

private:
    RowKernel kernel_;
    std::vector<Bindings> bindings_;
};

// The kernel of the choice that is fastest here, compiled and warm; none where no choice applies, and
// `unsupported_reason` says why.
std::optional<Runner> fastest(const std::shared_ptr<Gpu>& gpu, const GpuClock& clock, const Candidate& candidate,
                              const ScanRig& rig, ScanCrowd& crowd, std::string& unsupported_reason) {
    // A software device's time is proportional to the number of characters if there are many: a part of them will do.
    constexpr uint32_t kMany = 4'000, kPart = 8, kRuns = 3;
    const uint32_t part = gpu->is_cpu() && crowd.instance_count() >= kMany ? kPart : 1;
    const auto best_of_runs_ms = [&](const Runner& runner) {
        double min_ms = std::numeric_limits<double>::infinity();
        for (uint32_t run = 0; run < kRuns; ++run)
            min_ms = std::min(min_ms,
                              clock.time_ms([&](VkCommandBuffer commands) { runner.record(commands, crowd, part); }));
        return min_ms;
    };
    std::optional<Runner> best;
    double best_ms = std::numeric_limits<double>::infinity();
    for (const ScanChoice& choice : candidate.choices) {
        unsupported_reason = plan_scan(*choice.method, rig, scan_limits(*gpu), choice.threads).unsupported_reason;
        if (!unsupported_reason.empty()) continue;
        Runner runner(gpu, choice, rig, crowd);
        // The first run compiles
        gpu->submit_and_wait([&](VkCommandBuffer commands) { runner.stage.record(commands, runner.bindings[0], 1); });
        const double time_ms = candidate.choices.size() > 1 ? best_of_runs_ms(runner) : 0;
        if (time_ms >= best_ms) continue;
        best_ms = time_ms;
        best = std::move(runner);
    }
    return best;
}

CheckedRun check(const std::shared_ptr<Gpu>& gpu, const GpuClock& clock, const Candidate& candidate, const ScanRig& rig,
                 ScanCrowd& crowd) {
    CheckedRun checked;
    checked.runner = fastest(gpu, clock, candidate, rig, crowd, checked.unsupported_reason);
    if (!checked.runner) return checked;
    const ScanStage& stage = checked.runner->stage;
    checked.choice = stage.choice();
    checked.counts = stage.counts();
    checked.workgroup_size = stage.workgroup_size();
    crowd.poison();
    gpu->submit_and_wait([&](VkCommandBuffer commands) { checked.runner->record(commands, crowd); });
    checked.max_error = crowd.max_error(stage.choice().method->layout);
    return checked;
}

Json record_of(const Candidate& candidate, const CheckedRun& checked, const Json& cell_record, double copy_ms) {
    Json record = describe_check(cell_record, candidate, checked);
    if (!checked.runs()) return record;
    const uint64_t matrix_count = record["characters"].get<uint64_t>() * record["joints"].get<uint64_t>();
    const Spread spread = spread_of(checked.times_ms);
    record.update(spread_json(spread, "_ms"));
    record.update({{"bytes", matrix_count * (bytes_of(checked.choice->method->format) + sizeof(Affine))},
                   {"samples", checked.times_ms.size()},
                   {"copy_ms", copy_ms},
                   {"times_copy", spread.median / copy_ms},
                   {"ns_per_joint", spread.median * 1e6 / static_cast<double>(matrix_count)}});
    return record;
}

}  // namespace

std::vector<Json> measure_scans(const std::shared_ptr<Gpu>& gpu, const ScanCell& cell,
                                std::span<const Candidate> candidates, const Sampling& sampling,
                                const Progress& progress) {
    const Stopwatch watch;
    const GpuClock clock(gpu);
    const ScanRig rig = cell.rig();
    progress("making " + std::to_string(cell.characters) + " characters");
    ScanCrowd crowd(gpu, rig, cell.characters, cell.seed);

    std::vector<CheckedRun> checked = check_all(
        candidates, progress, [&](const Candidate& candidate) { return check(gpu, clock, candidate, rig, crowd); });

    std::vector<double> copy_times_ms;
    std::vector<TimedRun> timed_runs;
    const auto enter = [&](const std::string& name, const auto& runner, std::vector<double>& times_ms) {
        timed_runs.push_back({name, [&] {
                                  times_ms.push_back(
                                      clock.time_ms([&](VkCommandBuffer commands) { runner.record(commands, crowd); }));
                              }});
    };
    const CopyRunner copy(gpu, crowd);
    // Warms up the copy; the check has warmed up the others
    clock.time_ms([&](VkCommandBuffer commands) { copy.record(commands, crowd); });
    enter("copy", copy, copy_times_ms);
    for (size_t i = 0; i < candidates.size(); ++i)
        if (checked[i].runs()) enter(candidates[i].name, *checked[i].runner, checked[i].times_ms);
    run_rounds(timed_runs, sampling, sampling.budget_s - watch.elapsed_s(), progress);

    const Json cell_record = describe_cell(cell, rig, gpu->info);
    const double copy_ms = spread_of(copy_times_ms).median;
    std::vector<Json> records;
    for (size_t i = 0; i < candidates.size(); ++i)
        records.push_back(record_of(candidates[i], checked[i], cell_record, copy_ms));
    return records;
}

}  // namespace throng::bench
