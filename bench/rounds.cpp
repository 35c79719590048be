#include "bench/rounds.h"

#include <vector>

namespace throng::bench {

void run_rounds(std::span<const TimedRun> timed_runs, const Sampling& sampling, double time_s,
                const Progress& progress) {
    const double share_s = time_s / static_cast<double>(timed_runs.size());
    std::vector<double> used_s(timed_runs.size());
    std::vector<uint32_t> taken(timed_runs.size());
    for (uint32_t round = 0; round < sampling.samples; ++round)
        for (size_t i = 0; i < timed_runs.size(); ++i) {
            // Whether one more fits, if it takes as long as those before
            const bool fits = taken[i] == 0 || used_s[i] * (taken[i] + 1) / taken[i] <= share_s;
            if (round >= sampling.min_samples && !fits) continue;
            progress(timed_runs[i].name + ", round " + std::to_string(round + 1) + " of " +
                     std::to_string(sampling.samples));
            const Stopwatch watch;
            timed_runs[i].sample();
            used_s[i] += watch.elapsed_s();
            ++taken[i];
        }
}

void run_rounds(std::span<const TimedRun> timed_runs, uint32_t samples, const Progress& progress) {
    run_rounds(timed_runs, {.samples = samples, .min_samples = samples}, 0, progress);
}

}  // namespace throng::bench
