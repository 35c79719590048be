// Walks of characters, made once for all groups of a crowd that would have the same.
#pragma once

#include "native/native_rig.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace throng {

class NativeRigs {
public:
    std::shared_ptr<const NativeRig> get(const Character& character, const NativeRigSettings& settings) {
        const auto found = std::ranges::find_if(
            entries_, [&](const Entry& entry) { return entry.character == &character && entry.settings == settings; });
        if (found != entries_.end()) return found->rig;
        entries_.push_back({&character, settings, std::make_shared<const NativeRig>(character, settings)});
        return entries_.back().rig;
    }

private:
    struct Entry {
        const Character* character;
        NativeRigSettings settings;
        std::shared_ptr<const NativeRig> rig;
    };
    std::vector<Entry> entries_;
};

}  // namespace throng
