// Records the calls to LoadHooks.
#pragma once

#include <throng/load_hooks.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>
#include <vector>

namespace throng::test {

// Expects what LoadHooks guarantees. Cancels at the poll with the number `yes_at`.
struct Listener {
    LoadHooks hooks() {
        return {.progress = [this](double part_done) { on_progress(part_done); },
                .is_cancelled = [this] { return poll(); }};
    }
    void on_progress(double part_done) {
        EXPECT_EQ(std::this_thread::get_id(), thread);
        EXPECT_TRUE(parts.empty() || part_done > parts.back()) << part_done << " after " << parts.back();
        EXPECT_GE(part_done, 0);
        EXPECT_LE(part_done, 1);
        parts.push_back(part_done);
    }
    bool poll() {
        EXPECT_EQ(std::this_thread::get_id(), thread);
        EXPECT_FALSE(said_yes) << "asked again";
        return said_yes = polls++ == yes_at;
    }

    const std::thread::id thread = std::this_thread::get_id();
    uint64_t yes_at = UINT64_MAX, polls = 0;
    bool said_yes = false;
    std::vector<double> parts{};
};

}  // namespace throng::test
