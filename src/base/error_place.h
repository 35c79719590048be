// Where something is wrong, for a message.
#pragma once

#include "base/text.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace throng {

// The name of an argument, and the instance that it is for, if any. The text is built only when a message needs it,
// since calls for thousands of instances check each of them and hardly ever find an error.
struct ErrorPlace {
    ErrorPlace(const char* thing) : name(thing) {}
    ErrorPlace(const std::string& thing) : name(thing) {}
    ErrorPlace(const char* thing, uint32_t of_instance) : name(thing), instance(of_instance) {}
    operator std::string() const { return instance ? joined(name, " of instance ", *instance) : std::string(name); }

    std::string_view name;  // not a copy: an ErrorPlace is passed on, not kept
    std::optional<uint32_t> instance = {};
};

}  // namespace throng
