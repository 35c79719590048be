// A buffer with memory of its own.
#pragma once

#include "gpu/gpu.h"

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace throng {

enum class MemoryKind {
    kDevice,    // the GPU's own
    kUpload,    // written by the CPU, mapped
    kReadback,  // read by the CPU, mapped and cached
};

// Movable, not copyable. Every buffer may be the source and target of copies.
class Buffer {
public:
    Buffer() = default;
    // `what` names the content in messages. Throws kLimit where a storage buffer exceeds the device's range or
    // allocation size.
    Buffer(std::shared_ptr<Gpu> gpu, std::string_view what, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
           MemoryKind kind = MemoryKind::kDevice);
    ~Buffer();
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        swap(other);
        return *this;
    }

    VkBuffer handle() const { return buffer_; }
    // This buffer where there is one, else another: a binding that a kernel does not use must have some.
    const Buffer& or_else(const Buffer& other) const { return buffer_ ? *this : other; }
    VkDeviceSize size_bytes() const { return size_bytes_; }
    std::byte* mapped() const { return mapped_; }
    // 4 or 16: a kernel may read the buffer as texels of one or four components; 0: only as a storage buffer.
    uint32_t texel_bytes() const { return texel_bytes_; }
    // Its usage has VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT
    void allow_texels(uint32_t texel_bytes) { texel_bytes_ = texel_bytes; }

private:
    void swap(Buffer& other) noexcept;
    void destroy() noexcept;

    std::shared_ptr<Gpu> gpu_;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize size_bytes_ = 0;
    std::byte* mapped_ = nullptr;
    uint32_t texel_bytes_ = 0;
};

// Part of a buffer, as a descriptor takes it.
struct BufferRange {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0;
    VkDeviceSize size_bytes = 0;
    uint32_t texel_bytes = 0;  // as Buffer has it

    BufferRange() = default;
    BufferRange(const Buffer& whole)
        : buffer(whole.handle()), size_bytes(whole.size_bytes()), texel_bytes(whole.texel_bytes()) {}
    BufferRange(VkBuffer handle, VkDeviceSize offset, VkDeviceSize size)
        : buffer(handle), offset_bytes(offset), size_bytes(size) {}
};

// A device buffer that holds `data`; empty data gives a buffer of 16 zero bytes, since Vulkan has no empty ones.
// Submits and waits.
Buffer upload_bytes(const std::shared_ptr<Gpu>& gpu, std::string_view what, std::span<const std::byte> data,
                    VkBufferUsageFlags usage);

template <class T>
Buffer upload(const std::shared_ptr<Gpu>& gpu, std::string_view what, const std::vector<T>& data,
              VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) {
    return upload_bytes(gpu, what, std::as_bytes(std::span(data)), usage);
}

// Structures as the words of a table.
template <class T>
std::vector<uint32_t> as_words(const std::vector<T>& items) {
    static_assert(sizeof(T) % sizeof(uint32_t) == 0 && std::is_trivially_copyable_v<T>);
    std::vector<uint32_t> words(items.size() * sizeof(T) / sizeof(uint32_t));
    if (!items.empty()) std::memcpy(words.data(), items.data(), words.size() * sizeof(uint32_t));
    return words;
}

// Tables that shaders declare by gpu/table.glsl, of words (4 bytes) or rows of four (16). They throw kLimit where the
// device cannot read so many.
Buffer upload_table_bytes(const std::shared_ptr<Gpu>& gpu, std::string_view what, std::span<const std::byte> data,
                          uint32_t texel_bytes, VkBufferUsageFlags more_usage = 0);
Buffer make_table_bytes(const std::shared_ptr<Gpu>& gpu, std::string_view what, uint64_t size_bytes,
                        uint32_t texel_bytes);

template <class T>
constexpr uint32_t texel_bytes_of() {
    static_assert(sizeof(T) == 4 || sizeof(T) % 16 == 0);
    return sizeof(T) == 4 ? 4 : 16;
}

// Only shaders that declare it by gpu/table.glsl may read it: on a software device it is no storage buffer.
template <class T>
Buffer upload_table(const std::shared_ptr<Gpu>& gpu, std::string_view what, const std::vector<T>& data) {
    return upload_table_bytes(gpu, what, std::as_bytes(std::span(data)), texel_bytes_of<T>());
}

// A table of `count` elements that a kernel writes, as a storage buffer, and later ones read. Its contents are
// undefined.
template <class T>
Buffer make_table(const std::shared_ptr<Gpu>& gpu, std::string_view what, uint64_t count) {
    return make_table_bytes(gpu, what, count * sizeof(T), texel_bytes_of<T>());
}

// A table with contents, of words, that kernels also write.
inline Buffer upload_writable_table(const std::shared_ptr<Gpu>& gpu, std::string_view what,
                                    const std::vector<uint32_t>& words) {
    return upload_table_bytes(gpu, what, std::as_bytes(std::span(words)), sizeof(uint32_t),
                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
}

// The data travels inside the command buffer, so that no staging memory has to outlive the call; offset and size are
// multiples of four bytes.
void record_update(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& target, VkDeviceSize offset_bytes,
                   std::span<const std::byte> data);

// Of a buffer of Ts, those from `first` on.
template <class T>
void record_update(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& target, uint64_t first,
                   std::span<const T> items) {
    record_update(gpu, commands, target, first * sizeof(T), std::as_bytes(items));
}

// Copies a range back. Submits and waits; sees all work submitted to the queue before.
void download_bytes(const std::shared_ptr<Gpu>& gpu, const BufferRange& range, std::span<std::byte> out);

template <class T>
std::vector<T> download(const std::shared_ptr<Gpu>& gpu, const BufferRange& range) {
    std::vector<T> out(range.size_bytes / sizeof(T));
    download_bytes(gpu, range, std::as_writable_bytes(std::span(out)));
    return out;
}

}  // namespace throng
