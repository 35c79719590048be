// Which instances changed since the last update. An instance that did not change costs only a bit.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace throng {

class DirtyRanges {
public:
    struct Range {
        uint32_t first = 0, count = 0;
    };

    void add(uint32_t first, uint32_t count) {
        if (count == 0) return;
        is_any_ = true;
        const size_t last_word = (size_t{first} + count - 1) / kBits;
        if (words_.size() <= last_word) words_.resize(last_word + 1);
        for_each_word(first, count, [](uint64_t& word, uint64_t bits) { word |= bits; });
    }

    // Marks these as unchanged.
    void remove(uint32_t first, uint32_t count) {
        const size_t end = std::min(size_t{first} + count, words_.size() * kBits);
        if (first >= end) return;
        for_each_word(first, static_cast<uint32_t>(end - first), [](uint64_t& word, uint64_t bits) { word &= ~bits; });
    }

    // The changed instances in ascending order, each once.
    std::vector<Range> pending() const {
        std::vector<Range> ranges;
        append_to(ranges);
        return ranges;
    }

    // The same, and forgets them. The span is valid until the next call.
    std::span<const Range> take() {
        taken_.clear();
        append_to(taken_);
        if (std::exchange(is_any_, false)) std::ranges::fill(words_, 0);
        return taken_;
    }

    // What the last take() has returned counts as changed again.
    void put_back() {
        for (const auto& [first, count] : std::exchange(taken_, {})) add(first, count);
    }

private:
    static constexpr size_t kBits = 64;

    void append_to(std::vector<Range>& ranges) const {
        if (!is_any_) return;
        for (size_t at = 0; at < words_.size(); ++at) {
            for (uint64_t word = words_[at]; word != 0; word &= word + (word & -word)) {  // clears its lowest run of 1s
                const int bit = std::countr_zero(word);
                const auto first = static_cast<uint32_t>(at * kBits) + static_cast<uint32_t>(bit),
                           count = static_cast<uint32_t>(std::countr_one(word >> bit));
                if (!ranges.empty() && ranges.back().first + ranges.back().count == first)
                    ranges.back().count += count;
                else
                    ranges.push_back({first, count});
            }
        }
    }

    // Calls apply(word, bits) for each word that holds some of the range's bits; `bits` are those.
    template <class Apply>
    void for_each_word(uint32_t first, uint32_t count, const Apply& apply) {
        const size_t end = size_t{first} + count;
        for (size_t at = first; at < end;) {
            const size_t bit = at % kBits, part = std::min(kBits - bit, end - at);
            apply(words_[at / kBits], ~uint64_t{0} >> (kBits - part) << bit);
            at += part;
        }
    }

    std::vector<uint64_t> words_;  // a bit each
    bool is_any_ = false;          // else all are 0
    std::vector<Range> taken_;
};

}  // namespace throng
