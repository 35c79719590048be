// ThreadPool and for_each_job(): jobs shared among threads.
#include "base/thread_pool.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <array>
#include <cfenv>
#include <chrono>
#include <latch>
#include <set>

namespace throng {
namespace {

TEST(ThreadPool, RunsEachJobOnce) {
    for (const uint32_t threads : {1u, 2u, 7u}) {
        ThreadPool pool(threads);
        EXPECT_EQ(pool.concurrency(), threads);
        for (const uint32_t count : {0u, 1u, 2u, 1000u}) {
            std::vector<std::atomic<uint32_t>> runs(count);
            for_each_job(pool, count, [&](uint32_t i) { ++runs[i]; });
            for (const std::atomic<uint32_t>& run : runs) EXPECT_EQ(run, 1u);
        }
    }
}

TEST(ThreadPool, TakesAsManyThreadsAsAskedFor) {
    ThreadPool pool(3);
    std::mutex mutex;
    std::set<std::thread::id> ids;
    std::condition_variable all_there;
    // Each job waits for the others, so that no thread can take two of them.
    for_each_job(pool, 3, [&](uint32_t) {
        std::unique_lock lock(mutex);
        ids.insert(std::this_thread::get_id());
        all_there.notify_all();
        all_there.wait(lock, [&] { return ids.size() == 3; });
    });
    EXPECT_TRUE(ids.contains(std::this_thread::get_id()));
    EXPECT_GE(ThreadPool(0).concurrency(), 1u);
}

// Whatever rounding mode the application has set for its own threads, one of which may have created the pool.
TEST(ThreadPool, JobsRoundToNearest) {
    const auto third = [] {
        volatile float three = 3;
        return 1 / three;
    };
    const float nearest = third();
    std::fesetround(FE_UPWARD);
    ThreadPool pool(2);
    std::fesetround(FE_DOWNWARD);
    const float below = third();
    std::array<float, 2> computed{};
    float computed_alone = 0;
    std::atomic<uint32_t> there = 0;
    for_each_job(pool, 2, [&](uint32_t i) {  // one per thread
        ++there;
        while (there < 2) std::this_thread::yield();
        computed[i] = third();
    });
    for_each_job(pool, 1, [&](uint32_t) { computed_alone = third(); });
    const float after = third();
    std::fesetround(FE_TONEAREST);
    EXPECT_LT(below, nearest);
    EXPECT_EQ(after, below) << "the application's thread is left as it was";
    EXPECT_EQ(computed_alone, nearest);
    for (const float one : computed) EXPECT_EQ(one, nearest);
}

TEST(ThreadPool, HasAsManyThreadsAsTheProcessMayUse) {
    uint32_t threads = 0;
    std::thread([&] {
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(static_cast<size_t>(sched_getcpu()), &one);
        ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
        threads = ThreadPool(0).concurrency();
    }).join();
    EXPECT_EQ(threads, 1u);
}

TEST(ThreadPool, TakesItsThreadsWhenAnotherCallerIsDone) {
    ThreadPool pool(2);
    std::latch begun(1), may_end(1);
    std::thread other([&] {
        for_each_job(pool, 2, [&](uint32_t i) {
            if (i == 0) begun.count_down();
            may_end.wait();
        });
    });
    begun.wait();
    std::mutex mutex;
    std::set<std::thread::id> ids;
    std::condition_variable both_there;
    for_each_job(pool, 3, [&](uint32_t i) {
        if (i == 0) {  // the other caller has the pool's threads, and returns them before this job ends
            may_end.count_down();
            other.join();
            return;
        }
        std::unique_lock lock(mutex);
        ids.insert(std::this_thread::get_id());
        both_there.notify_all();
        both_there.wait_for(lock, std::chrono::seconds(20), [&] { return ids.size() == 2; });  // timeout: failure
    });
    EXPECT_EQ(ids.size(), 2u);
}

TEST(ThreadPool, ServesCallersOnManyThreads) {
    ThreadPool pool(2);
    std::atomic<uint64_t> sum{0};
    std::vector<std::thread> callers;
    for (uint32_t caller = 0; caller < 4; ++caller)
        callers.emplace_back([&] {
            for (uint32_t loop = 0; loop < 200; ++loop) for_each_job(pool, 10, [&](uint32_t i) { sum += i; });
        });
    for (std::thread& caller : callers) caller.join();
    EXPECT_EQ(sum, 4u * 200 * 45);
}

}  // namespace
}  // namespace throng
