// Looks up items by name.
#pragma once

#include <throng/index.h>

#include <string>
#include <string_view>
#include <vector>

namespace throng {

template <class T>
std::string_view item_name(const T& item) {
    return item.name;
}
inline std::string_view item_name(const std::string& name) { return name; }

// The index of the first item with this name, or kNone. Items may be the names themselves.
template <class T>
uint32_t find_name(const std::vector<T>& items, std::string_view name) {
    for (uint32_t i = 0; i < items.size(); ++i)
        if (item_name(items[i]) == name) return i;
    return kNone;
}

// The indices of all items with this name.
template <class IndexType = uint32_t, class T>
std::vector<IndexType> find_all_names(const std::vector<T>& items, std::string_view name) {
    std::vector<IndexType> found;
    for (uint32_t i = 0; i < items.size(); ++i)
        if (item_name(items[i]) == name) found.push_back(i);
    return found;
}

}  // namespace throng
