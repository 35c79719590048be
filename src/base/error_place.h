// Where something is wrong, for a message.
#pragma once

#include "base/text.h"

#include <cstdint>
#include <optional>

namespace throng {

// Something that the caller gave, by its name, or that of an instance. Its text is put together when it is needed:
// calls for thousands of instances check each of them, and hardly ever find anything.
struct ErrorPlace {
    ErrorPlace(const char* thing) : name(thing) {}
    ErrorPlace(const std::string& thing) : name(thing) {}
    ErrorPlace(const char* thing, uint32_t of_instance) : name(thing), instance(of_instance) {}
    operator std::string() const { return instance ? joined(name, " of instance ", *instance) : std::string(name); }

    std::string_view name;  // of the caller's
    std::optional<uint32_t> instance = {};
};

}  // namespace throng
