// Looks up items by name.
#pragma once

#include <throng/asset.h>

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

// The index of the first item with this name, or kNone. Items may be the names themselves.
template <class T>
uint32_t find_name(const std::vector<T>& items, std::string_view name) {
    for (size_t i = 0; i < items.size(); ++i)
        if constexpr (std::same_as<T, std::string>) {
            if (items[i] == name) return static_cast<uint32_t>(i);
        } else {
            if (items[i].name == name) return static_cast<uint32_t>(i);
        }
    return kNone;
}

}  // namespace throng
