// Buffers whose contents never change, made once per device and shared by all that need the same contents.
#pragma once

#include "gpu/buffer.h"

#include <compare>
#include <map>
#include <mutex>

namespace throng {

// Looks up buffers in use by their contents. Thread-safe.
class SharedBuffers {
public:
    struct Key {
        uint64_t crc = 0, hash = 0, size_bytes = 0;  // of the contents
        VkBufferUsageFlags usage = 0;
        uint32_t texel_bytes = 0;
        auto operator<=>(const Key&) const = default;
    };
    static Key key_of(std::span<const std::byte> contents, VkBufferUsageFlags usage, uint32_t texel_bytes);

    // Empty if there is none.
    Buffer find(const Key& key);
    // The buffer's contents must already be uploaded, so that they can be read without waiting. The buffer is not kept
    // alive.
    void add(const Key& key, const Buffer& buffer);

private:
    std::mutex mutex_;
    std::map<Key, std::weak_ptr<Buffer::Content>> by_key_;
};

}  // namespace throng
