// Buffers whose contents never change, made once a device and shared by all that have the same contents.
#pragma once

#include "gpu/buffer.h"

#include <compare>
#include <map>
#include <mutex>

namespace throng {

// Finds a buffer that is in use by what is in it. Thread-safe.
class SharedBuffers {
public:
    struct Key {
        uint64_t crc = 0, hash = 0, size_bytes = 0;  // of the contents
        VkBufferUsageFlags usage = 0;
        uint32_t texel_bytes = 0;
        auto operator<=>(const Key&) const = default;
    };
    static Key key_of(std::span<const std::byte> contents, VkBufferUsageFlags usage, uint32_t texel_bytes);

    // None where there is no such.
    Buffer find(const Key& key);
    // Of a buffer whose contents are there, so that anyone may read them without waiting. It is not kept alive.
    void add(const Key& key, const Buffer& buffer);

private:
    std::mutex mutex_;
    std::map<Key, std::weak_ptr<Buffer::Content>> by_key_;
};

}  // namespace throng
