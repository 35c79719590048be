// Which instances changed since the last update; costs nothing for those that did not.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace throng {

class DirtyRanges {
public:
    struct Range {
        uint32_t first = 0, count = 0;
    };

    DirtyRanges() = default;
    explicit DirtyRanges(std::vector<Range> pending) : ranges_(std::move(pending)) {}

    void add(uint32_t first, uint32_t count) {
        if (count == 0) return;
        if (!ranges_.empty() && first == ranges_.back().first + ranges_.back().count)
            ranges_.back().count += count;
        else
            ranges_.push_back({first, count});
    }

    // These have not changed.
    void remove(uint32_t first, uint32_t count) {
        std::vector<Range> others;
        for (const Range& range : pending()) {
            const uint32_t end = range.first + range.count, removed_end = first + count;
            if (range.first < first) others.push_back({range.first, std::min(end, first) - range.first});
            if (end > removed_end) {
                const uint32_t begin = std::max(range.first, removed_end);
                others.push_back({begin, end - begin});
            }
        }
        ranges_ = std::move(others);
    }

    // The changed instances in ascending order, each once.
    std::vector<Range> pending() const {
        std::vector<Range> ranges = ranges_, merged;
        std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
        for (const Range& range : ranges) {
            if (merged.empty() || range.first > merged.back().first + merged.back().count) {
                merged.push_back(range);
                continue;
            }
            Range& last = merged.back();
            last.count = std::max(last.first + last.count, range.first + range.count) - last.first;
        }
        return merged;
    }

    // The same; none is left.
    std::vector<Range> take() {
        taken_ = pending();
        ranges_.clear();
        return taken_;
    }

    // What the last take() has returned counts as changed again.
    void put_back() {
        ranges_.insert(ranges_.end(), taken_.begin(), taken_.end());
        taken_.clear();
    }

private:
    std::vector<Range> ranges_, taken_;
};

}  // namespace throng
