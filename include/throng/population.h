// Instances that come and go.
#pragma once

#include <throng/character.h>

#include <cstdint>

namespace throng {

// An instance from its Crowd::spawn() to its Crowd::despawn(). Its number in the crowd, by which calls and outputs name
// it, is given to others later, which have another generation.
struct InstanceHandle {
    uint32_t instance = kNone;
    uint32_t generation = 0;  // how many had the number before; modulo 2^32

    bool operator==(const InstanceHandle&) const = default;
};

}  // namespace throng
