#include "gpu/buffer.h"

#include "base/failure.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <cstring>

namespace throng {

VkBufferUsageFlags table_usage(const Gpu& gpu, std::string_view what, uint64_t size_bytes, uint32_t texel_bytes) {
    if (!gpu.uses_software_kernels()) return VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    const uint64_t count = size_bytes / texel_bytes, limit = gpu.properties.limits.maxTexelBufferElements;
    if (count > limit)
        throw Failure(ErrorCode::kLimit, std::string(what),
                      "a table of " + std::to_string(count) + " elements exceeds the device's " +
                          std::to_string(limit) + " (maxTexelBufferElements)");
    return VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
}

Buffer::Buffer(std::shared_ptr<Gpu> gpu, std::string_view what, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
               MemoryKind kind) {
    const auto refuse_over = [&](uint64_t limit, const char* name) {
        if (size_bytes <= limit) return;
        throw Failure(
            ErrorCode::kLimit, std::string(what),
            std::to_string(size_bytes) + " bytes exceed the device's " + name + " of " + std::to_string(limit));
    };
    if (usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)
        refuse_over(gpu->properties.limits.maxStorageBufferRange, "storage-buffer range");
    refuse_over(gpu->max_allocation_bytes, "largest allocation");
    const auto content = std::make_shared<Content>(std::move(gpu));
    try {
        content->create(size_bytes, usage, kind);
    } catch (const Failure& failure) {
        throw Failure(failure.error.code, std::string(what) + " (" + std::to_string(size_bytes) + " bytes)",
                      failure.error.message);
    }
    content->gpu->name(VK_OBJECT_TYPE_BUFFER, content->buffer, what);
    content_ = content;
}

void Buffer::Content::create(VkDeviceSize size, VkBufferUsageFlags usage, MemoryKind kind) {
    if (gpu->is_native() || gpu->compiles_only()) {
        native_memory = NativeMemory(size);
        mapped = native_memory.bytes();
        size_bytes = size;
        return;
    }
    // The application may also read what shaders write as vertices.
    if (usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) usage |= VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    const std::vector<uint32_t>& families = gpu->sharing_families;
    const VkBufferCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = size,
        .usage = usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
        .sharingMode = families.empty() ? VK_SHARING_MODE_EXCLUSIVE : VK_SHARING_MODE_CONCURRENT,
        .queueFamilyIndexCount = static_cast<uint32_t>(families.size()),
        .pQueueFamilyIndices = families.data()};
    check(gpu->vk.vkCreateBuffer(gpu->device, &create, nullptr, &buffer), "vkCreateBuffer");
    size_bytes = size;
    VkMemoryRequirements needs{};
    gpu->vk.vkGetBufferMemoryRequirements(gpu->device, buffer, &needs);
    constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const VkMemoryPropertyFlags required = kind == MemoryKind::kDevice ? 0 : kHost;
    const VkMemoryPropertyFlags preferred = kind == MemoryKind::kDevice     ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
                                            : kind == MemoryKind::kReadback ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT
                                                                            : 0;
    // Mapped memory has the alignment that a separate mapping would have, so that the CPU can read it as any type.
    constexpr VkDeviceSize kMapped = 64;  // the smallest value that Vulkan allows for minMemoryMapAlignment
    const bool is_mapped = kind != MemoryKind::kDevice || gpu->processor;
    const VkDeviceSize alignment = is_mapped ? std::max(needs.alignment, kMapped) : needs.alignment;
    gpu->allocate(needs.memoryTypeBits, required, preferred,
                  [&](uint32_t type) { memory = gpu->memory.take(type, needs.size, alignment); });
    if (is_mapped && !memory.mapped)
        throw Failure(ErrorCode::kOutOfMemory, "vkMapMemory", "memory for the CPU cannot be mapped");
    check(gpu->vk.vkBindBufferMemory(gpu->device, buffer, memory.memory, memory.offset_bytes), "vkBindBufferMemory");
    if (is_mapped) mapped = memory.mapped;
}

