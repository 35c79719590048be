// Names of one kind (states, parameters, clips, …): looks up references to them, and lists the names when a reference
// matches none.
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

    // The name's index is the number of names added before. Returns false if it was added already; it then keeps its
    // index. The string must outlive this object.
    bool add(std::string_view name);

    // Index, or kNone.
    uint32_t find(std::string_view name) const;

    // The name's index. If the name is unknown, throws at `place` with unknown() as the message.
    uint32_t require(std::string_view name, const std::string& place) const;

    // "there is no state 'mvoe'; did you mean 'move'? There are: idle, move, jump". If there are many, lists some;
    // if none is spelled much like the name, those that contain it come first.
    std::string unknown(std::string_view name) const;

    // The name that was most likely meant; empty if none is spelled much like it.
    std::string_view nearest(std::string_view name) const;

private:
    std::string kind_;
    std::vector<std::string_view> names_;
    std::unordered_map<std::string_view, uint32_t> indices_;
};

// The index of the first item with this name; items may be the names themselves. Errors: kInvalidArgument (unknown()).
template <class IndexType = uint32_t, class T>
Result<IndexType> index_named(const std::string& place, const char* kind, const std::vector<T>& items,
                              std::string_view name) {
    return as_result([&]() -> IndexType {
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
