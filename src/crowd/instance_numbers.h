// Which instance numbers of a group are in use. The lowest free number is taken first, so that those in use stay
// together.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace throng {

class InstanceNumbers {
public:
    explicit InstanceNumbers(uint32_t capacity = 0)
        : free_((capacity + kBits - 1) / kBits, ~uint64_t{0}), capacity_(capacity), free_count_(capacity) {
        if (capacity % kBits > 0) free_.back() = (uint64_t{1} << capacity % kBits) - 1;
    }

    uint32_t capacity() const { return capacity_; }
    uint32_t free_count() const { return free_count_; }
    bool is_taken(uint32_t number) const { return number < capacity_ && (free_[number / kBits] & bit_of(number)) == 0; }
    // One more than the highest that is taken.
    uint32_t end() const { return end_; }

    // `number` must be free.
    void take(uint32_t number) {
        free_[number / kBits] &= ~bit_of(number);
        --free_count_;
        if (number >= end_) end_ = number + 1;
    }

    // The lowest that is free; there must be one.
    uint32_t take() {
        while (free_[first_free_word_] == 0) ++first_free_word_;
        const auto number = static_cast<uint32_t>(first_free_word_ * kBits +
                                                  static_cast<size_t>(std::countr_zero(free_[first_free_word_])));
        take(number);
        return number;
    }

    // `number` must be taken.
    void give_back(uint32_t number) {
        free_[number / kBits] |= bit_of(number);
        ++free_count_;
        if (number / kBits < first_free_word_) first_free_word_ = number / kBits;
        while (end_ > 0 && !is_taken(end_ - 1)) --end_;
    }

private:
    static constexpr uint32_t kBits = 64;
    static uint64_t bit_of(uint32_t number) { return uint64_t{1} << number % kBits; }

    std::vector<uint64_t> free_;  // a bit each
    size_t first_free_word_ = 0;  // words before it have no free bit
    uint32_t capacity_ = 0, free_count_ = 0, end_ = 0;
};

}  // namespace throng
