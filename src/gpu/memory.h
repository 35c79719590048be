// Memory of buffers: parts of large blocks, so that hundreds of buffers take a few allocations of the driver.
#pragma once

#include "gpu/vulkan.h"

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace throng {

class Gpu;
struct MemoryBlock;

struct MemoryPart {
    MemoryBlock* block = nullptr;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0, size_bytes = 0;
    std::byte* mapped = nullptr;  // where the CPU sees these bytes; null where it cannot, or not coherently
};

// The blocks of one device. Thread-safe.
class MemoryBlocks {
public:
    // A new block is as large as all earlier ones of its memory type together, but within these bounds; a buffer that
    // needs more gets a block of its own.
    static constexpr VkDeviceSize kSmallestBlock_bytes = VkDeviceSize{4} << 20,
                                  kLargestBlock_bytes = VkDeviceSize{64} << 20;

    // `keeps_empty`: one shared block of each memory type stays when it is empty, so that taking and giving back a
    // little now and then does not call the driver each time.
    MemoryBlocks(const Gpu& gpu, bool keeps_empty);
    ~MemoryBlocks();

    // Throws kOutOfMemory.
    MemoryPart take(uint32_t memory_type, VkDeviceSize size_bytes, VkDeviceSize alignment);
    // Frees the block when no part of it is in use any more, unless it is kept.
    void give_back(const MemoryPart& part) noexcept;
    // Frees the blocks that are kept; no part may be in use.
    void clear();
    size_t block_count() const;

private:
    using Blocks = std::vector<std::unique_ptr<MemoryBlock>>;
    std::unique_ptr<MemoryBlock> make_block(uint32_t memory_type, VkDeviceSize size_bytes) const;
    VkDeviceSize block_bytes(uint32_t memory_type, VkDeviceSize size_bytes) const;

    const Gpu& gpu_;
    const bool keeps_empty_;
    mutable std::mutex mutex_;
    std::array<Blocks, VK_MAX_MEMORY_TYPES> blocks_;  // by memory type
};

}  // namespace throng
