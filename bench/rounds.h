// Interleaved rounds: A B C A B C …, so that whatever disturbs the machine disturbs all runs alike.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace throng::bench {

class Stopwatch {
public:
    double elapsed_s() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct Sampling {
    uint32_t samples = 15;
    uint32_t min_samples = 3;  // even if it is too slow for the budget
    double budget_s = 0;       // for checking and timing
};

struct TimedRun {
    std::string name;
    std::function<void()> sample;  // does the work once, and keeps its time
};

using Progress = std::function<void(const std::string&)>;

// Runs rounds until each run has all its samples, or has the least number of them and has used up its share of
// `time_s`.
void run_rounds(std::span<const TimedRun> timed_runs, const Sampling& sampling, double time_s,
                const Progress& progress);
// All samples, however long they take.
void run_rounds(std::span<const TimedRun> timed_runs, uint32_t samples, const Progress& progress);

}  // namespace throng::bench
