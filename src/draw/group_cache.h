// What a renderer keeps of the groups of crowds, for as long as they live.
#pragma once

#include "crowd/crowd_state.h"

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

namespace throng {

template <class Kept>
class GroupCache {
public:
    // Returns what is kept for a crowd's groups: [group], null if the group is gone. make(groups) returns it for the
    // new groups, in their order. Removes the entries of groups that no longer live.
    template <class Make>
    std::vector<const Kept*> of(const CrowdState& crowd, const Make& make) {
        std::vector<uint32_t> missing;
        for (uint32_t group = 0; group < crowd.groups.size(); ++group)
            if (!crowd.groups[group].is_gone() && !find(crowd.groups[group])) missing.push_back(group);
        if (!missing.empty()) {
            std::vector<std::unique_ptr<Kept>> made = make(missing);
            for (size_t i = 0; i < made.size(); ++i)
                entries_.push_back({crowd.groups[missing[i]].life, std::move(made[i])});
        }
        // After make(), so that new groups can take over the textures of groups that have just gone.
        std::erase_if(entries_, [](const Entry& entry) { return entry.life.expired(); });
        for (const Group& group : crowd.groups)
            if (!group.is_gone()) group.life->decoded.reset();
        std::vector<const Kept*> all;
        for (const Group& group : crowd.groups) all.push_back(find(group));
        return all;
    }

private:
    struct Entry {
        std::weak_ptr<const GroupLife> life;
        std::unique_ptr<Kept> kept;
    };
    const Kept* find(const Group& group) const {
        const auto found = std::ranges::find_if(entries_,
                                                [&](const Entry& entry) { return entry.life.lock() == group.life; });
        return found == entries_.end() ? nullptr : found->kept.get();
    }

    std::vector<Entry> entries_;
};

}  // namespace throng
