// Uploads the contents of new buffers together, in one submission.
#pragma once

#include "gpu/buffer.h"

#include <cstring>
#include <functional>

namespace throng {

// Collects uploads; finish() submits them and waits, and only then are the contents in their buffers. If it is never
// called, since an error came first, nothing is submitted. Not thread-safe.
class Uploads {
public:
    // The most staging memory in use: before an upload would exceed it, those added so far are submitted. A single
    // larger upload gets as much as it needs.
    static constexpr VkDeviceSize kMostStaged_bytes = VkDeviceSize{64} << 20;

    explicit Uploads(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}
    Uploads(const Uploads&) = delete;
    Uploads& operator=(const Uploads&) = delete;

    const std::shared_ptr<Gpu>& gpu() const { return gpu_; }
    // Copies `data` to the beginning of `target` and fills the rest with zeros. The target may be destroyed before
    // finish().
    void add(const Buffer& target, std::span<const std::byte> data);
    // `record` is called when all is submitted, with the data in staging memory, at a multiple of 16 bytes.
    void add(std::span<const std::byte> data, std::function<void(VkCommandBuffer, const BufferRange&)> record);
    // Submits what has been added so far if so much more would exceed the limit. add() does it too, but who wants to
    // know whether its own upload failed calls this before: what fails here is that of others.
    void make_room(VkDeviceSize size_bytes);
    // Submits and waits.
    void finish();

private:
    struct Pending {
        BufferRange staged;
        std::function<void(VkCommandBuffer, const BufferRange&)> record;
    };
    std::byte* stage(VkDeviceSize size_bytes, BufferRange& staged);

    std::shared_ptr<Gpu> gpu_;
    std::vector<Buffer> staging_;
    VkDeviceSize used_bytes_ = 0;    // of the last one
    VkDeviceSize staged_bytes_ = 0;  // of all
    std::vector<Pending> pending_;
};

// A device buffer that holds `data`; empty data gives a buffer of 16 zero bytes, since Vulkan has no empty ones.
Buffer upload_bytes(Uploads& uploads, std::string_view what, std::span<const std::byte> data, VkBufferUsageFlags usage);

template <class T>
Buffer upload(Uploads& uploads, std::string_view what, const std::vector<T>& data,
              VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) {
    return upload_bytes(uploads, what, std::as_bytes(std::span(data)), usage);
}

// Tables that shaders declare by gpu/table.glsl, of words (4 bytes) or rows of four (16). They throw kLimit where the
// device cannot read so many.
Buffer upload_table_bytes(Uploads& uploads, std::string_view what, std::span<const std::byte> data,
                          uint32_t texel_bytes, VkBufferUsageFlags more_usage = 0);

// Only shaders that declare it by gpu/table.glsl may read it: on a software device it is no storage buffer.
template <class T>
Buffer upload_table(Uploads& uploads, std::string_view what, const std::vector<T>& data) {
    return upload_table_bytes(uploads, what, std::as_bytes(std::span(data)), texel_bytes_of<T>());
}

// A table with contents, of words, that kernels also write.
inline Buffer upload_writable_table(Uploads& uploads, std::string_view what, const std::vector<uint32_t>& words) {
    return upload_table_bytes(uploads, what, std::as_bytes(std::span(words)), sizeof(uint32_t),
                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
}

// A single buffer; submits and waits.
template <class T>
Buffer upload(const std::shared_ptr<Gpu>& gpu, std::string_view what, const std::vector<T>& data,
              VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) {
    Uploads uploads(gpu);
    Buffer buffer = upload(uploads, what, data, usage);
    uploads.finish();
    return buffer;
}

template <class T>
Buffer upload_table(const std::shared_ptr<Gpu>& gpu, std::string_view what, const std::vector<T>& data) {
    Uploads uploads(gpu);
    Buffer table = upload_table(uploads, what, data);
    uploads.finish();
    return table;
}

// Structures as the words of a table.
template <class T>
std::vector<uint32_t> as_words(const std::vector<T>& items) {
    static_assert(sizeof(T) % sizeof(uint32_t) == 0 && std::is_trivially_copyable_v<T>);
    std::vector<uint32_t> words(items.size() * sizeof(T) / sizeof(uint32_t));
    if (!items.empty()) std::memcpy(words.data(), items.data(), words.size() * sizeof(uint32_t));
    return words;
}

}  // namespace throng
