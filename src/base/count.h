// Counts and sizes as the GPU and files have them.
#pragma once

#include <cstdint>
#include <iterator>

namespace throng {

// The number of items, where limits keep it below 2^32.
template <class Items>
uint32_t count_of(const Items& items) {
    return static_cast<uint32_t>(std::size(items));
}

constexpr uint64_t rounded_up(uint64_t number, uint64_t to_multiple_of) {
    return (number + to_multiple_of - 1) / to_multiple_of * to_multiple_of;
}

}  // namespace throng
