// Which parts of a block of memory are free.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace throng {

class FreeRanges {
public:
    explicit FreeRanges(uint64_t size);

    // The offset, a multiple of `alignment`, of the first free part of `size` bytes; none if there is no such part.
    std::optional<uint64_t> take(uint64_t size, uint64_t alignment);
    // A part that take() gave.
    void give_back(uint64_t offset, uint64_t size);
    bool all_free() const { return free_.size() == 1 && free_.begin()->second == size_; }

private:
    uint64_t size_;
    std::map<uint64_t, uint64_t> free_;  // from offset to size; no two of them touch
};

}  // namespace throng
