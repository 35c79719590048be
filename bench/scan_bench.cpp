#include "bench/scan_bench.h"

#include "base/failure.h"
#include "bench/scan_cell.h"
#include "scan/scan_planner.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace throng::bench {
namespace {

std::vector<ScanCell> cells_of(const std::string& experiment, const ScanBenchSettings& settings) {
    std::vector<ScanCell> cells;
    const auto add = [&](uint32_t characters, uint32_t joints, uint32_t levels,
                         SkeletonShape shape = SkeletonShape::kRandom) {
        cells.push_back({experiment, shape, characters, joints, levels, settings.seed});
    };
    const bool quick = settings.quick;
    if (experiment == "levels" || experiment == "on_chip") {
        // The paper's experiment, with our own values; on-chip cells have the same skeletons
        for (const uint32_t levels : settings.levels) {
            add(settings.characters, settings.joints, levels, settings.shape);
            if (settings.shape != SkeletonShape::kRandom) break;  // the joints alone decide
        }
    } else if (experiment == "joints") {
        for (uint32_t joints = 16; joints <= 4096; joints *= quick ? 16 : 2)
            add((quick ? 30'000 : 300'000) / joints, joints, std::min(30u, joints));
    } else if (experiment == "characters") {
        for (uint32_t characters = 1; characters <= (quick ? 1'000u : 100'000u); characters *= quick ? 1000 : 10)
            add(characters, 64, 15);
    } else if (experiment == "grid") {
        // Where the planner is compared with the fastest method
        for (const uint32_t characters : {100u, 1'000u, 10'000u})
            for (const uint32_t joints : {32u, 100u, 300u, 1'000u})
                for (const uint32_t levels : {15u, 30u, 60u, 120u})
                    if (levels <= joints) add(characters, joints, levels);
    }
    if (cells.empty()) {
        const bool is_known = std::ranges::count(scan_experiments(), experiment) > 0;
        refuse("experiment '" + experiment + "'",
               is_known ? "there are no levels to run" : "no experiment has this name");
    }
    return cells;
}

std::vector<ScanCell> cells_of(const ScanBenchSettings& settings) {
    std::vector<ScanCell> cells;
    for (const std::string& experiment : settings.experiments) {
        const std::vector<ScanCell> more = cells_of(experiment, settings);
        cells.insert(cells.end(), more.begin(), more.end());
    }
    for (const ScanCell& cell : cells) {
        if (cell.characters < 1) refuse("characters", "there must be at least 1");
        make_skeleton(cell.shape, cell.joints, cell.levels, cell.seed);
    }
    return cells;
}

std::string label(const ScanCell& cell) {
    if (cell.experiment == "joints") return std::to_string(cell.joints) + " joints";
    if (cell.experiment == "characters") return std::to_string(cell.characters) + " characters";
    const std::string levels = "levels " + std::to_string(cell.rig().level_count);
    if (cell.experiment == "levels") return levels;
    if (cell.experiment == "on_chip") return "on-chip, " + levels;
    return std::to_string(cell.characters) + " x " + std::to_string(cell.joints) + " joints, " + levels;
}

// "name" with each number of threads that the device allows, or "name:threads".
Candidate candidate(const std::string& text, const ScanLimits& limits) {
    const auto [method, wanted] = parse_scan_request(text);
    std::vector<uint32_t> threads = method->thread_choices(limits);
    if (wanted) {
        const bool is_choice = std::find(threads.begin(), threads.end(), *wanted) != threads.end();
        if (!is_choice)
            refuse("scan method '" + text + "'",
                   plan_scan(*method, ScanRig(std::vector{kNone}, true), limits, *wanted).unsupported_reason);
        threads = {*wanted};
    }
    if (threads.empty()) threads = {0};  // plan_scan() says why not
    Candidate out{.name = std::string(method->name)};
    for (const uint32_t count : threads) out.choices.push_back({method, count});
    return out;
}

std::vector<Candidate> candidates_of(const ScanBenchSettings& settings, const ScanLimits& limits) {
    std::vector<Candidate> candidates;
    for (const std::string& method : settings.methods) candidates.push_back(candidate(method, limits));
    if (settings.methods.empty())
        for (const ScanMethod& method : scan_table()) candidates.push_back(candidate(std::string(method.name), limits));
    return candidates;
}

constexpr const char* kAuto = "auto";

bool is_choice(const Json& record, const ScanChoice& choice) {
    return record.value("method", "") == choice.method->name && record.value("threads", 0u) == choice.threads &&
           record.contains("median_ms");
}

// The cell's records, and one more for the planner's choice: a copy of the record of the same choice if there is one,
// so that a kernel is not compared with itself, else one measured in the same rounds.
std::vector<Json> measure_with_planner(const std::shared_ptr<Gpu>& gpu, const ScanCell& cell,
                                       std::vector<Candidate> candidates, const Sampling& sampling,
                                       const Progress& progress) {
    const ScanChoice chosen =
        choose_scan(kAuto, cell.rig(), cell.characters, scan_limits(*gpu), scan_costs(*gpu)).choice;
    // A method with a choice of threads has a row only for its fastest choice.
    const bool has_row = chosen.threads == 0 &&
                         std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& candidate) {
                             return candidate.choices.front().method == chosen.method;
                         });
    if (!has_row) candidates.push_back({kAuto, {chosen}});
    std::vector<Json> records = measure_scans(gpu, cell, candidates, sampling, progress);
    if (!has_row &&
        std::any_of(records.begin(), records.end() - 1, [&](const Json& record) { return is_choice(record, chosen); }))
        records.pop_back();
    if (records.back()["method"] != kAuto) {
        const auto row = std::find_if(records.begin(), records.end(),
                                      [&](const Json& record) { return is_choice(record, chosen); });
        if (row == records.end()) return records;  // the method is wrong, which its own record says
        records.push_back(Json(*row));
        records.back()["method"] = kAuto;
    }
    records.back()["chosen"] = name_of(chosen);
    return records;
}

// The time of a cell relative to others: a constant part for compiling kernels, and a part that grows with the number
// of transforms.
double weight(const ScanCell& cell) {
    return cell.experiment == "on_chip" ? 10 : 2 + 1e-5 * cell.characters * cell.joints;
}

std::string time_left(double seconds) {
    if (seconds < 50) return "less than a minute left";
    return "about " + std::to_string(std::lround(std::ceil(seconds / 60))) + " min left";
}

}  // namespace

