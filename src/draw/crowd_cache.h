// What a renderer keeps of crowds, for as long as they live.
#pragma once

#include "crowd/crowd_state.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace throng {

template <class Kept>
class CrowdCache {
public:
    // Returns what is kept for this crowd, made by make() the first time. Removes the entries of destroyed crowds.
    template <class Make>
    Kept& of(const CrowdState& crowd, const Make& make) {
        std::erase_if(entries_, [](const Entry& entry) { return entry.life.expired(); });
        for (const Entry& entry : entries_)
            if (entry.life.lock() == crowd.life) return *entry.kept;
        return *entries_.emplace_back(Entry{crowd.life, make()}).kept;
    }

private:
    struct Entry {
        std::weak_ptr<const CrowdLife> life;
        std::unique_ptr<Kept> kept;
    };
    std::vector<Entry> entries_;
};

}  // namespace throng
