#include "gpu/free_ranges.h"
#include "base/count.h"

#include <iterator>

namespace throng {

FreeRanges::FreeRanges(uint64_t size) : size_(size), free_{{0, size}} {}

std::optional<uint64_t> FreeRanges::take(uint64_t size, uint64_t alignment) {
    for (auto range = free_.begin(); range != free_.end(); ++range) {
        const uint64_t begin = range->first, end = begin + range->second;
        const uint64_t offset = rounded_up(begin, alignment);
        if (offset > end || end - offset < size) continue;
        if (offset + size < end) free_.emplace(offset + size, end - offset - size);  // first, since it may throw
        if (offset > begin)
            range->second = offset - begin;
        else
            free_.erase(range);
        return offset;
    }
    return std::nullopt;
}

void FreeRanges::give_back(uint64_t offset, uint64_t size) {
    auto range = free_.emplace(offset, size).first;
    if (const auto next = std::next(range); next != free_.end() && offset + size == next->first) {
        range->second += next->second;
        free_.erase(next);
    }
    if (range == free_.begin()) return;
    const auto previous = std::prev(range);
    if (previous->first + previous->second != offset) return;
    previous->second += range->second;
    free_.erase(range);
}

}  // namespace throng
