#include "gpu/memory.h"

#include "base/failure.h"
#include "gpu/free_ranges.h"
#include "gpu/gpu.h"

#include <algorithm>

namespace throng {

struct MemoryBlock {
    MemoryBlock(const Gpu& gpu_in, uint32_t type_in, VkDeviceSize size)
        : gpu(gpu_in), type(type_in), size_bytes(size), free(size) {}
    ~MemoryBlock() { gpu.vk.vkFreeMemory(gpu.device, memory, nullptr); }
    MemoryBlock(const MemoryBlock&) = delete;

    const Gpu& gpu;
    uint32_t type;
    VkDeviceSize size_bytes;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::byte* mapped = nullptr;
    FreeRanges free;
};

MemoryBlocks::MemoryBlocks(const Gpu& gpu, bool keeps_empty) : gpu_(gpu), keeps_empty_(keeps_empty) {}
MemoryBlocks::~MemoryBlocks() = default;

MemoryPart MemoryBlocks::take(uint32_t memory_type, VkDeviceSize size_bytes, VkDeviceSize alignment) {
    const std::lock_guard lock(mutex_);
    Blocks& blocks = blocks_[memory_type];
    const auto part_of = [&](MemoryBlock& block, VkDeviceSize offset) {
        return MemoryPart{&block, block.memory, offset, size_bytes, block.mapped ? block.mapped + offset : nullptr};
    };
    for (const auto& block : blocks)
        if (const auto offset = block->free.take(size_bytes, alignment)) return part_of(*block, *offset);
    const VkDeviceSize shared_bytes = block_bytes(memory_type, size_bytes);
    try {
        blocks.push_back(make_block(memory_type, shared_bytes));
    } catch (const Failure& failure) {
        if (failure.error.code != ErrorCode::kOutOfMemory) throw;
        // When little memory is left, the request may still fit after freeing the empty blocks that are kept for reuse.
        for (Blocks& of_type : blocks_)
            std::erase_if(of_type, [](const auto& block) { return block->free.all_free(); });
        blocks.push_back(make_block(memory_type, size_bytes));
    }
    return part_of(*blocks.back(), *blocks.back()->free.take(size_bytes, alignment));
}

VkDeviceSize MemoryBlocks::block_bytes(uint32_t memory_type, VkDeviceSize size_bytes) const {
    constexpr VkDeviceSize kPartOfHeap = 16;
    VkDeviceSize before_bytes = 0;
    for (const auto& block : blocks_[memory_type]) before_bytes += block->size_bytes;
    const VkMemoryType& type = gpu_.memory_properties.memoryTypes[memory_type];
    const VkDeviceSize max_bytes = std::min<VkDeviceSize>(
        {kLargestBlock_bytes, gpu_.max_allocation_bytes,
         gpu_.memory_properties.memoryHeaps[type.heapIndex].size / kPartOfHeap});
    return std::max(size_bytes, std::min(std::max(before_bytes, kSmallestBlock_bytes), max_bytes));
}

std::unique_ptr<MemoryBlock> MemoryBlocks::make_block(uint32_t memory_type, VkDeviceSize size_bytes) const {
    constexpr VkMemoryPropertyFlags kMappable = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                                VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    auto block = std::make_unique<MemoryBlock>(gpu_, memory_type, size_bytes);
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = size_bytes, .memoryTypeIndex = memory_type};
    check(gpu_.vk.vkAllocateMemory(gpu_.device, &allocate, nullptr, &block->memory), "vkAllocateMemory");
    ++gpu_.counts.allocations;
    if ((gpu_.memory_properties.memoryTypes[memory_type].propertyFlags & kMappable) != kMappable) return block;
    void* pointer = nullptr;
    // Where it cannot be mapped, the GPU can still use it.
    if (gpu_.vk.vkMapMemory(gpu_.device, block->memory, 0, VK_WHOLE_SIZE, 0, &pointer) == VK_SUCCESS)
        block->mapped = static_cast<std::byte*>(pointer);
    return block;
}

void MemoryBlocks::give_back(const MemoryPart& part) noexcept {
    const std::lock_guard lock(mutex_);
    MemoryBlock& emptied = *part.block;
    emptied.free.give_back(part.offset_bytes, part.size_bytes);
    if (!emptied.free.all_free()) return;
    Blocks& blocks = blocks_[emptied.type];
    const bool is_only_empty = std::ranges::none_of(
        blocks, [&](const auto& block) { return block.get() != &emptied && block->free.all_free(); });
    if (keeps_empty_ && is_only_empty && emptied.size_bytes <= kLargestBlock_bytes) return;
    std::erase_if(blocks, [&](const auto& block) { return block.get() == &emptied; });
}

void MemoryBlocks::clear() {
    for (Blocks& blocks : blocks_) blocks.clear();
}

size_t MemoryBlocks::block_count() const {
    const std::lock_guard lock(mutex_);
    size_t count = 0;
    for (const Blocks& blocks : blocks_) count += blocks.size();
    return count;
}

}  // namespace throng