std::vector<std::string> scan_experiments() { return {"levels", "joints", "characters", "on_chip", "grid"}; }
std::vector<std::string> default_scan_experiments() { return {"levels", "joints", "characters", "on_chip"}; }

void run_scan_bench(const Device& device, const ScanBenchSettings& settings, const Progress& progress,
                    const std::function<void(std::span<const Json>)>& cell_done) {
    const std::shared_ptr<Gpu>& gpu = device.gpu();
    const std::vector<ScanCell> cells = cells_of(settings);
    const std::vector<Candidate> candidates = candidates_of(settings, scan_limits(*gpu));

    const Stopwatch watch;
    const double all_weight = std::accumulate(cells.begin(), cells.end(), 0.0,
                                              [](double sum, const ScanCell& cell) { return sum + weight(cell); });
    double done_weight = 0, done_s = 0;
    for (const ScanCell& cell : cells) {
        // Each cell gets its share of the remaining budget; the time of the cells so far predicts the time of the rest.
        const double left_weight = all_weight - done_weight;
        Sampling sampling = settings.sampling;
        sampling.budget_s = std::max(0.0, settings.sampling.budget_s - done_s) * weight(cell) / left_weight;
        const double s_per_weight = done_weight > 0 ? done_s / done_weight : settings.sampling.budget_s / all_weight;
        const Progress cell_progress = [&](const std::string& text) {
            const double cell_left_s = std::max(0.0, s_per_weight * weight(cell) - (watch.elapsed_s() - done_s));
            progress(label(cell) + ": " + text + "; " +
                     time_left(cell_left_s + s_per_weight * (left_weight - weight(cell))));
        };
        cell_done(cell.experiment == "on_chip" ? measure_on_chip(gpu, cell, candidates, sampling, cell_progress)
                                               : measure_with_planner(gpu, cell, candidates, sampling, cell_progress));
        done_weight += weight(cell);
        done_s = watch.elapsed_s();
    }
}

}  // namespace throng::bench
