// DirtyRanges, which stores changes as bits, against a set of numbers.
#include "crowd/dirty_ranges.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <utility>
#include <vector>

namespace throng {
namespace {

using Ranges = std::vector<std::pair<uint32_t, uint32_t>>;

Ranges pairs_of(std::span<const DirtyRanges::Range> ranges) {
    Ranges out;
    for (const auto& [first, count] : ranges) out.emplace_back(first, count);
    return out;
}

// Consecutive numbers form one range.
Ranges ranges_of(const std::set<uint32_t>& numbers) {
    Ranges out;
    for (const uint32_t number : numbers) {
        if (out.empty() || out.back().first + out.back().second != number) out.emplace_back(number, 0);
        ++out.back().second;
    }
    return out;
}

TEST(DirtyRanges, MergeWhatTouches) {
    DirtyRanges dirty;
    EXPECT_EQ(pairs_of(dirty.take()), Ranges{});
    dirty.add(5, 0);
    EXPECT_EQ(pairs_of(dirty.take()), Ranges{});
    for (const auto& [first, count] : Ranges{{10, 5}, {0, 3}, {12, 1}, {14, 4}, {20, 5}, {3, 1}, {12, 2}, {21, 1}})
        dirty.add(first, count);
    EXPECT_EQ(pairs_of(dirty.take()), (Ranges{{0, 4}, {10, 8}, {20, 5}}));
    EXPECT_EQ(pairs_of(dirty.take()), Ranges{}) << "taken twice";
}

TEST(DirtyRanges, TakenRangesCanBePutBack) {
    DirtyRanges dirty;
    dirty.add(60, 10);
    dirty.take();
    dirty.add(3, 1);
    dirty.put_back();
    EXPECT_EQ(pairs_of(dirty.pending()), (Ranges{{3, 1}, {60, 10}}));
    dirty.put_back();
    EXPECT_EQ(pairs_of(dirty.take()), (Ranges{{3, 1}, {60, 10}})) << "put back twice";
}

// 300 numbers, so that ranges begin, end and meet at every bit of a word, also beyond the highest number added so far.
TEST(DirtyRanges, MatchASetOfNumbers) {
    std::mt19937 random(1);
    const auto below = [&](uint32_t end) { return static_cast<uint32_t>(random() % end); };
    DirtyRanges dirty;
    std::set<uint32_t> numbers;
    for (int step = 0; step < 20'000; ++step) {
        const uint32_t first = below(300), count = below(3) == 0 ? below(140) : below(4);
        const bool removes = below(3) == 0;
        removes ? dirty.remove(first, count) : dirty.add(first, count);
        for (uint32_t number = first; number < first + count; ++number) {
            if (removes)
                numbers.erase(number);
            else
                numbers.insert(number);
        }
        ASSERT_EQ(pairs_of(dirty.pending()), ranges_of(numbers)) << "step " << step;
        if (below(50) != 0) continue;
        ASSERT_EQ(pairs_of(dirty.take()), ranges_of(numbers)) << "step " << step;
        numbers.clear();
    }
}

}  // namespace
}  // namespace throng
