// Worker threads that take work in parts. Their CPU time is the cost of the work, whatever else the machine does
// meanwhile; the wall time shows what several threads gain.
#pragma once

#include "bench/rounds.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include <time.h>

namespace throng::bench {

class CpuThreads {
public:
    explicit CpuThreads(uint32_t count) : barrier_(static_cast<ptrdiff_t>(count)) {
        for (uint32_t i = 1; i < count; ++i) threads_.emplace_back([this] { wait_for_work(); });
    }
    ~CpuThreads() {
        work_ = nullptr;
        barrier_.arrive_and_wait();
        for (std::thread& thread : threads_) thread.join();
    }
    CpuThreads(const CpuThreads&) = delete;
    CpuThreads& operator=(const CpuThreads&) = delete;

    struct Taken {
        double processor_s = 0;  // mean of the threads
        double wall_s = 0;
    };
    // Calls work(first, end) for all of 0..count - 1, in parts of `part`.
    Taken run(uint32_t count, uint32_t part, const std::function<void(uint32_t, uint32_t)>& work) {
        count_ = count;
        part_ = part;
        next_ = 0;
        work_ = &work;
        used_ns_ = 0;
        const Stopwatch watch;
        barrier_.arrive_and_wait();
        do_parts();
        barrier_.arrive_and_wait();
        return {static_cast<double>(used_ns_) * 1e-9 / static_cast<double>(threads_.size() + 1), watch.elapsed_s()};
    }

private:
    static int64_t processor_ns() {
        timespec time;
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return time.tv_sec * int64_t{1'000'000'000} + time.tv_nsec;
    }
    void wait_for_work() {
        for (;;) {
            barrier_.arrive_and_wait();
            if (!work_) return;
            do_parts();
            barrier_.arrive_and_wait();
        }
    }
    void do_parts() {
        const int64_t begin_ns = processor_ns();
        for (uint32_t first; (first = next_.fetch_add(part_)) < count_;)
            (*work_)(first, std::min(count_, first + part_));
        used_ns_ += processor_ns() - begin_ns;
    }

    std::barrier<> barrier_;
    std::atomic<uint32_t> next_ = 0;
    std::atomic<int64_t> used_ns_ = 0;
    uint32_t count_ = 0, part_ = 1;
    const std::function<void(uint32_t, uint32_t)>* work_ = nullptr;
    std::vector<std::thread> threads_;
};

}  // namespace throng::bench
