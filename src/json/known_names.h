// Names of one kind (states, parameters, clips, …), to look up what refers to them, and to say what there is where
// nothing does.
#pragma once

#include "base/failure.h"
#include "base/find_name.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace throng {

inline constexpr size_t kNameLimit = 256;  // bytes

class KnownNames {
public:
    explicit KnownNames(std::string kind) : kind_(std::move(kind)) {}

    // The name's index is how many were added before. Where it was added already, it keeps that index, and false is
    // returned. The string must outlive this.
    bool add(std::string_view name);

    // Index, or kNone.
    uint32_t find(std::string_view name) const;

    // Index. Throws at `place` where there is none, with unknown().
    uint32_t require(std::string_view name, const std::string& place) const;

    // "there is no state 'mvoe'; did you mean 'move'? There are: idle, move, jump". Of many, some; those that contain
    // the name first, where none is written much like it.
    std::string unknown(std::string_view name) const;

    // That which is most likely meant; empty where none is written much like it.
    std::string_view nearest(std::string_view name) const;

private:
    std::string kind_;
    std::vector<std::string_view> names_;
    std::unordered_map<std::string_view, uint32_t> indices_;
};

// The index of the first of a thing's items that has this name, or is it. Errors: kInvalidArgument (unknown()).
template <class T>
Result<uint32_t> index_named(const std::string& place, const char* kind, const std::vector<T>& items,
                             std::string_view name) {
    return as_result([&] {
        if (const uint32_t index = find_name(items, name); index != kNone) return index;
        KnownNames known(kind);
        for (const T& item : items)
            if constexpr (std::same_as<T, std::string>)
                known.add(item);
            else
                known.add(item.name);
        throw Failure(ErrorCode::kInvalidArgument, place, known.unknown(name));
    });
}

}  // namespace throng
