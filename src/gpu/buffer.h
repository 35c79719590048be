// Buffers, and the commands that write and copy them.
#pragma once

#include "gpu/gpu.h"

#include <cstddef>
#include <cstring>
#include <memory>
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
    // `what` names the content in messages, including the validation layer's. Throws kLimit where a storage buffer
    // exceeds the device's range or allocation size.
    Buffer(std::shared_ptr<Gpu> gpu, std::string_view what, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
           MemoryKind kind = MemoryKind::kDevice);
    Buffer(Buffer&&) noexcept = default;
    Buffer& operator=(Buffer&&) noexcept = default;

    explicit operator bool() const { return content_ != nullptr; }
    // Null on a native device.
    VkBuffer handle() const { return content_ ? content_->buffer : VK_NULL_HANDLE; }
    // This buffer if there is one, else `other`: even a binding that a kernel does not use must have a buffer.
    const Buffer& or_else(const Buffer& other) const { return content_ ? *this : other; }
    VkDeviceSize size_bytes() const { return content_ ? content_->size_bytes : 0; }
    // The CPU's pointer to the content. Null unless the buffer is mapped, or kernels may run natively (Gpu::processor).
    std::byte* mapped() const { return content_ ? content_->mapped : nullptr; }
    // 4 or 16: a kernel may read the buffer as texels of one or four components; 0: only as a storage buffer.
    uint32_t texel_bytes() const { return content_ ? content_->texel_bytes : 0; }
    // Only for a buffer whose usage has VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT
    void allow_texels(uint32_t texel_bytes) { content_->texel_bytes = texel_bytes; }
    // As long as this lives, so does the VkBuffer.
    std::shared_ptr<const void> keep_alive() const { return content_; }

    // Another reference to the same buffer. Only for buffers whose contents do not change.
    Buffer share() const {
        Buffer same;
        same.content_ = content_;
        return same;
    }

private:
    friend class SharedBuffers;
    struct Content {
        explicit Content(std::shared_ptr<Gpu> of) : gpu(std::move(of)) {}
        ~Content();
        Content(const Content&) = delete;
        void create(VkDeviceSize size, VkBufferUsageFlags usage, MemoryKind kind);

        std::shared_ptr<Gpu> gpu;
        VkBuffer buffer = VK_NULL_HANDLE;
        MemoryPart memory;
        NativeMemory native_memory;
        VkDeviceSize size_bytes = 0;
        std::byte* mapped = nullptr;
        uint32_t texel_bytes = 0;
    };
    std::shared_ptr<Content> content_;
};

// Part of a buffer, as a descriptor takes it.
struct BufferRange {
    VkBuffer buffer = VK_NULL_HANDLE;
    std::byte* mapped = nullptr;  // Buffer::mapped() of the whole buffer
    VkDeviceSize offset_bytes = 0;
    VkDeviceSize size_bytes = 0;
    uint32_t texel_bytes = 0;  // Buffer::texel_bytes(); 0 for a part of a buffer, which cannot be read as texels

    BufferRange() = default;
    BufferRange(const Buffer& whole)
        : buffer(whole.handle()),
          mapped(whole.mapped()),
          size_bytes(whole.size_bytes()),
          texel_bytes(whole.texel_bytes()) {}
    BufferRange(VkBuffer handle, VkDeviceSize offset, VkDeviceSize size)  // one that the CPU does not see
        : buffer(handle), offset_bytes(offset), size_bytes(size) {}
    BufferRange(const Buffer& of, VkDeviceSize offset, VkDeviceSize size)
        : buffer(of.handle()), mapped(of.mapped()), offset_bytes(offset), size_bytes(size) {}

    explicit operator bool() const { return buffer || mapped; }
    std::byte* bytes() const { return mapped ? mapped + offset_bytes : nullptr; }
};

// A table that kernels write as a storage buffer and later kernels read by gpu/table.glsl, in words (4 bytes) or rows
// of four (16). Its contents are undefined. Throws kLimit if the device cannot read that many.
Buffer make_table_bytes(const std::shared_ptr<Gpu>& gpu, std::string_view what, uint64_t size_bytes,
                        uint32_t texel_bytes);

template <class T>
constexpr uint32_t texel_bytes_of() {
    static_assert(sizeof(T) == 4 || sizeof(T) % 16 == 0);
    return sizeof(T) == 4 ? 4 : 16;
}

// The same for `count` elements.
template <class T>
Buffer make_table(const std::shared_ptr<Gpu>& gpu, std::string_view what, uint64_t count) {
    return make_table_bytes(gpu, what, count * sizeof(T), texel_bytes_of<T>());
}

// The usage with which shaders can read a table (gpu/table.glsl). On a software device this is texels only, since its
// storage buffers have a lower size limit.
VkBufferUsageFlags table_usage(const Gpu& gpu, std::string_view what, uint64_t size_bytes, uint32_t texel_bytes);

// In the functions below, VK_NULL_HANDLE as command buffer means that this machine's processor (Gpu::processor) does
// the work at once.

// The data travels inside the command buffer, so that no staging memory has to outlive the call; offset and size are
// multiples of four bytes.
void record_update(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& target, VkDeviceSize offset_bytes,
                   std::span<const std::byte> data);

// Writes into a buffer of Ts, from `first` on.
template <class T>
void record_update(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& target, uint64_t first,
                   std::span<const T> items) {
    record_update(gpu, commands, target, first * sizeof(T), std::as_bytes(items));
}

// Both ranges have the same size.
void record_copy(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& from, const BufferRange& to);
// Many copies into one buffer. Those that continue each other become one, and those from one buffer, one after another,
// one command: drivers take time for each, and thousands took NVIDIA's over a millisecond.
struct CopyFrom {
    BufferRange from;
    VkDeviceSize to_bytes = 0;  // where it goes in the target
};
void record_copies(const Gpu& gpu, VkCommandBuffer commands, std::span<const CopyFrom> copies, const Buffer& target);
// Copies `from` repeatedly until `to` is full; the last copy is cut to fit.
void record_repeated(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& from, const BufferRange& to);
// Sets each 32-bit word of the range to `word`.
void record_fill(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& target, uint32_t word);

// Copies a range back. Submits and waits; sees all work submitted to the queue before.
void download_bytes(const std::shared_ptr<Gpu>& gpu, const BufferRange& range, std::span<std::byte> out);

template <class T>
std::vector<T> download(const std::shared_ptr<Gpu>& gpu, const BufferRange& range) {
    std::vector<T> out(range.size_bytes / sizeof(T));
    download_bytes(gpu, range, std::as_writable_bytes(std::span(out)));
    return out;
}

}  // namespace throng
