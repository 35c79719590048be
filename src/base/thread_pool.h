// A few threads that share a loop.
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

// The calling thread takes part. A call that finds the threads busy with another one runs on its own thread alone until
// they are free: many small crowds on many threads do not wait for each other.
class ThreadPool : public JobSystem {
public:
    // `concurrency` threads in all, the calling one included; 0: as many as the processor runs side by side.
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
    bool is_open_ = false;      // a thread that wakes takes part in the loop
    uint32_t taking_part_ = 0;  // threads of the pool
    bool ends_ = false;
    std::atomic<uint32_t> next_{0};
    std::vector<std::thread> threads_;
};

// Runs body(index) for each of `count` jobs, with DefaultFloats. Throws what one of them threw, when all are done.
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
