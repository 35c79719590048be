// InstanceNumbers: the allocator of instance slots, which gives the lowest free number first.
#include "crowd/instance_numbers.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <set>

namespace throng::test {
namespace {

TEST(InstanceNumbers, AreGivenLowestFirst) {
    for (const uint32_t capacity : {1u, 63u, 64u, 65u, 1000u}) {
        InstanceNumbers numbers(capacity);
        std::set<uint32_t> taken;
        Random random(capacity);
        for (int i = 0; i < 5000; ++i) {
            const bool gives_back = !taken.empty() && (taken.size() == capacity || random.chance(0.5));
            if (gives_back) {
                const auto any = std::next(taken.begin(), random.below(static_cast<uint32_t>(taken.size())));
                numbers.give_back(*any);
                taken.erase(any);
            } else {
                uint32_t lowest = 0;
                for (const uint32_t number : taken) lowest += number == lowest ? 1 : 0;
                ASSERT_EQ(numbers.take(), lowest);
                taken.insert(lowest);
            }
            ASSERT_EQ(numbers.free_count(), capacity - taken.size());
            ASSERT_EQ(numbers.end(), taken.empty() ? 0 : *taken.rbegin() + 1);
            const uint32_t number = random.below(capacity + 3);
            ASSERT_EQ(numbers.is_taken(number), taken.contains(number));
        }
    }
}

}  // namespace
}  // namespace throng::test
