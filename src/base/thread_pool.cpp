#include "base/thread_pool.h"

#include "base/processor.h"

#include <algorithm>
#include <exception>

namespace throng {

ThreadPool::ThreadPool(uint32_t concurrency) {
    if (concurrency == 0) concurrency = processor_threads();
    try {
        for (uint32_t i = 1; i < concurrency; ++i) threads_.emplace_back([this] { work(); });
    } catch (const std::exception&) {
        // The system has no more threads or memory: the threads created so far do the work
    }
}

ThreadPool::~ThreadPool() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    begun_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::run(uint32_t count, void (*job)(void* context, uint32_t index), void* context) {
    const Loop loop{count, job, context};
    std::unique_lock caller(callers_, std::defer_lock);
    uint32_t first = 0;
    // Tries for the pool before each job: if another caller's loop ends soon, this one still gets the threads
    while (first < count && (threads_.empty() || !caller.try_lock())) job(context, first++);
    if (first == count) return;
    {
        const std::lock_guard lock(mutex_);
        next_ = first;
        loop_ = loop;
        ++loop_number_;
        is_open_ = true;
    }
    for (size_t i = std::min<size_t>(count - first - 1, threads_.size()); i > 0; --i) begun_.notify_one();
    take_part(loop);
    std::unique_lock lock(mutex_);
    // Threads that the system has not woken up yet are not waited for
    is_open_ = false;
    done_.wait(lock, [this] { return taking_part_ == 0; });
}

void ThreadPool::take_part(const Loop& loop) {
    for (uint32_t i = next_++; i < loop.count; i = next_++) loop.job(loop.context, i);
}

void ThreadPool::work() {
    uint64_t seen = 0;
    std::unique_lock lock(mutex_);
    for (;;) {
        begun_.wait(lock, [&] { return ends_ || (is_open_ && loop_number_ != seen); });
        if (ends_) return;
        seen = loop_number_;
        ++taking_part_;
        const Loop loop = loop_;
        lock.unlock();
        take_part(loop);
        lock.lock();
        if (--taking_part_ == 0) done_.notify_one();
    }
}

}  // namespace throng