Buffer::Content::~Content() {
    if (buffer) gpu->vk.vkDestroyBuffer(gpu->device, buffer, nullptr);
    if (memory.block) gpu->memory.give_back(memory);
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
    if (!commands) {
        if (!data.empty()) std::memcpy(target.bytes() + offset_bytes, data.data(), data.size());
        return;
    }
    constexpr size_t kLimit_bytes = 65536;  // of vkCmdUpdateBuffer
    for (size_t at = 0; at < data.size(); at += kLimit_bytes) {
        const auto part = data.subspan(at, std::min(kLimit_bytes, data.size() - at));
        gpu.vk.vkCmdUpdateBuffer(commands, target.buffer, target.offset_bytes + offset_bytes + at, part.size(),
                                 part.data());
    }
}

void record_copy(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& from, const BufferRange& to) {
    if (!commands) {
        std::memcpy(to.bytes(), from.bytes(), from.size_bytes);
        return;
    }
    const VkBufferCopy copy{from.offset_bytes, to.offset_bytes, from.size_bytes};
    gpu.vk.vkCmdCopyBuffer(commands, from.buffer, to.buffer, 1, &copy);
}

void record_copies(const Gpu& gpu, VkCommandBuffer commands, std::span<const CopyFrom> copies, const Buffer& target) {
    if (!commands) {
        for (const auto& [from, to_bytes] : copies)
            std::memcpy(target.mapped() + to_bytes, from.bytes(), from.size_bytes);
        return;
    }
    std::vector<VkBufferCopy> regions;
    regions.reserve(copies.size());
    for (size_t i = 0; i < copies.size(); ++i) {
        const auto& [from, to_bytes] = copies[i];
        VkBufferCopy* const last = regions.empty() ? nullptr : &regions.back();
        if (last && last->srcOffset + last->size == from.offset_bytes && last->dstOffset + last->size == to_bytes)
            last->size += from.size_bytes;
        else
            regions.push_back({from.offset_bytes, to_bytes, from.size_bytes});
        if (i + 1 < copies.size() && copies[i + 1].from.buffer == from.buffer) continue;
        gpu.vk.vkCmdCopyBuffer(commands, from.buffer, target.handle(), static_cast<uint32_t>(regions.size()),
                               regions.data());
        regions.clear();
    }
}

void record_repeated(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& from, const BufferRange& to) {
    std::vector<VkBufferCopy> copies;
    for (VkDeviceSize at = 0; at < to.size_bytes; at += from.size_bytes) {
        const VkDeviceSize size_bytes = std::min(from.size_bytes, to.size_bytes - at);
        if (commands)
            copies.push_back({from.offset_bytes, to.offset_bytes + at, size_bytes});
        else
            std::memcpy(to.bytes() + at, from.bytes(), size_bytes);
    }
    if (copies.empty()) return;
    gpu.vk.vkCmdCopyBuffer(commands, from.buffer, to.buffer, static_cast<uint32_t>(copies.size()), copies.data());
}

void record_fill(const Gpu& gpu, VkCommandBuffer commands, const BufferRange& target, uint32_t word) {
    if (!commands) {
        for (VkDeviceSize at = 0; at < target.size_bytes; at += sizeof word)
            std::memcpy(target.bytes() + at, &word, sizeof word);
        return;
    }
    gpu.vk.vkCmdFillBuffer(commands, target.buffer, target.offset_bytes, target.size_bytes, word);
}

void download_bytes(const std::shared_ptr<Gpu>& gpu, const BufferRange& range, std::span<std::byte> out) {
    if (out.empty()) return;
    if (gpu->is_native()) {
        std::memcpy(out.data(), range.bytes(), out.size());
        return;
    }
    Buffer staging(gpu, "read-back", range.size_bytes, 0, MemoryKind::kReadback);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(*gpu, commands, kShaderWrite, kTransferRead);
        record_copy(*gpu, commands, range, BufferRange(staging, 0, range.size_bytes));
        memory_barrier(*gpu, commands, kTransferWrite, kHostRead);
    });
    std::memcpy(out.data(), staging.mapped(), out.size());
}

}  // namespace throng
