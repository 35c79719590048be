// Groups of a crowd: their current instances, and the contents of their outputs.
#pragma once

#include "tests/contents.h"
#include "tests/crowd_cases.h"

namespace throng::test {

inline std::vector<InstanceHandle> alive_in(const Crowd& crowd, uint32_t group) {
    std::vector<InstanceHandle> there;
    const Instances all = *crowd.instances(group);
    for (uint32_t i = 0; i < all.size(); ++i)
        if (const Result<InstanceHandle> handle = crowd.handle(all.number(i))) there.push_back(*handle);
    return there;
}

// The contents of these groups' outputs, keyed by the position in `groups`.
inline Contents contents_of_groups(const Crowd& crowd, const std::vector<GroupIndex>& groups) {
    Contents all;
    for (size_t i = 0; i < groups.size(); ++i) {
        std::vector<OutputBlock> blocks;
        for (const OutputBlock& block : crowd.outputs())
            if (block.group == groups[i]) blocks.push_back(block);
        EXPECT_FALSE(blocks.empty());
        for (const auto& [name, bytes] : contents_of(blocks))
            all[std::to_string(i) + name.substr(name.find(':'))] = bytes;
    }
    return all;
}

}  // namespace throng::test
