#include "gpu/shared_buffers.h"

#include "base/crc64.h"

#include <functional>
#include <string_view>

namespace throng {

// Two unrelated checksums: different contents will not agree in both by chance.
SharedBuffers::Key SharedBuffers::key_of(std::span<const std::byte> contents, VkBufferUsageFlags usage,
                                         uint32_t texel_bytes) {
    const std::string_view text(reinterpret_cast<const char*>(contents.data()), contents.size());
    return {crc64(contents), std::hash<std::string_view>()(text), contents.size(), usage, texel_bytes};
}

Buffer SharedBuffers::find(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = by_key_.find(key);
    Buffer buffer;
    if (found != by_key_.end()) buffer.content_ = found->second.lock();
    return buffer;
}

void SharedBuffers::add(const Key& key, const Buffer& buffer) {
    const std::lock_guard lock(mutex_);
    std::erase_if(by_key_, [](const auto& entry) { return entry.second.expired(); });
    by_key_[key] = buffer.content_;
}

}  // namespace throng
