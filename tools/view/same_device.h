// The same device in two lists of devices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace throng::view {

// The index in `others` of the device that has `index` in `names`; none if it is not there. The lists may differ in
// order, but of several devices of one name, the first in one list is the first in the other, and so on.
inline std::optional<size_t> same_device(std::span<const std::string> names, size_t index,
                                         std::span<const std::string> others) {
    auto before = std::ranges::count(names.first(index), names[index]);
    for (size_t other = 0; other < others.size(); ++other)
        if (others[other] == names[index] && before-- == 0) return other;
    return std::nullopt;
}

}  // namespace throng::view
