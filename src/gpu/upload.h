// Uploads the contents of new buffers together, in one submission or in the application's commands.
#pragma once

#include "gpu/shared_buffers.h"

#include <cstring>
#include <functional>
#include <limits>
#include <map>

namespace throng {

// Collects uploads. Either finish() submits them and waits, or record() records them and complete() notes that they
// have run. Only then are the contents in their buffers. If neither is called, because an error came first, nothing is
// submitted. On a native device they are there at once. Not thread-safe.
class Uploads {
public:
    // The limit of staging memory in use: an upload that would exceed it first submits those added so far. A single
    // larger upload gets as much as it needs.
    static constexpr VkDeviceSize kMaxStaged_bytes = VkDeviceSize{64} << 20;
    // No limit: nothing is submitted before finish().
    static constexpr VkDeviceSize kUnlimited_bytes = std::numeric_limits<VkDeviceSize>::max();

    explicit Uploads(std::shared_ptr<Gpu> gpu, VkDeviceSize max_staged_bytes = kMaxStaged_bytes)
        : gpu_(std::move(gpu)), max_staged_bytes_(max_staged_bytes) {}
    Uploads(const Uploads&) = delete;
    Uploads& operator=(const Uploads&) = delete;

    const std::shared_ptr<Gpu>& gpu() const { return gpu_; }
    // Copies `data`, `count` times one after another, to the beginning of `target` and fills the rest with zeros. Sizes
    // are multiples of four bytes. The target may be destroyed before finish().
    void add(const Buffer& target, std::span<const std::byte> data, uint64_t count = 1);
    // `record` is called by finish() and by each record(), with the data in staging memory, at a multiple of 16 bytes.
    void add(std::span<const std::byte> data, std::function<void(VkCommandBuffer, const BufferRange&)> record);
    bool is_empty() const { return pending_.empty(); }
    // Submits what has been added so far if `size_bytes` more would exceed the limit. add() does so too. A caller that
    // must know whether its own upload failed calls this first, so that failures of earlier uploads show here.
    void make_room(VkDeviceSize size_bytes);

    // Whether upload() and upload_table() may return an existing buffer with the same contents, of these uploads or of
    // others on the device. Only for contents that do not change.
    bool shares = false;
    // Returns an existing buffer, or `make`s one.
    Buffer share(const SharedBuffers::Key& key, const std::function<Buffer()>& make);

    // Submits and waits.
    void finish();
    // Records into commands that come before all others that use the buffers, on any queue that can copy. Can be called
    // again while nothing else has written to the buffers.
    void record(VkCommandBuffer commands) const;
    // Call it when the recorded commands have run: frees the staging memory and lets others share the buffers.
    void complete();

private:
    struct Pending {
        BufferRange staged;
        std::function<void(VkCommandBuffer, const BufferRange&)> record;
    };
    std::byte* stage(VkDeviceSize size_bytes, BufferRange& staged);

    std::shared_ptr<Gpu> gpu_;
    VkDeviceSize max_staged_bytes_;
    std::vector<Buffer> staging_;
    VkDeviceSize used_bytes_ = 0;    // of the last staging buffer
    VkDeviceSize staged_bytes_ = 0;  // of all staging buffers
    std::vector<Pending> pending_;
    std::map<SharedBuffers::Key, Buffer> shared_;  // buffers of pending uploads
};

constexpr VkDeviceSize kSmallestBuffer_bytes = 16;

// A device buffer that holds `data`; empty data gives a buffer of 16 zero bytes, since Vulkan has no empty ones. If
// `texel_bytes` is 4 or 16, shaders can read it by gpu/table.glsl.
Buffer upload_bytes(Uploads& uploads, std::string_view what, std::span<const std::byte> data, VkBufferUsageFlags usage,
                    uint32_t texel_bytes = 0);

template <class T>
Buffer upload(Uploads& uploads, std::string_view what, const std::vector<T>& data,
              VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) {
    return upload_bytes(uploads, what, std::as_bytes(std::span(data)), usage);
}

// A table that shaders declare by gpu/table.glsl, of words (4 bytes) or rows of four (16); only these can read it,
// since on a software device it is no storage buffer. Throws kLimit if the device cannot read that many.
template <class T>
Buffer upload_table(Uploads& uploads, std::string_view what, const std::vector<T>& data) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(data));
    const uint32_t texel_bytes = texel_bytes_of<T>();
    return upload_bytes(uploads, what, bytes, table_usage(*uploads.gpu(), what, bytes.size(), texel_bytes),
                        texel_bytes);
}

// A buffer that begins with `of_one`, `count` times one after another, and that kernels may change.
template <class T>
Buffer fill(Uploads& uploads, std::string_view what, const std::vector<T>& of_one, uint64_t count) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(of_one));
    Buffer filled(uploads.gpu(), what, std::max<VkDeviceSize>(bytes.size() * count, kSmallestBuffer_bytes),
                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    uploads.add(filled, bytes, count);
    return filled;
}

// The same, as a table of words.
template <class T>
Buffer fill_table(Uploads& uploads, std::string_view what, const std::vector<T>& of_one, uint64_t count) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(of_one));
    Buffer filled = make_table_bytes(uploads.gpu(), what, std::max(bytes.size() * count, kSmallestBuffer_bytes),
                                     texel_bytes_of<uint32_t>());
    uploads.add(filled, bytes, count);
    return filled;
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
