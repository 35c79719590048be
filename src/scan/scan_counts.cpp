#include "scan/scan_counts.h"

#include <algorithm>
#include <numeric>

namespace throng {

double ScanCounts::split_bytes() const {
    constexpr double kSplitLines_bytes = 157, kRun_bytes = 77, kLongRun = 32;
    const double more_runs = run_joints > 0 ? std::max(0.0, 1 / run_joints - 1 / kLongRun) : 0;  // per joint
    return (splits_lines ? kSplitLines_bytes : 0) + kRun_bytes * more_runs;
}

ScanCounter::ScanCounter(uint32_t threads, uint32_t subgroup_size)
    : threads_(threads), subgroup_size_(std::max(subgroup_size, 1u)) {
    loop_iterations_.resize((threads_ + subgroup_size_ - 1) / subgroup_size_);
}

ScanCounter::Trips ScanCounter::phase(std::span<const uint32_t> multiplications, uint32_t fixed_moves) {
    return phase(multiplications, std::vector<uint32_t>(multiplications.size(), fixed_moves));
}

ScanCounter::Trips ScanCounter::phase(std::span<const uint32_t> multiplications, std::span<const uint32_t> moves) {
    counts_.multiplications += std::accumulate(multiplications.begin(), multiplications.end(), uint64_t{0});
    std::vector<uint32_t> per_thread(std::min<size_t>(threads_, multiplications.size()));
    for (size_t item = 0; item < multiplications.size(); ++item) per_thread[item % threads_] += multiplications[item];
    Trips trips;
    if (!per_thread.empty()) counts_.longest_thread += *std::max_element(per_thread.begin(), per_thread.end());
    for (size_t stride = 0; stride < multiplications.size(); stride += threads_) {
        const size_t end = std::min<size_t>(stride + threads_, multiplications.size());
        for (size_t first = stride; first < end; first += subgroup_size_) {
            const auto largest = [&](std::span<const uint32_t> values) {
                const auto of_subgroup = values.subspan(first, std::min<size_t>(subgroup_size_, end - first));
                return *std::max_element(of_subgroup.begin(), of_subgroup.end());
            };
            const uint32_t longest = largest(multiplications), most_moves = largest(moves);
            counts_.issue_steps += longest;
            counts_.issue_rows += longest * (kRowsOfAffine + kRowsOfLink) + most_moves * kRowsOfAffine;
            trips.strides += longest + most_moves > 0 ? 1 : 0;
            trips.multiplications += longest;
            // The iteration of the stride itself, and the test that ends the inner loop
            loop_iterations_[(first - stride) / subgroup_size_] += longest + 2;
        }
    }
    for (uint64_t& iterations : loop_iterations_) ++iterations;  // the test that ends the loop over strides
    counts_.loop_iterations = *std::max_element(loop_iterations_.begin(), loop_iterations_.end());
    const auto subgroups = static_cast<double>(loop_iterations_.size());
    return {trips.strides / subgroups, trips.multiplications / subgroups};
}

void ScanCounter::loops(std::string_view strides, std::string_view multiplications, const Trips& trips) {
    loop(strides, trips.strides);
    loop(multiplications, trips.multiplications);
}

}  // namespace throng
