#include "gpu/buffer.h"

#include "base/failure.h"
#include "gpu/barrier.h"

#include <utility>

namespace throng {
namespace {

// How shaders read a table (gpu/table.glsl): a software device as texels alone, since its storage buffers are smaller.
VkBufferUsageFlags table_usage(const Gpu& gpu, std::string_view what, uint64_t size_bytes, uint32_t texel_bytes) {
    if (!gpu.prefers_wide_words()) return VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    const uint64_t count = size_bytes / texel_bytes, limit = gpu.properties.limits.maxTexelBufferElements;
    if (count > limit)
        throw Failure(ErrorCode::kLimit, std::string(what),
                      "a table of " + std::to_string(count) + " elements exceeds the device's " +
                          std::to_string(limit) + " (maxTexelBufferElements)");
    return VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
}

}  // namespace

Buffer::Buffer(std::shared_ptr<Gpu> gpu, std::string_view what, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
               MemoryKind kind)
    : gpu_(std::move(gpu)), size_bytes_(size_bytes) {
    const auto refuse_over = [&](uint64_t limit, const char* name) {
        if (size_bytes <= limit) return;
        throw Failure(
            ErrorCode::kLimit, std::string(what),
            std::to_string(size_bytes) + " bytes exceed the device's " + name + " of " + std::to_string(limit));
    };
    if (usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)
        refuse_over(gpu_->properties.limits.maxStorageBufferRange, "storage-buffer range");
    refuse_over(gpu_->max_allocation_bytes, "largest allocation");

    VkBufferCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    create.size = size_bytes;
    create.usage = usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    try {
        check(gpu_->vk.vkCreateBuffer(gpu_->device, &create, nullptr, &buffer_), "vkCreateBuffer");
        VkMemoryRequirements needs{};
        gpu_->vk.vkGetBufferMemoryRequirements(gpu_->device, buffer_, &needs);
        constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                                VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
        allocate.allocationSize = needs.size;
        allocate.memoryTypeIndex = kind == MemoryKind::kDevice
                                       ? gpu_->memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)
                                   : kind == MemoryKind::kReadback
                                       ? gpu_->memory_type(needs.memoryTypeBits, kHost,
                                                           VK_MEMORY_PROPERTY_HOST_CACHED_BIT)
                                       : gpu_->memory_type(needs.memoryTypeBits, kHost, 0);
        check(gpu_->vk.vkAllocateMemory(gpu_->device, &allocate, nullptr, &memory_), "vkAllocateMemory");
        check(gpu_->vk.vkBindBufferMemory(gpu_->device, buffer_, memory_, 0), "vkBindBufferMemory");
        if (kind != MemoryKind::kDevice) {
            void* pointer = nullptr;
            check(gpu_->vk.vkMapMemory(gpu_->device, memory_, 0, VK_WHOLE_SIZE, 0, &pointer), "vkMapMemory");
            mapped_ = static_cast<std::byte*>(pointer);
        }
    } catch (Failure& failure) {
        destroy();
        throw Failure(failure.error.code, std::string(what) + " (" + std::to_string(size_bytes) + " bytes)",
                      failure.error.message);
    }
}

Buffer::~Buffer() { destroy(); }

void Buffer::destroy() noexcept {
    if (!gpu_) return;
    gpu_->vk.vkDestroyBuffer(gpu_->device, buffer_, nullptr);
    gpu_->vk.vkFreeMemory(gpu_->device, memory_, nullptr);
    gpu_.reset();
}

void Buffer::swap(Buffer& other) noexcept {
    std::swap(gpu_, other.gpu_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(size_bytes_, other.size_bytes_);
    std::swap(mapped_, other.mapped_);
    std::swap(texel_bytes_, other.texel_bytes_);
}

Buffer upload_bytes(const std::shared_ptr<Gpu>& gpu, std::string_view what, std::span<const std::byte> data,
                    VkBufferUsageFlags usage) {
    constexpr VkDeviceSize kSmallest_bytes = 16;
    Buffer buffer(gpu, what, std::max<VkDeviceSize>(data.size(), kSmallest_bytes), usage);
    Buffer staging(gpu, what, buffer.size_bytes(), 0, MemoryKind::kUpload);
    std::memset(staging.mapped(), 0, buffer.size_bytes());
    if (!data.empty()) std::memcpy(staging.mapped(), data.data(), data.size());
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        const VkBufferCopy copy{0, 0, buffer.size_bytes()};
        gpu->vk.vkCmdCopyBuffer(commands, staging.handle(), buffer.handle(), 1, &copy);
    });
    return buffer;
}

Buffer upload_table_bytes(const std::shared_ptr<Gpu>& gpu, std::string_view what, std::span<const std::byte> data,
                          uint32_t texel_bytes, VkBufferUsageFlags more_usage) {
    const VkBufferUsageFlags usage = table_usage(*gpu, what, data.size(), texel_bytes) | more_usage;
    Buffer table = upload_bytes(gpu, what, data, usage);
    if (usage & VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT) table.allow_texels(texel_bytes);
    return table;
}

Buffer make_table_bytes(const std::shared_ptr<Gpu>& gpu, std::string_view what, uint64_t size_bytes,
                        uint32_t texel_bytes) {
    const VkBufferUsageFlags usage = table_usage(*gpu, what, size_bytes, texel_bytes);
    Buffer table(gpu, what, size_bytes, usage | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    if (usage & VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT) table.allow_texels(texel_bytes);
    return table;
}

void record_update(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& target, VkDeviceSize offset_bytes,
                   std::span<const std::byte> data) {
    constexpr size_t kLimit_bytes = 65536;  // of vkCmdUpdateBuffer
    for (size_t at = 0; at < data.size(); at += kLimit_bytes) {
        const auto part = data.subspan(at, std::min(kLimit_bytes, data.size() - at));
        gpu.vk.vkCmdUpdateBuffer(commands, target.buffer, target.offset_bytes + offset_bytes + at, part.size(),
                                 part.data());
    }
}

void download_bytes(const std::shared_ptr<Gpu>& gpu, const BufferRange& range, std::span<std::byte> out) {
    if (out.empty()) return;
    Buffer staging(gpu, "read-back", range.size_bytes, 0, MemoryKind::kReadback);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(*gpu, commands, kShaderWrite, kTransferRead);
        const VkBufferCopy copy{range.offset_bytes, 0, range.size_bytes};
        gpu->vk.vkCmdCopyBuffer(commands, range.buffer, staging.handle(), 1, &copy);
        memory_barrier(*gpu, commands, kTransferWrite, kHostRead);
    });
    std::memcpy(out.data(), staging.mapped(), out.size());
}

}  // namespace throng
