// A pool of threads that run the jobs of one loop at a time.
#pragma once

#include "base/default_floats.h"

#include <throng/jobs.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace throng {

// The calling thread takes part in its loop. While the pool is busy with another call's loop, run() works on its own
// thread alone, so that many small crowds on many threads do not wait for each other.
class ThreadPool : public JobSystem {
public:
    // `concurrency`: number of threads, including the calling one; 0: as many as the processor can run at once.
    explicit ThreadPool(uint32_t concurrency);
    ~ThreadPool() override;
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    uint32_t concurrency() const override { return static_cast<uint32_t>(threads_.size()) + 1; }
    void run(uint32_t count, void (*job)(void* context, uint32_t index), void* context) override;

private:
    struct Loop {
        uint32_t count = 0;
        void (*job)(void* context, uint32_t index) = nullptr;
        void* context = nullptr;
    };
    void work();
    void take_part(const Loop& loop);

    std::mutex callers_;  // held by the caller whose loop is running
    std::mutex mutex_;    // guards what follows, except next_
    std::condition_variable begun_, done_;
    Loop loop_;
    uint64_t loop_number_ = 0;
    bool is_open_ = false;      // threads that wake up join the current loop
    uint32_t taking_part_ = 0;  // pool threads in the current loop
    bool ends_ = false;
    std::atomic<uint32_t> next_{0};
    std::vector<std::thread> threads_;
};

// Runs body(index) for each of `count` jobs, with DefaultFloats. When all are done, rethrows the first exception.
template <class Body>
void for_each_job(JobSystem& jobs, uint32_t count, const Body& body) {
    if (count == 1) {
        const DefaultFloats floats;
        return body(0u);
    }
    struct Context {
        const Body& body;
        std::mutex mutex;
        std::exception_ptr thrown;
    } context{body, {}, {}};
    if (count > 0)
        jobs.run(
            count,
            [](void* of, uint32_t index) {
                Context& each = *static_cast<Context*>(of);
                const DefaultFloats floats;
                try {
                    each.body(index);
                } catch (...) {
                    const std::lock_guard lock(each.mutex);
                    if (!each.thrown) each.thrown = std::current_exception();
                }
            },
            &context);
    if (context.thrown) std::rethrow_exception(context.thrown);
}

}  // namespace throng
