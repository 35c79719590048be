// Counts and sizes as 32-bit numbers, as the GPU and files store them.
#pragma once

#include <cstdint>
#include <iterator>

namespace throng {

// The number of items, for containers that other limits keep below 2^32 items.
template <class Items>
uint32_t count_of(const Items& items) {
    return static_cast<uint32_t>(std::size(items));
}

constexpr uint64_t rounded_up(uint64_t number, uint64_t to_multiple_of) {
    return (number + to_multiple_of - 1) / to_multiple_of * to_multiple_of;
}

}  // namespace throng
